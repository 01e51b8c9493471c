"""Parameters that the user's simulation has wrong; its structure is right."""

import numpy as np

from ..effect import Change, Effect, Form, Scene, Truth


def _make_inertia(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    believed = scene.inertia / (1.0 + amplitude * float(rng.choice([-0.6, 1.0])))
    change = Truth(scene.inertia - believed, "kg·m²")
    return Change(belief={"inertia": believed}, parameters={"inertia_change": change})


def _make_payload(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """An unmodelled payload at half a metre, for which the belief has less gravity torque and less inertia."""
    arm = 0.5
    mass = min(amplitude * scene.gravity / (9.81 * arm), 0.6 * scene.inertia / arm**2)
    belief = {"gravity": scene.gravity - mass * 9.81 * arm, "inertia": scene.inertia - mass * arm**2}
    torque, angle = mass * 9.81 * arm, scene.joint.fields["gravity_angle"]  # torque sin(q + angle)
    return Change(
        belief=belief,
        parameters={
            "gravity_cos_change": Truth(torque * np.sin(angle), "N·m"),
            "gravity_sin_change": Truth(torque * np.cos(angle), "N·m"),
            "inertia_change": Truth(mass * arm**2, "kg·m²"),
        },
    )


def _make_offset(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    value = amplitude * scene.coulomb * float(rng.choice([-1.0, 1.0]))
    return Change(sensing={"offset": value}, parameters={"offset": Truth(value, "N·m")})


def _make_asymmetry(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """The truth differs by `amplitude` between directions, the believed friction is the mean of both."""
    forward, reverse = 1.0 + 0.5 * amplitude, 1.0 - 0.5 * amplitude
    plant: dict[str, float] = {}
    belief: dict[str, float] = {}
    for name in ("coulomb", "static"):
        mean = 0.5 * (scene.joint.fields[f"{name}_forward"] + scene.joint.fields[f"{name}_reverse"])
        plant |= {f"{name}_forward": mean * forward, f"{name}_reverse": mean * reverse}
        belief |= {f"{name}_forward": mean, f"{name}_reverse": mean}
    for name in ("stribeck", "viscous"):
        mean = 0.5 * (scene.joint.fields[f"{name}_forward"] + scene.joint.fields[f"{name}_reverse"])
        plant |= {f"{name}_forward": mean, f"{name}_reverse": mean}
    return Change(
        plant=plant, belief=belief, parameters={"coulomb_difference": Truth(amplitude * scene.coulomb, "N·m")}
    )


EFFECTS = (
    Effect(
        "inertia_error", "parameter", (Form("inertia", _make_inertia),), lambda scene: (0.01, 0.4), against="friction"
    ),
    Effect("payload_error", "parameter", (Form("mass", _make_payload),), lambda scene: (0.01, 0.4), against="friction"),
    Effect(
        "torque_offset",
        "parameter",
        (Form("offset", _make_offset),),
        lambda scene: (0.01, 0.4),
        against="nothing",
        accepted=("direction_asymmetry",),
    ),
    Effect(
        "direction_asymmetry",
        "parameter",
        (Form("levels", _make_asymmetry),),
        lambda scene: (0.02, 0.3),
        against="nothing",
        accepted=("torque_offset",),
    ),
)

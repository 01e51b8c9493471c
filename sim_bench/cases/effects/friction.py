"""Effects in the friction curve itself: its shape, its memory, its temperature."""

import numpy as np

from ..effect import Change, Effect, Form, Scene, Truth
from ..plant import CORES, NEUTRAL
from ..temperature import warm_and_cool


def _make_presliding(core: str) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        sigma_0 = scene.coulomb / amplitude
        ratio = rng.uniform(0.1, 0.4) if core == "lugre" else 0.0
        sigma_1 = ratio * 2.0 * np.sqrt(sigma_0 * scene.inertia)
        plant = {"core": float(CORES[core]), "sigma_0": sigma_0, "sigma_1": sigma_1}
        return Change(plant=plant, parameters={"breakaway_distance": Truth(amplitude, "rad")})

    return Form(core, build, shared=core != "gms")


def _lag(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    return Change(plant={"lag": amplitude}, parameters={"lag": Truth(amplitude, "s")})


def _dwell(form: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        time = float(np.exp(rng.uniform(np.log(0.3), np.log(1.5))))
        slip = float(np.exp(rng.uniform(np.log(4e-3), np.log(3e-2))))
        plant = {"dwell": amplitude * scene.coulomb, "dwell_time": time, "dwell_form": form, "dwell_slip": slip}
        return Change(
            plant=plant,
            parameters={
                "rise": Truth(amplitude * scene.coulomb, "N·m"),
                "time_constant": Truth(time, "s"),
                "travel": Truth(slip, "rad"),
            },
        )

    return Form("logarithmic" if form else "exponential", build, shared=not form)


def _make_thermal(name: str, number: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        temperature = warm_and_cool(scene.time, rng.uniform(12.0, 25.0), rng)
        level = -amplitude * rng.uniform(0.0, 0.3)
        # How much viscous friction falls by a kelvin at the mean temperature of the recording.
        rise = float(np.mean(temperature[scene.time >= 0.0])) - NEUTRAL["reference_temperature"]
        slope = amplitude * scene.viscous * np.exp(-amplitude * rise)
        return Change(
            plant={"viscous_heat": amplitude, "coulomb_heat": level, "heat_form": number},
            temperature=temperature,
            parameters={
                "viscous_slope": Truth(slope, "N·m·s/rad/K"),
                "coulomb_slope": Truth(-level * scene.coulomb, "N·m/K"),
            },
        )

    return Form(name, build, shared=number == 0.0)


def _make_exponent(low: bool) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        exponent = 2.0 - 1.5 * amplitude if low else 2.0 + 2.0 * amplitude
        return Change(plant={"exponent": exponent}, parameters={"stribeck_exponent": Truth(exponent, "1")})

    return Form("low exponent" if low else "high exponent", build)


def _make_power(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    exponent = rng.uniform(0.5, 0.75)
    coefficient = amplitude * scene.viscous * scene.joint.speed ** (1.0 - exponent)
    return Change(
        plant={"power": coefficient, "power_exponent": exponent},
        parameters={"coefficient": Truth(coefficient, "N·m·(s/rad)^n"), "exponent": Truth(exponent, "1")},
    )


def _make_eyring(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    velocity = scene.joint.speed * rng.uniform(0.05, 0.15)
    torque = amplitude * scene.viscous * scene.joint.speed / np.arcsinh(scene.joint.speed / velocity)
    return Change(
        plant={"eyring": torque, "eyring_velocity": velocity},
        parameters={"eyring_torque": Truth(torque, "N·m"), "eyring_velocity": Truth(velocity, "rad/s")},
    )


def _make_drag(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    coefficient = amplitude * scene.viscous / scene.joint.speed
    return Change(plant={"drag": coefficient}, parameters={"coefficient": Truth(coefficient, "N·m·s²/rad²")})


EFFECTS = (
    Effect(
        "presliding_hysteresis",
        "physics",
        (_make_presliding("lugre"), _make_presliding("gms"), _make_presliding("dahl")),
        lambda scene: (6e-4, 8e-3),
        localised=True,
        smallest=lambda scene: max(6e-4, 4.0 * scene.joint.breakaway),  # below it every joint is like that
    ),
    Effect(
        "frictional_lag",
        "physics",
        (Form("first order", _lag, shared=False),),
        lambda scene: (1e-3, 4e-2),
        localised=True,
    ),
    Effect("dwell_stiction", "physics", (_dwell(0.0), _dwell(1.0)), lambda scene: (0.05, 1.2), localised=True),
    Effect(
        "thermal_friction",
        "physics",
        (_make_thermal("exponential", 0.0), _make_thermal("arrhenius", 1.0), _make_thermal("wlf", 2.0)),
        lambda scene: (0.003, 0.04),
    ),
    Effect("stribeck_shape", "physics", (_make_exponent(True), _make_exponent(False)), lambda scene: (0.1, 1.0)),
    Effect(
        "power_law_viscous",
        "physics",
        (Form("power", _make_power), Form("eyring", _make_eyring, shared=False)),
        lambda scene: (0.05, 1.5),
    ),
    Effect("quadratic_drag", "physics", (Form("quadratic", _make_drag),), lambda scene: (0.05, 1.5)),
)

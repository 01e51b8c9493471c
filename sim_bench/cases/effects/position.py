"""Effects that are fixed to places: friction waves, cogging, springs, end stops."""

import numpy as np

from ..effect import Change, Effect, Form, Scene, Truth


def _describe_ripple(sine: float, cosine: float, order: float) -> dict[str, Truth]:
    """sine sin(n q) + cosine cos(n q)."""
    return {"sine": Truth(sine, "N·m"), "cosine": Truth(cosine, "N·m"), "order": Truth(order, "1/rad")}


def _make_wave(triangle: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        order, phase = float(rng.choice([2, 3, 4, 6])), rng.uniform(0.0, 2.0 * np.pi)
        plant = {"wave": amplitude, "wave_order": order, "wave_phase": phase, "wave_triangle": triangle}
        peak = amplitude * scene.coulomb
        sine, cosine = -peak * np.sin(phase), peak * np.cos(phase)
        return Change(plant=plant, parameters=_describe_ripple(sine, cosine, order))

    return Form("triangle" if triangle else "cosine", build, shared=not triangle)


def _make_cogging(sharpness: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        order, phase = scene.joint.gear_ratio * float(rng.choice([1, 2])), rng.uniform(0.0, 2.0 * np.pi)
        peak = amplitude * scene.coulomb
        plant = {"cogging": peak, "cogging_order": order, "cogging_phase": phase, "cogging_sharpness": sharpness}
        return Change(plant=plant, parameters=_describe_ripple(peak * np.cos(phase), peak * np.sin(phase), order))

    return Form("skewed" if sharpness else "sine", build, shared=not sharpness)


def _make_spring(cubic: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        rest = rng.uniform(-0.5, 0.5)
        plant = {"spring": amplitude, "spring_rest": rest, "spring_cubic": cubic * amplitude}
        parameters = {"stiffness": Truth(amplitude, "N·m/rad"), "centre": Truth(rest, "rad")}
        if cubic:
            parameters["hardening"] = Truth(cubic, "1/rad²")
        return Change(plant=plant, parameters=parameters)

    # Both forms are compared directly: the law of a spring that stiffens gives its stiffness at rest, not a mean slope.
    return Form("cubic" if cubic else "linear", build)


def _make_stop(exponent: float) -> Form:
    def build(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
        q = scene.reference[:, 0]
        place = q.max() - rng.uniform(0.06, 0.12) * (q.max() - q.min())
        plant = {"stop": amplitude, "stop_position": place, "stop_exponent": exponent}
        plant["stop_damping"] = 0.3 if exponent > 1.0 else 0.0
        return Change(plant=plant, parameters={"stiffness": Truth(amplitude, "N·m/rad"), "edge": Truth(place, "rad")})

    return Form("Hunt-Crossley" if exponent > 1.0 else "linear", build, shared=exponent == 1.0)


EFFECTS = (
    Effect("position_coulomb", "physics", (_make_wave(0.0), _make_wave(1.0)), lambda scene: (0.03, 0.3)),
    Effect("cogging", "physics", (_make_cogging(0.0), _make_cogging(0.7)), lambda scene: (0.01, 0.3)),
    Effect(
        "spring_torque",
        "physics",
        (_make_spring(0.0), _make_spring(0.3)),
        lambda scene: (0.02 * scene.coulomb, 1.5 * scene.coulomb),
    ),
    Effect(
        "end_stop",
        "physics",
        (_make_stop(1.0), _make_stop(1.5)),
        lambda scene: (0.1 * scene.coulomb, 60.0 * scene.coulomb),
        localised=True,
    ),
)

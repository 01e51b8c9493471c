"""Effects that the catalogue does not have, to see whether the diagnosis says so; and one that it calls external."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np

from ..effect import Change, Effect, Form, Scene, Truth

_APART = 0.5  # [s] between two pushes, below which nobody could say which of them is which


def _make_one_form(name: str, build: Callable[[Scene, float, np.random.Generator], Change]) -> tuple[Form, ...]:
    return (Form(name, build, shared=False),)


def _make_disturbance(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """Someone leans on the link: half-sine pushes in a few windows."""
    t, torque, pushes = scene.time, np.zeros_like(scene.time), []
    for _ in range(int(rng.integers(2, 5))):
        start, length = rng.uniform(0.05, 0.85) * t[-1], rng.uniform(0.8, 2.5)
        sign = float(rng.choice([-1.0, 1.0]))
        inside = (t >= start) & (t < start + length)
        torque[inside] += sign * np.sin(np.pi * (t[inside] - start) / length)
        pushes.append((start, start + length, sign * amplitude))
    return Change(disturbance=amplitude * torque, parameters=_list_pushes(sorted(pushes)))


def _list_pushes(pushes: list[tuple[float, float, float]]) -> dict[str, Truth]:
    """Start and end [s] and torque [N·m] of each, in the order of time; nothing where two run into each other."""
    if any(after[0] - before[1] < _APART for before, after in pairwise(pushes)):
        return {}
    return {
        f"{name}_{k}": Truth(value, unit)
        for k, push in enumerate(pushes, start=1)
        for name, value, unit in zip(("start", "end", "torque"), push, ("s", "s", "N·m"), strict=True)
    }


def _make_humidity(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """Dry friction steps up when moisture reaches the seal, and later falls back."""
    t = scene.time
    start, end = rng.uniform(0.2, 0.4) * t[-1], rng.uniform(0.6, 0.85) * t[-1]
    step = 0.5 * (np.tanh((t - start) / 0.5) - np.tanh((t - end) / 0.5))
    return Change(factor=1.0 + amplitude * step, parameters={"step": Truth(amplitude, "1")})


def _make_detent(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    order = scene.joint.gear_ratio * rng.uniform(0.31, 0.43)
    plant = {"detent": amplitude, "detent_order": order, "detent_width": 0.5 / order}
    return Change(plant=plant, parameters={"detent": Truth(amplitude, "N·m")})


def _make_impact(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    plant = {"impact": amplitude, "impact_frequency": rng.uniform(60.0, 140.0), "impact_decay": rng.uniform(0.08, 0.2)}
    return Change(plant=plant, parameters={"impact": Truth(amplitude, "N·m")})


def _make_machine(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """Two incommensurate tones of a machine next door, swelling and fading."""
    t, f = scene.time, rng.uniform(3.0, 9.0)
    swell = 1.0 + 0.5 * np.sin(2.0 * np.pi * t / rng.uniform(9.0, 17.0))
    tones = np.sin(2.0 * np.pi * f * t) + 0.6 * np.sin(2.0 * np.pi * f * 1.618 * t + 1.0)
    return Change(disturbance=amplitude * swell * tones, parameters={"amplitude": Truth(amplitude, "N·m")})


def _make_derating(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """The drive lowers its torque limit while it reports the torque it was asked for."""
    q, v = scene.reference.T
    gravity = scene.gravity * np.sin(q + scene.joint.fields["gravity_angle"])
    needed = scene.inertia * np.gradient(v, scene.time) + gravity + scene.coulomb * np.sign(v) + scene.viscous * v
    peak = 1.2 * float(np.abs(needed).max())
    plant = {"derating": peak, "derating_time": 0.3 * scene.time[-1], "derating_floor": max(1.0 - amplitude, 0.1)}
    return Change(plant=plant, parameters={"lost": Truth(amplitude, "1")})


def _make_starvation(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    period = rng.uniform(5.0, 9.0)
    plant = {"starvation": amplitude, "starvation_period": period, "starvation_width": 0.1 * period}
    return Change(plant=plant, parameters={"peak": Truth(amplitude, "N·m")})


def _make_cable(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    plant = {"cable": amplitude, "cable_time": rng.uniform(0.8, 2.5)}
    return Change(plant=plant, parameters={"stiffness": Truth(amplitude, "N·m/rad")})


def _make_dead_band(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    return Change(plant={"dead_band": amplitude}, parameters={"dead_band": Truth(amplitude, "N·m")})


def _make_thixotropy(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    plant = {"thixotropy": amplitude, "thixotropy_time": rng.uniform(1.5, 4.0)}
    return Change(plant=plant, parameters={"coefficient": Truth(amplitude, "N·m·(s/rad)^0.5")})


def _make_rate(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    limit = scene.coulomb / amplitude
    return Change(plant={"rate_limit": limit}, parameters={"rate": Truth(limit, "N·m/s")})


def _make_absorber(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    """A cover or tool that swings on the link with its own resonance."""
    plant = {"absorber": amplitude * scene.inertia, "absorber_frequency": rng.uniform(9.0, 22.0)}
    plant["absorber_damping"] = rng.uniform(0.02, 0.08)
    return Change(plant=plant, parameters={"mass": Truth(amplitude * scene.inertia, "kg·m²")})


def _make_eddy(scene: Scene, amplitude: float, rng: np.random.Generator) -> Change:
    plant = {"eddy": amplitude, "eddy_velocity": scene.joint.speed * rng.uniform(0.2, 0.35)}
    return Change(plant=plant, parameters={"peak": Truth(amplitude, "N·m")})


EFFECTS = (
    Effect(
        "external_disturbance",
        "physics",
        (Form("pushes", _make_disturbance),),
        lambda s: (0.02 * s.coulomb, 2.0 * s.coulomb),
        localised=True,
        accepted=("unknown_physics",),
    ),
    Effect(
        "humidity_step",
        "outside",
        _make_one_form("step", _make_humidity),
        lambda s: (0.02, 0.6),
        localised=True,
        accepted=("external_disturbance",),
    ),
    Effect(
        "detent_hysteresis",
        "outside",
        _make_one_form("play", _make_detent),
        lambda s: (0.02 * s.coulomb, 1.0 * s.coulomb),
    ),
    Effect(
        "loose_coupling",
        "outside",
        _make_one_form("ringing", _make_impact),
        lambda s: (0.1 * s.coulomb, 4.0 * s.coulomb),
        localised=True,
    ),
    Effect(
        "machine_vibration",
        "outside",
        _make_one_form("tones", _make_machine),
        lambda s: (0.02 * s.coulomb, 1.0 * s.coulomb),
        accepted=("external_disturbance",),
    ),
    Effect(
        "torque_derating", "outside", _make_one_form("limit", _make_derating), lambda s: (0.05, 0.8), localised=True
    ),
    Effect(
        "lubricant_starvation",
        "outside",
        _make_one_form("bursts", _make_starvation),
        lambda s: (0.05 * s.coulomb, 1.0 * s.coulomb),
        localised=True,
        accepted=("external_disturbance",),
    ),
    Effect(
        "cable_memory", "outside", _make_one_form("Maxwell", _make_cable), lambda s: (0.05 * s.coulomb, 2.0 * s.coulomb)
    ),
    Effect(
        "drive_dead_band",
        "outside",
        _make_one_form("soft", _make_dead_band),
        lambda s: (0.05 * s.coulomb, 0.8 * s.coulomb),
    ),
    Effect(
        "thixotropic_grease",
        "outside",
        _make_one_form("structure", _make_thixotropy),
        lambda s: (0.1 * s.coulomb, 2.5 * s.coulomb),
    ),
    Effect("torque_rate_limit", "outside", _make_one_form("slew", _make_rate), lambda s: (5e-4, 5e-2), localised=True),
    Effect("hidden_absorber", "outside", _make_one_form("swinging mass", _make_absorber), lambda s: (0.01, 0.3)),
    Effect(
        "eddy_current_brake",
        "outside",
        _make_one_form("peaked", _make_eddy),
        lambda s: (0.02 * s.coulomb, 0.8 * s.coulomb),
    ),
)

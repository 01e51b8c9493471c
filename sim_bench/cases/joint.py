"""Joints to conceal effects in: harmonic drives and quasi-direct drives of ordinary size, drawn at random."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .plant import CORES, ELEMENTS

_BITS = (17, 18, 18, 19, 20)


@dataclass(frozen=True)
class _Family:
    """Ranges that a joint is drawn from; log-uniform where they span more than a factor of three."""

    inertia: tuple[float, float]  # [kg·m²]
    gravity: tuple[float, float]  # [N·m]
    coulomb: tuple[float, float]  # [N·m]
    static_ratio: tuple[float, float]
    stribeck: tuple[float, float]  # [rad/s]
    viscous: tuple[float, float]  # torque at full speed over the Coulomb torque
    speed: tuple[float, float]  # [rad/s]
    gear: tuple[float, ...]
    limit: float  # [N·m]


FAMILIES = {
    "harmonic": _Family(
        (0.3, 2.0),
        (8.0, 30.0),
        (3.0, 10.0),
        (1.1, 1.6),
        (0.02, 0.12),
        (0.6, 1.6),
        (1.0, 2.0),
        (50, 80, 100, 120),
        150.0,
    ),
    "quasi_direct": _Family(
        (0.05, 0.3), (1.5, 8.0), (0.3, 1.5), (1.05, 1.4), (0.05, 0.25), (0.3, 1.2), (2.5, 5.0), (6, 9, 10), 40.0
    ),
}


@dataclass(frozen=True)
class Joint:
    """One joint without any effect, with its controller and encoder.

    Attributes:
        family: Key of `FAMILIES`.
        core: Key of `CORES`.
        gear_ratio: Motor turns for one joint turn.
        speed: Largest speed of a motion [rad/s].
        noise: Standard deviation of the torque noise [N·m].
        fields: Fields of the plant.
        shares: Maxwell elements, shape (2, ELEMENTS).
    """

    family: str
    core: str
    gear_ratio: float
    speed: float
    noise: float
    fields: dict[str, float]
    shares: NDArray[np.float64]

    @property
    def breakaway(self) -> float:
        """Mean Coulomb torque over bristle stiffness [rad]."""
        return 0.5 * (self.fields["coulomb_forward"] + self.fields["coulomb_reverse"]) / self.fields["sigma_0"]


def draw_joint(rng: np.random.Generator, family: str | None = None, core: str | None = None) -> Joint:
    """A joint of the family, with the friction core, either drawn where it is not given."""
    family = family or str(rng.choice(list(FAMILIES)))
    core = core or str(rng.choice(list(CORES)))
    ranges = FAMILIES[family]
    inertia, speed = _draw_log_uniform(rng, ranges.inertia), rng.uniform(*ranges.speed)
    coulomb, bits = _draw_log_uniform(rng, ranges.coulomb), int(rng.choice(_BITS))
    fields = {
        "inertia": inertia,
        "link_inertia": inertia * rng.uniform(0.5, 0.7),
        "gravity": _draw_log_uniform(rng, ranges.gravity),
        "gravity_angle": rng.uniform(-0.6, 0.6),
        "limit": ranges.limit,
        "resolution": 2.0 * np.pi / 2**bits,
        "core": float(CORES[core]),
        **_draw_friction(rng, ranges, coulomb, speed),
        **_draw_bristles(rng, core, coulomb, inertia),
        **_draw_loop(rng, inertia),
    }
    noise = coulomb * rng.uniform(0.006, 0.02)
    gear = float(rng.choice(ranges.gear))
    return Joint(family, core, gear, speed, noise, fields, _draw_shares(rng))


def _draw_log_uniform(rng: np.random.Generator, limits: tuple[float, float]) -> float:
    return float(np.exp(rng.uniform(np.log(limits[0]), np.log(limits[1]))))


def _draw_friction(rng: np.random.Generator, ranges: _Family, coulomb: float, speed: float) -> dict[str, float]:
    """A Stribeck curve for each direction, within ten per cent of each other."""
    ratio, width = rng.uniform(*ranges.static_ratio), _draw_log_uniform(rng, ranges.stribeck)
    slope = coulomb * rng.uniform(*ranges.viscous) / speed
    fields = {}
    for direction in ("forward", "reverse"):
        level = coulomb * rng.uniform(0.92, 1.08)
        fields[f"coulomb_{direction}"] = level
        fields[f"static_{direction}"] = level * ratio * rng.uniform(0.97, 1.03)
        fields[f"stribeck_{direction}"] = width * rng.uniform(0.85, 1.15)
        fields[f"viscous_{direction}"] = slope * rng.uniform(0.92, 1.08)
    return fields


def _draw_bristles(rng: np.random.Generator, core: str, coulomb: float, inertia: float) -> dict[str, float]:
    """Stiff bristles: they break away within a few steps of the encoder."""
    sigma_0 = coulomb / _draw_log_uniform(rng, (2e-5, 1.5e-4))
    damping = rng.uniform(0.1, 0.6) * 2.0 * np.sqrt(sigma_0 * inertia) if core == "lugre" else 0.0
    return {"sigma_0": sigma_0, "base_sigma_0": sigma_0, "sigma_1": damping, "base_sigma_1": damping}


def _draw_loop(rng: np.random.Generator, inertia: float) -> dict[str, float]:
    """A PD or PID controller of 20 to 40 rad/s."""
    bandwidth, ratio = rng.uniform(20.0, 40.0), rng.uniform(0.7, 1.0)
    gain = inertia * bandwidth**2
    return {
        "gain": gain,
        "damping": 2.0 * ratio * inertia * bandwidth,
        "integral": gain * rng.uniform(0.5, 3.0) if rng.random() < 0.5 else 0.0,
        "velocity_cutoff": 2.0 * np.pi * rng.uniform(40.0, 80.0),
    }


def _draw_shares(rng: np.random.Generator) -> NDArray[np.float64]:
    """Strengths and stiffnesses of the Maxwell elements, each summing to one."""
    strengths, stiffnesses = rng.uniform(0.5, 1.5, ELEMENTS), np.geomspace(2.0, 0.7, ELEMENTS)
    return np.stack([strengths / strengths.sum(), stiffnesses / stiffnesses.sum()])

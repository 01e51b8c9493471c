"""Friction with a bristle state: Dahl and LuGre, advanced exactly over each step."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fricomp.laws.load import LoadScaling
from fricomp.laws.stribeck import (
    STRIBECK_UNITS,
    BidirectionalStribeck,
    StribeckCurve,
    dry_level_of_direction,
    viscous_torque,
)
from fricomp.laws.term import DynamicTerm, OperatingPoint, Parts, require_nonnegative, require_positive


def advance_bristle(z: Any, v: Any, steady: Any, dt: Any) -> Any:
    """Bristle deflection after `dt` [s] of z' = v - |v| z / z_ss, which is linear in z while v is constant.

    The exact solution z_ss sgn(v) + (z - z_ss sgn(v)) exp(-|v| dt / z_ss) stays bounded at any step.

    Args:
        z: Deflection at the start [rad] or [m].
        v: Velocity over the step [rad/s] or [m/s].
        steady: z_ss > 0, the deflection in steady sliding [rad] or [m].
        dt: Step [s].
    """
    target = steady * np.sign(v)
    return target + (z - target) * np.exp(-np.abs(v) * dt / steady)


def bristle_torque(sigma_0: float, sigma_1: float, before: Any, after: Any, dt: Any) -> Any:
    """sigma_0 z + sigma_1 z' at the end of a step from z = `before` to `after`; z' is its mean over the step."""
    return sigma_0 * after + (sigma_1 / dt) * (after - before)


@dataclass(frozen=True)
class Dahl(DynamicTerm):
    """Dahl's model with exponent 1 [dahl1968]: tau = sigma_0 z, z' = v - sigma_0 |v| z / F_c.

    Attributes:
        coulomb_torque: F_c [N·m] or [N].
        sigma_0: Presliding stiffness [N·m/rad] or [N/m].
        load: How F_c follows the normal load.
    """

    name: ClassVar[str] = "dahl"
    states: ClassVar[tuple[str, ...]] = ("deflection",)
    units: ClassVar[Mapping[str, str]] = {
        "coulomb_torque": "{torque}",
        "sigma_0": "{torque}/{position}",
        "load_sensitivity": "1",
        "reference_load": "as normal_load",
    }

    coulomb_torque: float
    sigma_0: float
    load: LoadScaling = LoadScaling()

    def __post_init__(self) -> None:
        require_positive(self, "coulomb_torque", "sigma_0")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque in steady sliding at `point`."""
        return Parts(dry=self.load.factor_at(point) * self.coulomb_torque)

    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """Deflection after `dt` [s]."""
        steady = self.load.factor_at(point) * self.coulomb_torque / self.sigma_0
        return (advance_bristle(before[0], point.velocity, steady, dt),)

    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """Torque of the bent bristle."""
        return Parts(bristle=bristle_torque(self.sigma_0, 0.0, before[0], after[0], dt))


@dataclass(frozen=True)
class LuGre(DynamicTerm):
    """The LuGre model [canudas1995lugre] with a Stribeck curve for each direction.

    z' = v - sigma_0 |v| z / g(v),  tau = sigma_0 z + sigma_1 z' + sigma_2 v

    g is the dry part of the curve of the direction of motion, sigma_2 its viscous coefficient; in steady
    sliding the model is the static bidirectional Stribeck law.

    Attributes:
        forward: Curve for v > 0.
        reverse: Curve for v < 0.
        sigma_0: Bristle stiffness [N·m/rad] or [N/m].
        sigma_1: Bristle damping [N·m·s/rad] or [N·s/m].
        load: How g follows the normal load.
    """

    name: ClassVar[str] = "lugre"
    states: ClassVar[tuple[str, ...]] = ("deflection",)
    units: ClassVar[Mapping[str, str]] = {
        **STRIBECK_UNITS,
        "sigma_0": "{torque}/{position}",
        "sigma_1": "{torque}·s/{position}",
    }

    forward: StribeckCurve
    reverse: StribeckCurve
    sigma_0: float
    sigma_1: float = 0.0
    load: LoadScaling = LoadScaling()

    def __post_init__(self) -> None:
        require_positive(self, "sigma_0")
        require_nonnegative(self, "sigma_1")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque in steady sliding at `point`."""
        return BidirectionalStribeck(self.forward, self.reverse, self.load).parts(point)

    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """Deflection after `dt` [s]."""
        return (self._bend(point, before[0], point.velocity, dt),)

    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """Torque of the bent bristle, and viscous friction."""
        return self._parts(point, before[0], after[0], point.velocity, dt)

    def _bend(self, point: OperatingPoint, before: Any, felt: Any, dt: Any) -> Any:
        """Deflection after `dt` [s], with friction at the velocity `felt`."""
        level = self.load.factor_at(point) * dry_level_of_direction(self.forward, self.reverse, point, np.abs(felt))
        return advance_bristle(before, point.velocity, level / self.sigma_0, dt)

    def _parts(self, point: OperatingPoint, before: Any, after: Any, felt: Any, dt: Any) -> Parts:
        return Parts(
            bristle=bristle_torque(self.sigma_0, self.sigma_1, before, after, dt),
            drag=viscous_torque(self.forward, self.reverse, point, felt),
        )

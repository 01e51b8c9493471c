"""Friction with a bristle state: Dahl and LuGre, advanced exactly over each step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.load import LoadScaling
from fricomp.laws.stribeck import STRIBECK_UNITS, BidirectionalStribeck, StribeckCurve
from fricomp.laws.term import (
    DynamicTerm,
    FloatArray,
    OperatingPoint,
    Scalar,
    require_nonnegative,
    require_positive,
)

__all__ = ["Dahl", "LuGre"]


def advance_bristle(z: FloatArray, v: FloatArray, steady: FloatArray, dt: float) -> FloatArray:
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


@dataclass(frozen=True)
class Dahl(DynamicTerm):
    """Dahl's model with exponent 1 [dahl1968]: tau = sigma_0 z, z' = v - sigma_0 |v| z / F_c.

    Attributes:
        coulomb_torque: F_c [N·m] or [N].
        sigma_0: Presliding stiffness [N·m/rad] or [N/m].
        load: How F_c follows the normal load.
    """

    name: ClassVar[str] = "dahl"
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

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque in steady sliding at `point`."""
        return self.load.factor(point.normal_load) * self.coulomb_torque * np.sign(point.velocity)

    def rest_state(self) -> Scalar:
        """No deflection [rad] or [m]."""
        return 0.0

    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """Torque and deflection after `dt` [s]."""
        steady = np.asarray(self.load.factor(point.normal_load) * self.coulomb_torque / self.sigma_0)
        z = advance_bristle(np.asarray(state), np.asarray(point.velocity, dtype=np.float64), steady, dt)
        return self.sigma_0 * z, z


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

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque in steady sliding at `point`."""
        return BidirectionalStribeck(self.forward, self.reverse, self.load).torque(point)

    def rest_state(self) -> Scalar:
        """No deflection [rad] or [m]."""
        return 0.0

    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """Torque and deflection after `dt` [s]; the bristle rate is its mean over the step."""
        v = np.asarray(point.velocity, dtype=np.float64)
        return self._bend(np.asarray(state), v, v, point, dt)

    def _bend(
        self, before: FloatArray, v: FloatArray, felt: FloatArray, point: OperatingPoint, dt: float
    ) -> tuple[Scalar, Scalar]:
        """Torque and deflection after `dt` [s], with friction at the velocity `felt`."""
        speed, is_forward = np.abs(felt), v >= 0.0
        dry = np.where(is_forward, self.forward.dry_level(speed), self.reverse.dry_level(speed))
        steady = self.load.factor(point.normal_load) * dry / self.sigma_0
        z = advance_bristle(before, v, steady, dt)
        viscous = np.where(is_forward, self.forward.viscous_coefficient, self.reverse.viscous_coefficient)
        return self.sigma_0 * z + self.sigma_1 * (z - before) / dt + viscous * felt, z

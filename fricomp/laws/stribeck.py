"""Stribeck friction: the curve, and the bidirectional term with its eight parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.load import LoadScaling
from fricomp.laws.term import (
    FloatArray,
    OperatingPoint,
    Scalar,
    Term,
    require_nonnegative,
    require_positive,
)

__all__ = ["BidirectionalStribeck", "Stribeck", "StribeckCurve"]

STRIBECK_UNITS: Mapping[str, str] = {
    "coulomb_torque": "{torque}",
    "static_torque": "{torque}",
    "stribeck_velocity": "{position}/s",
    "viscous_coefficient": "{torque}·s/{position}",
    "stribeck_exponent": "1",
    "load_sensitivity": "1",
    "reference_load": "as normal_load",
}


@dataclass(frozen=True)
class StribeckCurve:
    """Friction in one direction over the speed |v|, equation (2) of [luo2024pinn]:

    F(|v|) = F_c + (F_s - F_c) exp(-(|v|/v_s)^delta) + F_v |v|

    Attributes:
        coulomb_torque: F_c [N·m] or [N].
        static_torque: F_s [N·m] or [N]; at or above F_c on ordinary joints, which is not enforced.
        stribeck_velocity: v_s [rad/s] or [m/s].
        viscous_coefficient: F_v [N·m·s/rad] or [N·s/m].
        stribeck_exponent: delta; 2 unless identified otherwise.

    Raises:
        ParameterError: A parameter is not finite, negative, or zero where it must not be.
    """

    coulomb_torque: float
    static_torque: float
    stribeck_velocity: float
    viscous_coefficient: float
    stribeck_exponent: float = 2.0

    def __post_init__(self) -> None:
        require_nonnegative(self, "coulomb_torque", "static_torque", "viscous_coefficient")
        require_positive(self, "stribeck_velocity", "stribeck_exponent")

    def dry_level(self, speed: FloatArray) -> FloatArray:
        """Dry friction [N·m] or [N] at `speed` >= 0: the curve without its viscous part."""
        falling = np.exp(-((speed / self.stribeck_velocity) ** self.stribeck_exponent))
        return self.coulomb_torque + (self.static_torque - self.coulomb_torque) * falling

    def level(self, speed: FloatArray) -> FloatArray:
        """Friction magnitude [N·m] or [N] at `speed` >= 0 [rad/s] or [m/s]."""
        return self.dry_level(speed) + self.viscous_coefficient * speed


@dataclass(frozen=True)
class BidirectionalStribeck(Term):
    """Stribeck friction with its own parameters in each direction, equation (3) of [luo2024pinn].

    Attributes:
        forward: Curve for v > 0; all its parameters are positive numbers.
        reverse: Curve for v < 0; likewise.
        load: How the dry part follows the normal load.
    """

    name: ClassVar[str] = "stribeck"
    units: ClassVar[Mapping[str, str]] = STRIBECK_UNITS

    forward: StribeckCurve
    reverse: StribeckCurve
    load: LoadScaling = LoadScaling()

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`; zero at rest, where Stribeck friction takes any value up to the static torque."""
        v = np.asarray(point.velocity, dtype=np.float64)
        speed, scale = np.abs(v), self.load.factor(point.normal_load)
        forward = scale * self.forward.dry_level(speed) + self.forward.viscous_coefficient * speed
        reverse = scale * self.reverse.dry_level(speed) + self.reverse.viscous_coefficient * speed
        return np.where(v > 0.0, forward, np.where(v < 0.0, -reverse, v * 0.0))


@dataclass(frozen=True)
class Stribeck(Term):
    """Stribeck friction that is the same in both directions, equation (2) of [luo2024pinn]."""

    name: ClassVar[str] = "symmetric_stribeck"
    units: ClassVar[Mapping[str, str]] = STRIBECK_UNITS

    curve: StribeckCurve
    load: LoadScaling = LoadScaling()

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`; zero at rest."""
        return BidirectionalStribeck(self.curve, self.curve, self.load).torque(point)

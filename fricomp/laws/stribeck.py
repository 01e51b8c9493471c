"""Stribeck friction: the curve, and the bidirectional term with its eight parameters."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fricomp.laws.load import LoadScaling
from fricomp.laws.term import (
    FloatArray,
    OperatingPoint,
    Parts,
    Term,
    require_nonnegative,
    require_positive,
)

__all__ = ["BidirectionalStribeck", "Stribeck", "StribeckCurve", "compute_dry_level", "compute_falling_share"]

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

    def dry_level(self, speed: Any) -> Any:
        """Dry friction [N·m] or [N] at `speed` >= 0: the curve without its viscous part."""
        share = compute_falling_share(speed, self.stribeck_velocity, self.stribeck_exponent)
        return compute_dry_level(self.coulomb_torque, self.static_torque - self.coulomb_torque, share)

    def level(self, speed: FloatArray) -> FloatArray:
        """Friction magnitude [N·m] or [N] at `speed` >= 0 [rad/s] or [m/s]."""
        return np.asarray(self.dry_level(speed) + self.viscous_coefficient * speed)


def compute_falling_share(speed: Any, stribeck_velocity: Any, exponent: float) -> Any:
    """Share of F_s - F_c [1] that is left at `speed` >= 0 [rad/s] or [m/s]."""
    return np.exp(-((speed / stribeck_velocity) ** exponent))


def compute_dry_level(coulomb: float, rise: float, falling_share: Any) -> Any:
    """Dry friction [N·m] or [N] of a curve where that share of its `rise` F_s - F_c is left."""
    return coulomb + rise * falling_share


def dry_level_of_direction(forward: StribeckCurve, reverse: StribeckCurve, point: OperatingPoint, speed: Any) -> Any:
    """Dry friction [N·m] or [N] of the curve of the direction of motion at `point`, at `speed`."""
    return np.where(point.is_forward, forward.dry_level(speed), reverse.dry_level(speed))


def viscous_torque(forward: StribeckCurve, reverse: StribeckCurve, point: OperatingPoint, velocity: Any) -> Any:
    """Viscous friction [N·m] or [N] of the curve of the direction of motion at `point`, at `velocity`."""
    coefficient = np.where(point.is_forward, forward.viscous_coefficient, reverse.viscous_coefficient)
    return coefficient * velocity


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

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`; zero at rest, where Stribeck friction takes any value up to the static torque."""
        return Parts(
            dry=self.load.factor_at(point) * dry_level_of_direction(self.forward, self.reverse, point, point.speed),
            drag=viscous_torque(self.forward, self.reverse, point, point.velocity),
        )


@dataclass(frozen=True)
class Stribeck(Term):
    """Stribeck friction that is the same in both directions, equation (2) of [luo2024pinn]."""

    name: ClassVar[str] = "symmetric_stribeck"
    units: ClassVar[Mapping[str, str]] = STRIBECK_UNITS

    curve: StribeckCurve
    load: LoadScaling = LoadScaling()

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`; zero at rest."""
        return Parts(
            dry=self.load.factor_at(point) * self.curve.dry_level(point.speed),
            drag=self.curve.viscous_coefficient * point.velocity,
        )

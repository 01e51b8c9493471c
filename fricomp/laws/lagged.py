"""Friction that follows the velocity late: tau_f(t) = F(v(t - T)) [hess1990], with the delay as a first-order lag."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from fricomp.laws.bristle import LuGre
from fricomp.laws.stribeck import BidirectionalStribeck
from fricomp.laws.term import DynamicTerm, FloatArray, OperatingPoint, Scalar, require_positive

__all__ = ["LaggedLuGre", "LaggedStribeck"]


@dataclass(frozen=True)
class LaggedStribeck(BidirectionalStribeck, DynamicTerm):
    """A Stribeck curve over a velocity u that lags: T u' = v - u, tau = g(|u|) sgn(v) + F_v u.

    The state is u; in steady sliding the model is the static law.

    Attributes:
        lag: T [s].
    """

    name: ClassVar[str] = "lagged_stribeck"
    units: ClassVar[Mapping[str, str]] = {**BidirectionalStribeck.units, "lag": "s"}

    lag: float = field(kw_only=True)

    def __post_init__(self) -> None:
        require_positive(self, "lag")

    def rest_state(self) -> Scalar:
        """No velocity [rad/s] or [m/s]."""
        return 0.0

    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """Torque and lagging velocity after `dt` [s]."""
        v = np.asarray(point.velocity, dtype=np.float64)
        felt = _follow(np.asarray(state), v, dt / self.lag)
        is_forward, speed = v >= 0.0, np.abs(felt)
        dry = np.where(is_forward, self.forward.dry_level(speed), self.reverse.dry_level(speed))
        viscous = np.where(is_forward, self.forward.viscous_coefficient, self.reverse.viscous_coefficient)
        return self.load.factor(point.normal_load) * dry * np.sign(v) + viscous * felt, felt


@dataclass(frozen=True)
class LaggedLuGre(LuGre):
    """LuGre friction whose level and viscous part follow a velocity u that lags: T u' = v - u.

    The state holds the deflection and u, shape (2,) or (2, ...).

    Attributes:
        lag: T [s].
    """

    name: ClassVar[str] = "lagged_lugre"
    units: ClassVar[Mapping[str, str]] = {**LuGre.units, "lag": "s"}

    lag: float = field(kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self, "lag")

    def rest_state(self) -> Scalar:
        """No deflection [rad] or [m] and no velocity [rad/s] or [m/s]."""
        return np.zeros(2)

    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """Torque and state after `dt` [s]."""
        before, v = np.asarray(state), np.asarray(point.velocity, dtype=np.float64)
        felt = _follow(before[1], v, dt / self.lag)
        torque, z = self._bend(before[0], v, felt, point, dt)
        return torque, np.stack(np.broadcast_arrays(z, felt))


def _follow(felt: FloatArray, v: FloatArray, steps: float) -> FloatArray:
    """The lagging velocity after `steps` time constants of constant velocity [rad/s] or [m/s]."""
    return np.asarray(v + (felt - v) * np.exp(-steps))

"""Friction that follows the velocity late: tau_f(t) = F(v(t - T)) [hess1990], with the delay as a first-order lag."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from fricomp.laws.bristle import LuGre
from fricomp.laws.stribeck import BidirectionalStribeck, dry_level_of_direction, viscous_torque
from fricomp.laws.term import DynamicTerm, OperatingPoint, Parts, require_positive


@dataclass(frozen=True)
class LaggedStribeck(BidirectionalStribeck, DynamicTerm):
    """A Stribeck curve over a velocity u that lags: T u' = v - u, tau = g(|u|) sgn(v) + F_v u.

    The state is u; in steady sliding the model is the static law.

    Attributes:
        lag: T [s].
    """

    name: ClassVar[str] = "lagged_stribeck"
    states: ClassVar[tuple[str, ...]] = ("felt_velocity",)
    units: ClassVar[Mapping[str, str]] = {**BidirectionalStribeck.units, "lag": "s"}

    lag: float = field(kw_only=True)

    def __post_init__(self) -> None:
        require_positive(self, "lag")

    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """The lagging velocity after `dt` [s]."""
        return (follow_velocity(before[0], point.velocity, dt / self.lag),)

    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """Torque at the lagging velocity."""
        (felt,) = after
        return Parts(
            dry=self.load.factor_at(point) * dry_level_of_direction(self.forward, self.reverse, point, np.abs(felt)),
            drag=viscous_torque(self.forward, self.reverse, point, felt),
        )


@dataclass(frozen=True)
class LaggedLuGre(LuGre):
    """LuGre friction whose level and viscous part follow a velocity u that lags: T u' = v - u.

    The state holds the deflection and u, shape (2,) or (2, ...).

    Attributes:
        lag: T [s].
    """

    name: ClassVar[str] = "lagged_lugre"
    states: ClassVar[tuple[str, ...]] = ("deflection", "felt_velocity")
    units: ClassVar[Mapping[str, str]] = {**LuGre.units, "lag": "s"}

    lag: float = field(kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        require_positive(self, "lag")

    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """Deflection and lagging velocity after `dt` [s]."""
        felt = follow_velocity(before[1], point.velocity, dt / self.lag)
        return self._bend(point, before[0], felt, dt), felt

    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """Torque of the bent bristle, and viscous friction at the lagging velocity."""
        return self._parts(point, before[0], after[0], after[1], dt)


def follow_velocity(felt: Any, v: Any, steps: Any) -> Any:
    """The lagging velocity after `steps` time constants of the constant velocity `v` [rad/s] or [m/s]."""
    return v + (felt - v) * np.exp(-steps)

"""Static friction that grows while the joint rests."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fricomp.laws.term import DynamicTerm, OperatingPoint, Parts, Ranges, require_nonnegative, require_positive


@dataclass(frozen=True)
class DwellStiction(DynamicTerm):
    """A s sgn(v) with s' = (1 - s) / tau at rest, s' = -|v| s / d above the rest speed [armstrong1994survey].

    The state s is the share of the rise that rests have brought.

    Attributes:
        rise: A, what a long rest adds to the friction level [N·m] or [N].
        time_constant: tau, in which it grows [s].
        travel: d, over which it is lost again [rad] or [m].
        rest_speed: Speed below which the joint counts as resting [rad/s] or [m/s].
    """

    name: ClassVar[str] = "dwell_stiction"
    states: ClassVar[tuple[str, ...]] = ("share",)
    units: ClassVar[Mapping[str, str]] = {
        "rise": "{torque}",
        "time_constant": "s",
        "travel": "{position}",
        "rest_speed": "{position}/s",
    }

    rise: float
    time_constant: float
    travel: float
    rest_speed: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "rise")
        require_positive(self, "time_constant", "travel", "rest_speed")

    @property
    def sliding_speed(self) -> float:
        """The rest speed [rad/s] or [m/s]."""
        return self.rest_speed

    def parts(self, point: OperatingPoint) -> Parts:
        """Nothing: a joint in steady sliding has lost what its rest brought."""
        return Parts()

    def follow(self, point: OperatingPoint, before: Sequence[Any], dt: Any) -> tuple[Any, ...]:
        """Share of the rise [1] after `dt` [s]; 0 at the start, since no one knows how long the joint has rested."""
        (share,), speed = before, np.abs(point.velocity)
        grown = share - np.expm1(-dt / self.time_constant) * (1.0 - share)
        return (np.where(speed < self.rest_speed, grown, share * np.exp(-speed * (dt / self.travel))),)

    def parts_after(self, point: OperatingPoint, before: Sequence[Any], after: Sequence[Any], dt: Any) -> Parts:
        """The level that rests have brought."""
        return Parts(dry=self.rise * after[0])

    def largest_torque(self, ranges: Ranges) -> float:
        """The whole rise."""
        return self.rise

"""Static friction that grows while the joint rests."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import DynamicTerm, OperatingPoint, Scalar, require_nonnegative, require_positive

__all__ = ["DwellStiction"]


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

    def torque(self, point: OperatingPoint) -> Scalar:
        """Nothing: a joint in steady sliding has lost what its rest brought."""
        return 0.0 * np.asarray(point.velocity, dtype=np.float64)

    def rest_state(self) -> Scalar:
        """Nothing of the rise [1]: how long a joint has been at rest before is not known."""
        return 0.0

    def advance(self, state: Scalar, point: OperatingPoint, dt: float) -> tuple[Scalar, Scalar]:
        """Torque and share of the rise after `dt` [s]."""
        v, before = np.asarray(point.velocity, dtype=np.float64), np.asarray(state)
        speed = np.abs(v)
        grown = before - np.expm1(-dt / self.time_constant) * (1.0 - before)
        share = np.where(speed < self.rest_speed, grown, before * np.exp(-speed * dt / self.travel))
        return self.rise * share * np.sign(v), share

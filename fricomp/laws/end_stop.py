"""A stop or bumper at one end of the range, or at both."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Scalar, Term, require, require_finite, require_nonnegative


@dataclass(frozen=True)
class EndStop(Term):
    """side max(k d (1 + h d) + c side v, 0) beyond the edge, with d = side (q - q_e): it pushes back and never pulls.

    A like stop at the other end acts from d = -travel on, the other way.

    Attributes:
        stiffness: k [N·m/rad] or [N/m].
        edge: q_e, where it begins to act [rad] or [m].
        side: 1 for the upper end, -1 for the lower one.
        damping: c [N·m·s/rad] or [N·s/m].
        travel: Free way to a like stop at the other end [rad] or [m]; 0 where there is none.
        hardening: h, by which a bumper stiffens as it is pressed [1/rad] or [1/m].
    """

    name: ClassVar[str] = "end_stop"
    units: ClassVar[Mapping[str, str]] = {
        "stiffness": "{torque}/{position}",
        "edge": "{position}",
        "side": "1",
        "damping": "{torque}·s/{position}",
        "travel": "{position}",
        "hardening": "1/{position}",
    }

    stiffness: float
    edge: float
    side: float
    damping: float = 0.0
    travel: float = 0.0
    hardening: float = 0.0

    def __post_init__(self) -> None:
        require_finite(self, "edge")
        require_nonnegative(self, "stiffness", "damping", "travel", "hardening")
        require(self.side in (1.0, -1.0), f"side must be 1 or -1, got {self.side!r}")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        depth, speed = self.side * (point.position - self.edge), self.side * point.velocity
        push = self._push(depth, speed)
        if self.travel > 0.0:
            push = push - self._push(-depth - self.travel, -speed)
        return Parts(held=self.side * push)

    def _push(self, depth: Scalar, speed: Scalar) -> Scalar:
        """Torque against going deeper, nothing outside."""
        damped = np.where(depth > 0.0, self.damping * speed, 0.0)
        pressed: Scalar = np.maximum(depth, 0.0)
        return np.maximum(self.stiffness * pressed * (1.0 + self.hardening * pressed) + damped, 0.0)

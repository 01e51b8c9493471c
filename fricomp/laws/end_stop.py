"""A stop or bumper at one end of the range."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Term, require, require_finite, require_nonnegative

__all__ = ["EndStop"]


@dataclass(frozen=True)
class EndStop(Term):
    """side max(k d + c side v, 0) beyond the edge, with d = side (q - q_e): it pushes back and never pulls.

    Attributes:
        stiffness: k [N·m/rad] or [N/m].
        edge: q_e, where it begins to act [rad] or [m].
        side: 1 for the upper end, -1 for the lower one.
        damping: c [N·m·s/rad] or [N·s/m].
    """

    name: ClassVar[str] = "end_stop"
    units: ClassVar[Mapping[str, str]] = {
        "stiffness": "{torque}/{position}",
        "edge": "{position}",
        "side": "1",
        "damping": "{torque}·s/{position}",
    }

    stiffness: float
    edge: float
    side: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        require_finite(self, "edge")
        require_nonnegative(self, "stiffness", "damping")
        require(self.side in (1.0, -1.0), f"side must be 1 or -1, got {self.side!r}")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        depth = np.maximum(self.side * (point.position - self.edge), 0.0)
        pushed = self.stiffness * depth + np.where(depth > 0.0, self.damping * self.side * point.velocity, 0.0)
        return Parts(held=self.side * np.maximum(pushed, 0.0))

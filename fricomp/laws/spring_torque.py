"""A spring between the joint and its base."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Scalar, Term, require_nonnegative

__all__ = ["SpringTorque"]


@dataclass(frozen=True)
class SpringTorque(Term):
    """k (q - q_0).

    Attributes:
        stiffness: k [N·m/rad] or [N/m].
        centre: q_0 [rad] or [m].
    """

    name: ClassVar[str] = "spring_torque"
    units: ClassVar[Mapping[str, str]] = {"stiffness": "{torque}/{position}", "centre": "{position}"}

    stiffness: float
    centre: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "stiffness")

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        return self.stiffness * (np.asarray(point.position, dtype=np.float64) - self.centre)

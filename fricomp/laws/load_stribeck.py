"""Static friction that grows with the transmitted load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Scalar, Term, require_nonnegative, require_positive

__all__ = ["LoadStribeck"]


@dataclass(frozen=True)
class LoadStribeck(Term):
    """c_ls |tau_l| exp(-(v / v_s)^2) sgn(v) [duclusaud2025bam].

    Attributes:
        coefficient: c_ls [1].
        stribeck_velocity: v_s [rad/s] or [m/s].
    """

    name: ClassVar[str] = "load_stribeck"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "1", "stribeck_velocity": "{position}/s"}

    coefficient: float
    stribeck_velocity: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "coefficient")
        require_positive(self, "stribeck_velocity")

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        v = np.asarray(point.velocity, dtype=np.float64)
        falling = np.exp(-((v / self.stribeck_velocity) ** 2))
        return self.coefficient * np.abs(point.load_torque) * falling * np.sign(v)

"""Static friction that grows with the transmitted load."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.stribeck import compute_falling_share
from fricomp.laws.term import OperatingPoint, Parts, Term, require_nonnegative, require_positive


@dataclass(frozen=True)
class LoadStribeck(Term):
    """c_ls |tau_l| exp(-(|v| / v_s)^delta) sgn(v) [duclusaud2025bam].

    Attributes:
        coefficient: c_ls [1].
        stribeck_velocity: v_s [rad/s] or [m/s].
        stribeck_exponent: delta [1].
    """

    name: ClassVar[str] = "load_stribeck"
    units: ClassVar[Mapping[str, str]] = {
        "coefficient": "1",
        "stribeck_velocity": "{position}/s",
        "stribeck_exponent": "1",
    }

    coefficient: float
    stribeck_velocity: float
    stribeck_exponent: float = 2.0

    def __post_init__(self) -> None:
        require_nonnegative(self, "coefficient")
        require_positive(self, "stribeck_velocity", "stribeck_exponent")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        falling = compute_falling_share(point.speed, self.stribeck_velocity, self.stribeck_exponent)
        return Parts(dry=self.coefficient * np.abs(point.load_torque) * falling)

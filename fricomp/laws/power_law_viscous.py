"""Viscous friction that grows less than in proportion to speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Scalar, Term, require_nonnegative, require_positive

__all__ = ["PowerLawViscous"]


@dataclass(frozen=True)
class PowerLawViscous(Term):
    """c |v|^n sgn(v) [wolf2018].

    Attributes:
        coefficient: c [N·m·(s/rad)^n].
        exponent: n [1].
    """

    name: ClassVar[str] = "power_law_viscous"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "{torque}·(s/{position})^n", "exponent": "1"}

    coefficient: float
    exponent: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "coefficient")
        require_positive(self, "exponent")

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        v = np.asarray(point.velocity, dtype=np.float64)
        return self.coefficient * np.abs(v) ** self.exponent * np.sign(v)

"""Viscous friction that grows less than in proportion to speed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Term, require_nonnegative, require_positive


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

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        size = self.coefficient * np.abs(point.velocity) ** self.exponent
        return Parts(drag=np.where(point.is_forward, size, -size))

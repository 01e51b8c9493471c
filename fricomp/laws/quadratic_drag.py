"""Drag that grows with the square of the speed."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Term, require_nonnegative


@dataclass(frozen=True)
class QuadraticDrag(Term):
    """c v |v| [bittencourt2010].

    Attributes:
        coefficient: c [N·m·s²/rad²] or [N·s²/m²].
    """

    name: ClassVar[str] = "quadratic_drag"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "{torque}·s²/{position}²"}

    coefficient: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "coefficient")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(drag=self.coefficient * point.velocity * np.abs(point.velocity))

"""Coulomb friction that grows with the transmitted load."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Term, require_nonnegative


@dataclass(frozen=True)
class LoadCoulomb(Term):
    """c_l |tau_l| sgn(v) [bittencourt2010].

    Attributes:
        coefficient: c_l [1].
    """

    name: ClassVar[str] = "load_coulomb"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "1"}

    coefficient: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "coefficient")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(dry=self.coefficient * np.abs(point.load_torque))

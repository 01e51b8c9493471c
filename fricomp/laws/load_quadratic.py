"""Coulomb friction that curves with the transmitted load."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from fricomp.laws.term import OperatingPoint, Parts, Term, require_nonnegative


@dataclass(frozen=True)
class LoadQuadratic(Term):
    """c_q tau_l^2 sgn(v) [duclusaud2025bam].

    Attributes:
        coefficient: c_q [1/(N·m)] or [1/N].
    """

    name: ClassVar[str] = "load_quadratic"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "1/{torque}"}

    coefficient: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "coefficient")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(dry=self.coefficient * point.load_torque**2)

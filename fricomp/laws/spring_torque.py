"""A spring between the joint and its base."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from fricomp.laws.term import OperatingPoint, Parts, Term, require_finite, require_nonnegative


@dataclass(frozen=True)
class SpringTorque(Term):
    """k (x + h x^3), x = q - q_0.

    Attributes:
        stiffness: k [N·m/rad] or [N/m].
        centre: q_0 [rad] or [m].
        hardening: h [1/rad²] or [1/m²]: part by which the spring stiffens at one unit of stretch.
    """

    name: ClassVar[str] = "spring_torque"
    units: ClassVar[Mapping[str, str]] = {
        "stiffness": "{torque}/{position}",
        "centre": "{position}",
        "hardening": "1/{position}²",
    }

    stiffness: float
    centre: float
    hardening: float = 0.0

    def __post_init__(self) -> None:
        require_finite(self, "centre")
        require_nonnegative(self, "stiffness", "hardening")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        stretch = point.position - self.centre
        return Parts(held=self.stiffness * stretch * (1.0 + self.hardening * stretch**2))

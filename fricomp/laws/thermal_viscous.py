"""Viscous friction that falls as the joint warms; without a temperature it is what it is at the reference."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from fricomp.laws.term import OperatingPoint, Parts, Term, require_finite


@dataclass(frozen=True)
class ThermalViscous(Term):
    """-b (T - T_0) v [simoni2015].

    Attributes:
        slope: b [N·m·s/rad/K].
        reference_temperature: T_0 [°C].
    """

    name: ClassVar[str] = "thermal_viscous"
    units: ClassVar[Mapping[str, str]] = {"slope": "{torque}·s/{position}/K", "reference_temperature": "°C"}

    slope: float
    reference_temperature: float

    def __post_init__(self) -> None:
        require_finite(self, "slope", "reference_temperature")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        warmth = point.temperature_or(self.reference_temperature) - self.reference_temperature
        return Parts(drag=-self.slope * warmth * point.velocity)

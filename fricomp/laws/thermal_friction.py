"""Viscous and Coulomb friction that fall as the joint warms; without a temperature they are those at the reference."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Term, require_finite, require_positive

STRONGEST_FALL = 3.0
"""Most that the logarithm of viscous friction changes [1]: no temperature, however wrong, makes it any size."""


@dataclass(frozen=True)
class ThermalFriction(Term):
    """F_v (exp(-b (T - T_0) / F_v) - 1) v - g (T - T_0) sgn(v) [simoni2015], beside the friction at T_0.

    The second part knows no F_c that it lowers: far beyond the temperatures it was identified at it turns the sign of
    the whole. A compensation holds the temperature to their range, and all dry friction together above zero.

    Attributes:
        forward_viscous: F_v at T_0 for v > 0 [N·m·s/rad] or [N·s/m].
        reverse_viscous: F_v at T_0 for v < 0, likewise.
        viscous_slope: b [N·m·s/rad/K] or [N·s/m/K].
        coulomb_slope: g [N·m/K] or [N/K].
        reference_temperature: T_0 [°C].
    """

    name: ClassVar[str] = "thermal_friction"
    units: ClassVar[Mapping[str, str]] = {
        "forward_viscous": "{torque}·s/{position}",
        "reverse_viscous": "{torque}·s/{position}",
        "viscous_slope": "{torque}·s/{position}/K",
        "coulomb_slope": "{torque}/K",
        "reference_temperature": "°C",
    }

    forward_viscous: float
    reverse_viscous: float
    viscous_slope: float
    coulomb_slope: float
    reference_temperature: float

    def __post_init__(self) -> None:
        require_positive(self, "forward_viscous", "reverse_viscous")
        require_finite(self, "viscous_slope", "coulomb_slope", "reference_temperature")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        warmth = point.temperature_or(self.reference_temperature) - self.reference_temperature
        viscous = np.where(point.is_forward, self.forward_viscous, self.reverse_viscous)
        fall = np.clip(self.viscous_slope * warmth / viscous, -STRONGEST_FALL, STRONGEST_FALL)
        return Parts(drag=viscous * np.expm1(-fall) * point.velocity, dry=-self.coulomb_slope * warmth)

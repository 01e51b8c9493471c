"""Viscous friction that falls as the joint warms; without a temperature it is what it is at the reference."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Scalar, Term, require_finite

__all__ = ["ThermalViscous"]


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

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        v = np.asarray(point.velocity, dtype=np.float64)
        if point.temperature is None:
            return 0.0 * v
        return -self.slope * (np.asarray(point.temperature) - self.reference_temperature) * v

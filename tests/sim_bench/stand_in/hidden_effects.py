"""Friction terms that no law of the package has: what a user may hide in a joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws import OperatingPoint, Parts, Term


@dataclass(frozen=True)
class Ripple(Term):
    """A torque fixed to the angle, whatever the direction of motion: A sin(k q)."""

    name: ClassVar[str] = "test_ripple"
    units: ClassVar[Mapping[str, str]] = {"amplitude": "{torque}", "order": "1"}

    amplitude: float
    order: float

    def parts(self, point: OperatingPoint) -> Parts:
        return Parts(held=self.amplitude * np.sin(self.order * point.position))


@dataclass(frozen=True)
class LoadFriction(Term):
    """Coulomb friction that grows with the transmitted torque: c |tau_l| sgn(v)."""

    name: ClassVar[str] = "test_load_friction"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "1"}

    coefficient: float

    def parts(self, point: OperatingPoint) -> Parts:
        return Parts(dry=self.coefficient * np.abs(point.load_torque))


@dataclass(frozen=True)
class ThinningOil(Term):
    """Viscous friction that falls by a share of itself for each kelvin above 25 °C."""

    name: ClassVar[str] = "test_thinning_oil"
    units: ClassVar[Mapping[str, str]] = {"viscous_coefficient": "{torque}·s/{position}", "thinning": "1/K"}

    viscous_coefficient: float
    thinning: float

    def parts(self, point: OperatingPoint) -> Parts:
        factor = np.exp(-self.thinning * (point.temperature_or(25.0) - 25.0))
        return Parts(drag=self.viscous_coefficient * factor * point.velocity)

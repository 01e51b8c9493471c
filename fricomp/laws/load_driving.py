"""Coulomb friction that grows with the transmitted load while the joint drives it, and not while it brakes it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Term, require_finite


@dataclass(frozen=True)
class LoadDriving(Term):
    """c_d |tau_l| [tau_l v > 0] sgn(v) [duclusaud2025bam]: the teeth of a gear press harder while they push the load.

    Attributes:
        coefficient: c_d [1]; negative where braking takes more than driving.
    """

    name: ClassVar[str] = "load_driving"
    units: ClassVar[Mapping[str, str]] = {"coefficient": "1"}

    coefficient: float

    def __post_init__(self) -> None:
        require_finite(self, "coefficient")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        load = point.load_torque
        return Parts(dry=self.coefficient * np.maximum(np.where(point.is_forward, load, -load), 0.0))

"""Coulomb friction that curves with the transmitted load."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Scalar, Term, require_nonnegative

__all__ = ["LoadQuadratic"]


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

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        load = np.asarray(point.load_torque, dtype=np.float64)
        return self.coefficient * load**2 * np.sign(point.velocity)

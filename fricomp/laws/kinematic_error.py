"""The torque of a gear that runs unevenly: its load is ahead of and behind the joint."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Scalar, Term, require_finite, require_nonnegative

__all__ = ["KinematicError"]


@dataclass(frozen=True)
class KinematicError(Term):
    """e' (G + 2 J_l a) + J_l e'' v^2 + G' e with e = A sin(n q) + B cos(n q), G = C cos q + S sin q [tuttle1992].

    Lagrange's equation of a load at q + e(q), less that of one at q.

    Attributes:
        sine: A, by which the load is ahead [rad] or [m].
        cosine: B, likewise.
        order: n, waves per radian or metre, times 2 pi [1/rad] or [1/m].
        load_inertia: J_l of what is behind the gear [kg·m²] or [kg].
        gravity_cosine: C of its gravity torque [N·m]; 0 for a linear joint.
        gravity_sine: S, likewise.
    """

    name: ClassVar[str] = "kinematic_error"
    units: ClassVar[Mapping[str, str]] = {
        "sine": "{position}",
        "cosine": "{position}",
        "order": "1/{position}",
        "load_inertia": "{torque}·s²/{position}",
        "gravity_cosine": "{torque}",
        "gravity_sine": "{torque}",
    }

    sine: float
    cosine: float
    order: float
    load_inertia: float
    gravity_cosine: float = 0.0
    gravity_sine: float = 0.0

    def __post_init__(self) -> None:
        require_nonnegative(self, "order", "load_inertia")
        require_finite(self, "sine", "cosine", "gravity_cosine", "gravity_sine")

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        q, v = np.asarray(point.position, dtype=np.float64), np.asarray(point.velocity, dtype=np.float64)
        wave_cosine, wave_sine = np.cos(self.order * q), np.sin(self.order * q)
        error = self.sine * wave_sine + self.cosine * wave_cosine
        slope = self.order * (self.sine * wave_cosine - self.cosine * wave_sine)
        gravity = self.gravity_cosine * np.cos(q) + self.gravity_sine * np.sin(q)
        gradient = self.gravity_sine * np.cos(q) - self.gravity_cosine * np.sin(q)
        pushed = slope * (gravity + 2.0 * self.load_inertia * np.asarray(point.acceleration, dtype=np.float64))
        return pushed - self.load_inertia * self.order**2 * error * v**2 + gradient * error

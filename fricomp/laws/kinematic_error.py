"""The torque of a gear that runs unevenly: its load is ahead of and behind the joint.

A law holds a term of each name once; an unevenness of several orders is several terms, as a ripple is.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Ranges, Term, require_finite, require_nonnegative


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

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        q = point.position
        wave_cosine, wave_sine = np.cos(self.order * q), np.sin(self.order * q)
        error = self.sine * wave_sine + self.cosine * wave_cosine
        slope = self.order * (self.sine * wave_cosine - self.cosine * wave_sine)
        gravity = self.gravity_cosine * np.cos(q) + self.gravity_sine * np.sin(q)
        gradient = self.gravity_sine * np.cos(q) - self.gravity_cosine * np.sin(q)
        pushed = slope * (gravity + 2.0 * self.load_inertia * point.acceleration)
        return Parts(held=pushed - self.load_inertia * self.order**2 * error * point.velocity**2 + gradient * error)

    def largest_torque(self, ranges: Ranges) -> float:
        """Bound on the torque over `ranges`, from the amplitude of the error."""
        fastest = max(map(abs, ranges.velocity))
        gravity = math.hypot(self.gravity_cosine, self.gravity_sine)
        held = (1.0 + self.order) * gravity + self.load_inertia * (self.order * fastest) ** 2
        accelerated = 2.0 * self.load_inertia * self.order * max(map(abs, ranges.acceleration or (0.0,)))
        return math.hypot(self.sine, self.cosine) * (held + accelerated)


class KinematicError2(KinematicError):
    """A second order of the unevenness."""

    name: ClassVar[str] = "kinematic_error_2"


class KinematicError3(KinematicError):
    """A third order of the unevenness."""

    name: ClassVar[str] = "kinematic_error_3"


KINEMATIC_ERROR_TERMS: tuple[type[KinematicError], ...] = (KinematicError, KinematicError2, KinematicError3)
"""Terms that an unevenness of several orders is made of, strongest first."""

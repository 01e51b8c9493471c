"""What waves with the position: the torque itself, or the level of friction."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Ranges, Term, require_finite, require_nonnegative

__all__ = ["Cogging", "PositionCoulomb"]


@dataclass(frozen=True)
class _Ripple(Term):
    """w(q) = a sin(n q) + b cos(n q)."""

    units: ClassVar[Mapping[str, str]] = {"sine": "{torque}", "cosine": "{torque}", "order": "1/{position}"}

    sine: float
    cosine: float
    order: float

    def __post_init__(self) -> None:
        require_finite(self, "sine", "cosine")
        require_nonnegative(self, "order")

    def largest_torque(self, ranges: Ranges) -> float:
        """The amplitude of the wave."""
        return math.hypot(self.sine, self.cosine)

    def _wave(self, point: OperatingPoint) -> Any:
        angle = self.order * point.position
        return self.sine * np.sin(angle) + self.cosine * np.cos(angle)


@dataclass(frozen=True)
class Cogging(_Ripple):
    """Torque ripple that is fixed in the position: a sin(n q) + b cos(n q) [piccoli2016].

    Attributes:
        sine: a [N·m] or [N].
        cosine: b [N·m] or [N].
        order: n, waves per radian or metre, times 2 pi [1/rad] or [1/m].
    """

    name: ClassVar[str] = "cogging"

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(held=self._wave(point))


@dataclass(frozen=True)
class PositionCoulomb(_Ripple):
    """Coulomb friction that waves with the position: (a sin(n q) + b cos(n q)) sgn(v) [bittencourt2010].

    Attributes:
        sine: a [N·m] or [N].
        cosine: b [N·m] or [N].
        order: n, waves per radian or metre, times 2 pi [1/rad] or [1/m].
    """

    name: ClassVar[str] = "position_coulomb"

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(dry=self._wave(point))

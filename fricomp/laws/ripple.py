"""What waves with the position: the torque itself, or the level of friction."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from fricomp.laws.term import FloatArray, OperatingPoint, Scalar, Term, require_finite, require_nonnegative

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

    @abstractmethod
    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""

    def _wave(self, point: OperatingPoint) -> FloatArray:
        angle = self.order * np.asarray(point.position, dtype=np.float64)
        return np.asarray(self.sine * np.sin(angle) + self.cosine * np.cos(angle))


@dataclass(frozen=True)
class Cogging(_Ripple):
    """Torque ripple that is fixed in the position: a sin(n q) + b cos(n q) [piccoli2016].

    Attributes:
        sine: a [N·m] or [N].
        cosine: b [N·m] or [N].
        order: n, waves per radian or metre, times 2 pi [1/rad] or [1/m].
    """

    name: ClassVar[str] = "cogging"

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        return self._wave(point)


@dataclass(frozen=True)
class PositionCoulomb(_Ripple):
    """Coulomb friction that waves with the position: (a sin(n q) + b cos(n q)) sgn(v) [bittencourt2010].

    Attributes:
        sine: a [N·m] or [N].
        cosine: b [N·m] or [N].
        order: n, waves per radian or metre, times 2 pi [1/rad] or [1/m].
    """

    name: ClassVar[str] = "position_coulomb"

    def torque(self, point: OperatingPoint) -> Scalar:
        """Torque at `point`."""
        return self._wave(point) * np.sign(point.velocity)

"""What waves with the position: the torque itself, or the level of friction.

A law holds a term of each name once. A ripple of several orders is several terms: `cogging`, `cogging_2` and so on.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from fricomp.laws.term import OperatingPoint, Parts, Ranges, Term, require_finite, require_nonnegative

__all__ = ["COGGING_TERMS", "POSITION_COULOMB_TERMS", "Cogging", "PositionCoulomb"]


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


class Cogging2(Cogging):
    """A second order of the torque ripple."""

    name: ClassVar[str] = "cogging_2"


class Cogging3(Cogging):
    """A third order of the torque ripple."""

    name: ClassVar[str] = "cogging_3"


class Cogging4(Cogging):
    """A fourth order of the torque ripple."""

    name: ClassVar[str] = "cogging_4"


class Cogging5(Cogging):
    """A fifth order of the torque ripple."""

    name: ClassVar[str] = "cogging_5"


class Cogging6(Cogging):
    """A sixth order of the torque ripple."""

    name: ClassVar[str] = "cogging_6"


class PositionCoulomb2(PositionCoulomb):
    """A second order of friction over the position."""

    name: ClassVar[str] = "position_coulomb_2"


class PositionCoulomb3(PositionCoulomb):
    """A third order of friction over the position."""

    name: ClassVar[str] = "position_coulomb_3"


COGGING_TERMS: tuple[type[Cogging], ...] = (Cogging, Cogging2, Cogging3, Cogging4, Cogging5, Cogging6)
"""Terms that a ripple of several orders is made of, strongest first."""

POSITION_COULOMB_TERMS: tuple[type[PositionCoulomb], ...] = (PositionCoulomb, PositionCoulomb2, PositionCoulomb3)
"""The same of friction over the position."""

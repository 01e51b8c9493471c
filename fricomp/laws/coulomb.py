"""Coulomb and viscous friction, and the smoothed forms that avoid the jump at rest."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from fricomp.laws.load import LoadScaling
from fricomp.laws.term import OperatingPoint, Parts, Term, require, require_nonnegative, require_positive

_LOAD_UNITS = {"load_sensitivity": "1", "reference_load": "as normal_load"}


@dataclass(frozen=True)
class Coulomb(Term):
    """F_c sgn(v).

    Attributes:
        coulomb_torque: F_c [N·m] or [N].
        load: How it follows the normal load.
    """

    name: ClassVar[str] = "coulomb"
    units: ClassVar[Mapping[str, str]] = {"coulomb_torque": "{torque}", **_LOAD_UNITS}

    coulomb_torque: float
    load: LoadScaling = LoadScaling()

    def __post_init__(self) -> None:
        require_nonnegative(self, "coulomb_torque")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(dry=self.load.factor_at(point) * self.coulomb_torque)


@dataclass(frozen=True)
class Viscous(Term):
    """F_v v.

    Attributes:
        viscous_coefficient: F_v [N·m·s/rad] or [N·s/m].
    """

    name: ClassVar[str] = "viscous"
    units: ClassVar[Mapping[str, str]] = {"viscous_coefficient": "{torque}·s/{position}"}

    viscous_coefficient: float

    def __post_init__(self) -> None:
        require_nonnegative(self, "viscous_coefficient")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        return Parts(drag=self.viscous_coefficient * point.velocity)


@dataclass(frozen=True)
class SmoothedCoulomb(Term):
    """Coulomb friction without the jump at rest: F_c (2/pi) atan(v/v_0), or F_c tanh(v/v_0), the sigmoid form.

    Attributes:
        coulomb_torque: F_c [N·m] or [N].
        smoothing_velocity: v_0 [rad/s] or [m/s].
        shape: `tanh` or `arctan`.
        load: How it follows the normal load.
    """

    name: ClassVar[str] = "smoothed_coulomb"
    units: ClassVar[Mapping[str, str]] = {
        "coulomb_torque": "{torque}",
        "smoothing_velocity": "{position}/s",
        **_LOAD_UNITS,
    }

    coulomb_torque: float
    smoothing_velocity: float
    shape: Literal["tanh", "arctan"] = "tanh"
    load: LoadScaling = LoadScaling()

    def __post_init__(self) -> None:
        require_nonnegative(self, "coulomb_torque")
        require_positive(self, "smoothing_velocity")
        require(self.shape in ("tanh", "arctan"), f"shape must be 'tanh' or 'arctan', got {self.shape!r}")

    def parts(self, point: OperatingPoint) -> Parts:
        """Torque at `point`."""
        ratio = point.speed / self.smoothing_velocity
        share = np.tanh(ratio) if self.shape == "tanh" else 2.0 / np.pi * np.arctan(ratio)
        return Parts(dry=self.load.factor_at(point) * self.coulomb_torque * share)

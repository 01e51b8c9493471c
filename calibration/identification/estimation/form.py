"""Static friction laws in separable form: linear in most parameters, which variable projection uses."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from fricomp.errors import IdentificationError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    FloatArray,
    FrictionLaw,
    LoadScaling,
    SmoothedCoulomb,
    Stribeck,
    StribeckCurve,
    Viscous,
)

from .observation import Observations

__all__ = ["LARGEST_DRY", "Basis", "SeparableLaw", "separable_law", "separable_law_names"]


class Basis(ABC):
    """Columns of one branch: friction = columns(speed, shape) @ linear parameters, all of them positive.

    Attributes:
        dry: Which columns are dry friction, and so follow the normal load.
        shape_index: Position of the nonlinear parameter among the branch's parameters, or None.
    """

    dry: ClassVar[tuple[bool, ...]]
    shape_index: ClassVar[int | None] = None

    @abstractmethod
    def columns(self, speed: FloatArray, shape: float) -> FloatArray:
        """Shape (n_points, n_linear)."""

    def slopes(self, speed: FloatArray, shape: float) -> FloatArray:
        """Derivative of the columns by log(shape). Shape (n_points, n_linear)."""
        return np.zeros((len(speed), len(self.dry)))


class _Stribeck(Basis):
    dry = (True, True, False)
    shape_index = 2

    def columns(self, speed: FloatArray, shape: float) -> FloatArray:
        g = np.exp(-((speed / shape) ** 2))
        return np.stack([1.0 - g, g, speed], axis=1)

    def slopes(self, speed: FloatArray, shape: float) -> FloatArray:
        x = (speed / shape) ** 2
        dg = 2.0 * x * np.exp(-x)
        return np.stack([-dg, dg, np.zeros_like(speed)], axis=1)


class _Coulomb(Basis):
    dry = (True,)

    def columns(self, speed: FloatArray, shape: float) -> FloatArray:
        return np.ones((len(speed), 1))


class _CoulombViscous(Basis):
    dry = (True, False)

    def columns(self, speed: FloatArray, shape: float) -> FloatArray:
        return np.stack([np.ones_like(speed), speed], axis=1)


class _Tanh(Basis):
    dry = (True, False)
    shape_index = 1

    def columns(self, speed: FloatArray, shape: float) -> FloatArray:
        return np.stack([np.tanh(speed / shape), speed], axis=1)

    def slopes(self, speed: FloatArray, shape: float) -> FloatArray:
        x = speed / shape
        return np.stack([-x * (1.0 - np.tanh(x) ** 2), np.zeros_like(speed)], axis=1)


class _Arctan(_Tanh):
    def columns(self, speed: FloatArray, shape: float) -> FloatArray:
        return np.stack([2.0 / np.pi * np.arctan(speed / shape), speed], axis=1)

    def slopes(self, speed: FloatArray, shape: float) -> FloatArray:
        x = speed / shape
        return np.stack([-2.0 / np.pi * x / (1.0 + x**2), np.zeros_like(speed)], axis=1)


@dataclass(frozen=True)
class SeparableLaw:
    """A static law whose parameters are estimated as logarithms, and so are positive by construction.

    Attributes:
        name: Name for `identify(law=...)`.
        basis: Columns of each branch.
        names: Dotted names of the parameters in the law, branch after branch; the load sensitivity last if free.
        template: A law of this form; its parameter values do not matter, its reference load does.
        bidirectional: Whether each direction is a branch of its own.
        sensitivity_name: Dotted name of the load sensitivity, or None where it is not estimated.
    """

    name: str
    basis: Basis
    names: tuple[str, ...]
    template: FrictionLaw
    bidirectional: bool
    reference_load: float = 1.0
    sensitivity_name: str | None = None

    @property
    def branch_size(self) -> int:
        """Parameters of one branch."""
        return len(self.basis.dry) + (self.basis.shape_index is not None)

    @property
    def linear_index(self) -> tuple[int, ...]:
        """Positions of the linear parameters within a branch."""
        return tuple(i for i in range(self.branch_size) if i != self.basis.shape_index)

    def branches(self, observations: Observations) -> list[np.ndarray[tuple[int], np.dtype[np.bool_]]]:
        """The points of each branch, as masks."""
        if self.bidirectional:
            return [observations.forward, ~observations.forward]
        return [np.ones(observations.size, dtype=bool)]

    def evaluate(self, logs: FloatArray, observations: Observations) -> tuple[FloatArray, FloatArray]:
        """Friction magnitude and its derivative by the logarithms of the parameters.

        Args:
            logs: Natural logarithms of the parameters, in the order of `names`. Shape (n_parameters,).
            observations: Where to evaluate.

        Returns:
            Shapes (n_points,) and (n_points, n_parameters).
        """
        values = np.exp(logs)
        magnitude, jacobian = np.empty(observations.size), np.zeros((observations.size, len(logs)))
        sensitivity = values[-1] if self.sensitivity_name else 1.0
        for k, rows in enumerate(self.branches(observations)):
            at = slice(k * self.branch_size, (k + 1) * self.branch_size)
            branch = values[at]
            shape = branch[self.basis.shape_index] if self.basis.shape_index is not None else 1.0
            linear = branch[list(self.linear_index)]
            plain = self.basis.columns(observations.speed[rows], shape)
            factor = self.load_factor(observations.select(np.flatnonzero(rows)), sensitivity)
            columns = plain * factor
            magnitude[rows] = columns @ linear
            block = np.empty((len(plain), self.branch_size))
            block[:, list(self.linear_index)] = columns * linear
            if self.basis.shape_index is not None:
                slopes = self.basis.slopes(observations.speed[rows], shape)
                block[:, self.basis.shape_index] = (slopes * factor) @ linear
            jacobian[rows, at] = block
            if self.sensitivity_name:
                jacobian[rows, -1] = (plain * (factor - 1.0)) @ linear
        return magnitude, jacobian

    def load_factor(self, observations: Observations, sensitivity: float) -> FloatArray:
        """Factor of each column under the normal load. Shape (n_points, n_linear)."""
        if observations.normal_load is None:
            return np.ones((observations.size, len(self.basis.dry)))
        scale = 1.0 + sensitivity * (observations.normal_load / self.reference_load - 1.0)
        return np.where(np.asarray(self.basis.dry), scale[:, None], 1.0)

    def upper_logs(self, observations: Observations) -> FloatArray:
        """Largest logarithms that a fit may reach. Shape (n_parameters,).

        Below the slowest speed and beyond the fastest one dry friction of any size fits the data; none of a real
        joint is many times what was measured.
        """
        load = observations.normal_load
        unloaded = 1.0 if load is None else max(1.0, self.reference_load / float(load.min()))
        most = np.log(LARGEST_DRY * unloaded * max(observations.torque_scale, 1e-300))
        return np.array([most if name.endswith(_DRY) else np.inf for name in self.names])

    def law(self, values: Mapping[str, float]) -> FrictionLaw:
        """The friction law with these parameters."""
        return self.template.replace(dict(values))


LARGEST_DRY = 10.0
"""Coulomb and static torque are at most this multiple of the largest torque measured [1]."""
_DRY = ("coulomb_torque", "static_torque")
_CURVE = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")
_ONE = StribeckCurve(1.0, 1.0, 1.0, 1.0)
_Template = tuple[Basis, tuple[str, ...], bool]
_FORMS: Mapping[str, _Template] = {
    "stribeck": (_Stribeck(), tuple(f"stribeck.{d}.{p}" for d in ("forward", "reverse") for p in _CURVE), True),
    "symmetric_stribeck": (_Stribeck(), tuple(f"symmetric_stribeck.curve.{p}" for p in _CURVE), False),
    "coulomb": (_Coulomb(), ("coulomb.coulomb_torque",), False),
    "coulomb_viscous": (_CoulombViscous(), ("coulomb.coulomb_torque", "viscous.viscous_coefficient"), False),
    "tanh": (
        _Tanh(),
        ("smoothed_coulomb.coulomb_torque", "smoothed_coulomb.smoothing_velocity", "viscous.viscous_coefficient"),
        False,
    ),
    "arctan": (
        _Arctan(),
        ("smoothed_coulomb.coulomb_torque", "smoothed_coulomb.smoothing_velocity", "viscous.viscous_coefficient"),
        False,
    ),
}


def separable_law_names() -> tuple[str, ...]:
    """Names of the static laws that `identify` knows."""
    return tuple(_FORMS)


def separable_law(name: str, load: LoadScaling | None = None, *, free_sensitivity: bool = False) -> SeparableLaw:
    """The static law called `name`.

    Args:
        name: One of `separable_law_names`.
        load: How dry friction follows the normal load.
        free_sensitivity: Whether the load sensitivity is estimated too.

    Raises:
        IdentificationError: There is no such law.
    """
    if name not in _FORMS:
        raise IdentificationError(f"unknown static law {name!r}; known: {', '.join(_FORMS)}")
    basis, names, bidirectional = _FORMS[name]
    template = _template(name, load or LoadScaling())
    owner = names[0].partition(".")[0]
    sensitivity = f"{owner}.load.load_sensitivity" if free_sensitivity else None
    all_names = (*names, sensitivity) if sensitivity else names
    reference = (load or LoadScaling()).reference_load
    return SeparableLaw(name, basis, all_names, template, bidirectional, reference, sensitivity)


def _template(name: str, load: LoadScaling) -> FrictionLaw:
    shape: Literal["tanh", "arctan"] = "arctan" if name == "arctan" else "tanh"
    templates = {
        "stribeck": (BidirectionalStribeck(_ONE, _ONE, load),),
        "symmetric_stribeck": (Stribeck(_ONE, load),),
        "coulomb": (Coulomb(1.0, load),),
        "coulomb_viscous": (Coulomb(1.0, load), Viscous(1.0)),
        "tanh": (SmoothedCoulomb(1.0, 1.0, shape, load), Viscous(1.0)),
        "arctan": (SmoothedCoulomb(1.0, 1.0, shape, load), Viscous(1.0)),
    }
    return FrictionLaw(templates[name])

"""Static friction laws in separable form: linear in most parameters, which variable projection uses."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar, NamedTuple

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
    Term,
    Viscous,
)

from .observation import Observations

Shapes = tuple[float, ...]

_TINY = 1e-300


class Basis(ABC):
    """Columns of one branch: friction = columns(speed, shapes) @ linear parameters, all of them positive.

    Attributes:
        dry: Which columns are dry friction, and so follow the normal load.
        shape_index: Positions of the nonlinear parameters, the shapes, among the branch's parameters: the velocity of
            its bend first, if it has one.
        bends: What is tried for the shapes beside that velocity where a search starts.
    """

    dry: ClassVar[tuple[bool, ...]]
    shape_index: ClassVar[tuple[int, ...]] = ()
    bends: ClassVar[tuple[Shapes, ...]] = ((),)

    @abstractmethod
    def columns(self, speed: FloatArray, shapes: Shapes) -> FloatArray:
        """Shape (n_points, n_linear)."""

    def slopes(self, speed: FloatArray, shapes: Shapes) -> list[FloatArray]:
        """Derivative of the columns by the logarithm of each shape. Shapes (n_points, n_linear)."""
        return []


class _Stribeck(Basis):
    dry = (True, True, False)
    shape_index: ClassVar[tuple[int, ...]] = (2,)

    def columns(self, speed: FloatArray, shapes: Shapes) -> FloatArray:
        velocity, exponent = _read_bend(shapes)
        columns = np.empty((len(speed), 3))
        columns[:, 1] = np.exp(-((speed / velocity) ** exponent))
        columns[:, 0] = 1.0 - columns[:, 1]
        columns[:, 2] = speed
        return columns

    def slopes(self, speed: FloatArray, shapes: Shapes) -> list[FloatArray]:
        velocity, exponent = _read_bend(shapes)
        x = (speed / velocity) ** exponent
        fall = x * np.exp(-x)
        by_velocity = np.zeros((len(speed), 3))
        by_velocity[:, 1] = exponent * fall
        by_velocity[:, 0] = -by_velocity[:, 1]
        if len(shapes) == 1:
            return [by_velocity]
        by_exponent = -np.log(np.maximum(x, _TINY)) * fall
        return [by_velocity, np.stack([-by_exponent, by_exponent, np.zeros_like(speed)], axis=1)]


class _FreeStribeck(_Stribeck):
    shape_index = (2, 4)
    bends = ((0.4,), (0.7,), (1.0,), (1.4,), (2.0,), (3.0,))


def _read_bend(shapes: Shapes) -> tuple[float, float]:
    """Stribeck velocity and exponent; the exponent is 2 where it is not free."""
    velocity, exponent = (*shapes, 2.0)[:2]
    return velocity, exponent


class _Coulomb(Basis):
    dry = (True,)

    def columns(self, speed: FloatArray, shapes: Shapes) -> FloatArray:
        return np.ones((len(speed), 1))


class _CoulombViscous(Basis):
    dry = (True, False)

    def columns(self, speed: FloatArray, shapes: Shapes) -> FloatArray:
        return np.stack([np.ones_like(speed), speed], axis=1)


class _Tanh(Basis):
    dry = (True, False)
    shape_index = (1,)

    def columns(self, speed: FloatArray, shapes: Shapes) -> FloatArray:
        return np.stack([np.tanh(speed / shapes[0]), speed], axis=1)

    def slopes(self, speed: FloatArray, shapes: Shapes) -> list[FloatArray]:
        x = speed / shapes[0]
        return [np.stack([-x * (1.0 - np.tanh(x) ** 2), np.zeros_like(speed)], axis=1)]


class _Arctan(_Tanh):
    def columns(self, speed: FloatArray, shapes: Shapes) -> FloatArray:
        return np.stack([2.0 / np.pi * np.arctan(speed / shapes[0]), speed], axis=1)

    def slopes(self, speed: FloatArray, shapes: Shapes) -> list[FloatArray]:
        x = speed / shapes[0]
        return [np.stack([-2.0 / np.pi * x / (1.0 + x**2), np.zeros_like(speed)], axis=1)]


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
        tied: Parameters of the law that always have the value of an estimated one, by their names.
    """

    name: str
    basis: Basis
    names: tuple[str, ...]
    template: FrictionLaw
    bidirectional: bool
    reference_load: float = 1.0
    sensitivity_name: str | None = None
    tied: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def branch_size(self) -> int:
        """Parameters of one branch."""
        return len(self.basis.dry) + len(self.basis.shape_index)

    @cached_property
    def linear_index(self) -> list[int]:
        """Positions of the linear parameters within a branch."""
        return [i for i in range(self.branch_size) if i not in self.basis.shape_index]

    def shapes_of(self, branch: FloatArray) -> Shapes:
        """The shapes among the parameters of one branch."""
        return tuple(float(branch[i]) for i in self.basis.shape_index)

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
            shapes = self.shapes_of(branch)
            linear = branch[self.linear_index]
            speed, load = observations.speed[rows], observations.normal_load
            plain = self.basis.columns(speed, shapes)
            factor = self.load_factor(None if load is None else load[rows], sensitivity)
            columns = plain * factor
            magnitude[rows] = columns @ linear
            block = np.empty((len(plain), self.branch_size))
            block[:, self.linear_index] = columns * linear
            slopes = self.basis.slopes(speed, shapes)
            for i, slope in zip(self.basis.shape_index, slopes, strict=True):
                block[:, i] = (slope * factor) @ linear
            jacobian[rows, at] = block
            if self.sensitivity_name:
                jacobian[rows, -1] = (plain * (factor - 1.0)) @ linear
        return magnitude, jacobian

    def load_factor(self, normal_load: FloatArray | None, sensitivity: float) -> FloatArray:
        """Factor of each column under the normal load. Shape (n_points, n_linear), or (1, 1) where there is none."""
        if normal_load is None:
            return _NO_LOAD
        scale = 1.0 + sensitivity * (normal_load / self.reference_load - 1.0)
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
        return self.template.replace(dict(values) | {name: values[of] for name, of in self.tied.items()})


_NO_LOAD = np.ones((1, 1))
LARGEST_DRY = 10.0
"""Coulomb and static torque are at most this multiple of the largest torque measured [1]."""
_DRY = ("coulomb_torque", "static_torque")
_CURVE = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")
_TIED: Mapping[str, Mapping[str, str]] = {
    "asymmetric_coulomb_viscous": {
        f"stribeck.{d}.static_torque": f"stribeck.{d}.coulomb_torque" for d in ("forward", "reverse")
    }
}
"""Of a form, the parameters that follow others: a Stribeck curve that does not fall."""
_ONE = StribeckCurve(1.0, 1.0, 1.0, 1.0)
_SMOOTHED = ("smoothed_coulomb.coulomb_torque", "smoothed_coulomb.smoothing_velocity", "viscous.viscous_coefficient")


class _Form(NamedTuple):
    """A basis with the names of its parameters, the terms they belong to, and whether each direction has its own."""

    basis: Basis
    names: tuple[str, ...]
    terms: Callable[[LoadScaling], tuple[Term, ...]]
    bidirectional: bool = False


def _list_bidirectional_names(*names: str) -> tuple[str, ...]:
    """Parameters of the bidirectional term."""
    return tuple(f"stribeck.{direction}.{name}" for direction in ("forward", "reverse") for name in names)


def _make_bidirectional(load: LoadScaling) -> tuple[Term, ...]:
    return (BidirectionalStribeck(_ONE, _ONE, load),)


_FORMS: Mapping[str, _Form] = {
    "stribeck": _Form(_Stribeck(), _list_bidirectional_names(*_CURVE), _make_bidirectional, True),
    "free_stribeck": _Form(
        _FreeStribeck(), _list_bidirectional_names(*_CURVE, "stribeck_exponent"), _make_bidirectional, True
    ),
    "symmetric_stribeck": _Form(
        _Stribeck(), tuple(f"symmetric_stribeck.curve.{p}" for p in _CURVE), lambda load: (Stribeck(_ONE, load),)
    ),
    "coulomb": _Form(_Coulomb(), ("coulomb.coulomb_torque",), lambda load: (Coulomb(1.0, load),)),
    "coulomb_viscous": _Form(
        _CoulombViscous(),
        ("coulomb.coulomb_torque", "viscous.viscous_coefficient"),
        lambda load: (Coulomb(1.0, load), Viscous(1.0)),
    ),
    "asymmetric_coulomb_viscous": _Form(
        _CoulombViscous(), _list_bidirectional_names("coulomb_torque", "viscous_coefficient"), _make_bidirectional, True
    ),
    "tanh": _Form(_Tanh(), _SMOOTHED, lambda load: (SmoothedCoulomb(1.0, 1.0, "tanh", load), Viscous(1.0))),
    "arctan": _Form(_Arctan(), _SMOOTHED, lambda load: (SmoothedCoulomb(1.0, 1.0, "arctan", load), Viscous(1.0))),
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
    form, load = _FORMS[name], load or LoadScaling()
    owner = form.names[0].partition(".")[0]
    sensitivity = f"{owner}.load.load_sensitivity" if free_sensitivity else None
    return SeparableLaw(
        name,
        form.basis,
        (*form.names, sensitivity) if sensitivity else form.names,
        FrictionLaw(form.terms(load)),
        form.bidirectional,
        load.reference_load,
        sensitivity,
        _TIED.get(name, {}),
    )

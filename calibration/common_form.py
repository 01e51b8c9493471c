"""Models whose friction laws differ in form, brought to the form that all can hold, so that their parameters compare.

`fricomp identify` chooses the law that its data determine, so that two models of one joint may be a Stribeck curve and
a straight line. Each curve f(v) of another form is fitted by the common one, g(v; p), over the speeds at which all
models hold: p minimises sum_i w(v_i) (g(v_i; p) - f(v_i))^2, and its covariance is that of f carried through this fit.
What p depends on the weights w is part of its covariance, since a model file does not say how often each speed came.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy import optimize

from fricomp.errors import ParameterError
from fricomp.laws import (
    BidirectionalStribeck,
    Coulomb,
    FloatArray,
    FrictionLaw,
    Stribeck,
    StribeckCurve,
    Viscous,
    find_inputs,
)
from fricomp.model import Covariance, FrictionModel

_CURVE = ("coulomb_torque", "static_torque", "stribeck_velocity", "viscous_coefficient")
_LINE = ("coulomb_torque", "viscous_coefficient")
_SPEEDS = 100
"""Speeds of each direction at which curves are fitted; the curves have no detail that more would show."""
_WEIGHTS: tuple[Callable[[FloatArray], FloatArray], ...] = (np.ones_like, np.reciprocal, np.abs)
"""Weights of the speeds: even ones give the parameters, those of slow and of fast motion how much they depend on it."""
_STEP = 1e-5
"""Part of a parameter by which the derivative of a curve is taken."""


class CommonForm(NamedTuple):
    """What the law of a model, or of several, can tell.

    Attributes:
        is_directed: Whether each direction of motion has parameters of its own.
        is_bent: Whether friction may fall from rest, as a Stribeck curve does.
    """

    is_directed: bool
    is_bent: bool

    def __str__(self) -> str:
        """In words."""
        whose = "of each direction" if self.is_directed else "of both directions"
        return f"Stribeck curves {whose}" if self.is_bent else f"straight lines {whose}"

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted names of its parameters."""
        words = _CURVE if self.is_bent else _LINE
        if self.is_directed:
            return tuple(f"stribeck.{side}.{word}" for side in ("forward", "reverse") for word in words)
        if self.is_bent:
            return tuple(f"symmetric_stribeck.curve.{word}" for word in words)
        return ("coulomb.coulomb_torque", "viscous.viscous_coefficient")

    def build_law(self, values: Sequence[float]) -> FrictionLaw:
        """The law with `values` in the order of `names`."""
        if not self.is_directed and not self.is_bent:
            return FrictionLaw((Coulomb(values[0]), Viscous(values[1])))
        if not self.is_directed:
            return FrictionLaw((Stribeck(self._build_curve(values)),))
        half = len(values) // 2
        return FrictionLaw((BidirectionalStribeck(self._build_curve(values[:half]), self._build_curve(values[half:])),))

    def _build_curve(self, values: Sequence[float]) -> StribeckCurve:
        if self.is_bent:
            return StribeckCurve(*values)
        level, slope = values
        return StribeckCurve(level, level, 1.0, slope)


def find_common_form(models: Iterable[FrictionModel]) -> CommonForm | None:
    """The form that the laws of `models` have in common; None where they are of one form, or no form holds one of them.

    A law that asks for more than the velocity, has a state, or whose parameters have no covariance, is of no form.
    """
    models = tuple(models)
    if not all(_has_known_curve(model) for model in models):
        return None
    forms = {_find_form(model) for model in models}
    terms = {tuple(sorted(term.name for term in model.law.terms)) for model in models}
    if len(forms) == 1 and len(terms) == 1:
        return None
    return CommonForm(all(form.is_directed for form in forms), all(form.is_bent for form in forms))


def bring_to_form(models: Sequence[FrictionModel], form: CommonForm) -> tuple[FrictionModel, ...]:
    """The same friction with the parameters of `form`, over the speeds at which all `models` hold.

    Raises:
        ParameterError: They hold over no common speed, or a curve cannot be fitted.
    """
    velocity = _list_common_velocities(models)
    return tuple(model if _is_of_form(model, form) else _fit_form(model, form, velocity) for model in models)


def _has_known_curve(model: FrictionModel) -> bool:
    """Whether friction follows from the velocity alone, by terms that were all identified."""
    if model.covariance is None or model.law.is_dynamic or find_inputs(model.law.terms):
        return False
    identified = {name.partition(".")[0] for name in model.covariance.names}
    return identified >= {term.name for term in model.law.terms}


def _find_form(model: FrictionModel) -> CommonForm:
    names = model.covariance.names if model.covariance else ()
    is_directed = any(".forward." in name or ".reverse." in name for name in names)
    return CommonForm(is_directed, any(name.endswith("stribeck_velocity") for name in names))


def _is_of_form(model: FrictionModel, form: CommonForm) -> bool:
    same_terms = {term.name for term in model.law.terms} == {name.partition(".")[0] for name in form.names}
    return model.covariance is not None and set(model.covariance.names) == set(form.names) and same_terms


def _list_common_velocities(models: Sequence[FrictionModel]) -> FloatArray:
    """Velocities of both directions at which all models hold, shape (n,) [rad/s] or [m/s]."""
    ranges = [model.validity.velocity or (-1.0, 1.0) for model in models]
    slowest = [model.provenance.slowest_speeds or (0.0, 0.0) for model in models]
    sides = []
    for k, sign in enumerate((-1.0, 1.0)):
        high = min(max(sign * limits[k], 0.0) for limits in ranges)
        low = max(*(one[k] for one in slowest), high / _SPEEDS)
        if low < high:
            sides.append(sign * np.linspace(low, high, _SPEEDS))
    if not sides:
        raise ParameterError("the models were identified over speeds that do not overlap")
    return np.concatenate(sides)


def _fit_form(model: FrictionModel, form: CommonForm, velocity: FloatArray) -> FrictionModel:
    """A model with the law of `form` that lies closest to the curve of `model`, with its covariance."""
    covariance = model.covariance
    if covariance is None:
        raise ParameterError("a model without a covariance cannot be brought to another form")
    fits = [_fit_curve(model, form, velocity, weigh(np.abs(velocity))) for weigh in _WEIGHTS]
    values, gain = fits[0]
    slopes = gain @ _differentiate(model.law, covariance.names, velocity)
    matrix = slopes @ covariance.matrix @ slopes.T
    for other, _ in fits[1:]:
        matrix = matrix + np.outer(other - values, other - values)
    matrix = 0.5 * (matrix + matrix.T)
    brought = Covariance(form.names, matrix, covariance.degrees_of_freedom)
    return replace(model, law=form.build_law(values.tolist()), covariance=brought)


def _fit_curve(
    model: FrictionModel, form: CommonForm, velocity: FloatArray, weight: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Parameters of `form`, and their derivatives by the torque at each velocity. Shapes (n_names,) and (n_names, n).

    Parameters are none that a law cannot have: where a line through a falling curve would fall, its slope is 0.
    """
    torque, root = np.asarray(model.law.torque(velocity)), np.sqrt(weight / np.mean(weight))
    start, size = _guess_start(model, form, velocity, torque)

    def left(scaled: FloatArray) -> FloatArray:
        found = form.build_law((scaled * size).tolist()).torque(velocity)
        return np.asarray(root * (np.asarray(found) - torque), dtype=np.float64)

    found = optimize.least_squares(left, start / size, bounds=(1e-9, np.inf), x_scale="jac")
    if not found.success:
        raise ParameterError(f"the curve of joint {model.joint!r} cannot be fitted by {form}")
    gain = np.linalg.pinv(np.asarray(found.jac), rcond=1e-9) * root
    return found.x * size, size[:, None] * gain


def _guess_start(
    model: FrictionModel, form: CommonForm, velocity: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Where a fit begins, and the size of each parameter. Shape (n_names,) each."""
    level, fastest = float(np.max(np.abs(torque))) or 1.0, float(np.max(np.abs(velocity)))
    own = model.law.parameters()
    known = {word: [own[name] for name in own if name.endswith(word)] for word in _CURVE}
    words = [name.rpartition(".")[2] for name in form.names]
    sizes = {"stribeck_velocity": fastest, "viscous_coefficient": level / fastest}
    size = np.array([sizes.get(word, level) for word in words])
    start = [
        float(np.mean(known[word])) if known[word] else 0.5 * scale for word, scale in zip(words, size, strict=True)
    ]
    return np.maximum(start, 1e-6 * size), size


def _differentiate(law: FrictionLaw, names: Sequence[str], velocity: FloatArray) -> FloatArray:
    """Derivatives of the torque by the parameters called `names`. Shape (n, n_names)."""
    values, torque = law.parameters(), np.asarray(law.torque(velocity))
    steps = [_STEP * (abs(values[name]) or 1.0) for name in names]
    moved = [
        np.asarray(law.replace({name: values[name] + step}).torque(velocity))
        for name, step in zip(names, steps, strict=True)
    ]
    columns = [(one - torque) / step for one, step in zip(moved, steps, strict=True)]
    return np.stack(columns, axis=1)

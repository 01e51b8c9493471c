"""Has a joint changed? Two identified models compared, parameter by parameter and as a whole."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import stats

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray, Scalar
from fricomp.model import FrictionModel

from .common_form import bring_to_form, find_common_form
from .normal_load import at_normal_load, own_load

_KNOWN = 1e9
"""Degrees of freedom where the size of a covariance is known, or the model file does not say what it is from."""


@dataclass(frozen=True)
class ParameterChange:
    """One parameter in both models.

    Attributes:
        name: Dotted name.
        unit: Unit of the values.
        old: Value in the old model.
        new: Value in the new model.
        standard_deviation: Of the difference.
        p_value: Two-sided, corrected for the number of parameters compared [holm1979].
    """

    name: str
    unit: str
    old: float
    new: float
    standard_deviation: float
    p_value: float

    @property
    def difference(self) -> float:
        """New minus old."""
        return self.new - self.old


@dataclass(frozen=True)
class ModelComparison:
    """What differs between two models of a joint.

    Attributes:
        changes: Every parameter with a variance in both models, the most significant first.
        p_value: Of all of them together, or 1 where there is none.
        significance: Level that decides `changed`.
        added: Terms only the new law has.
        removed: Terms only the old law has.
        largest_torque_change: Of the curve over the speeds that both models cover, in the models' torque unit.
        at_velocity: Where that is [rad/s] or [m/s].
        normal_load: At which parameters and curves of both models hold, in the unit of their loads; None where neither
            model knows its load.
        load_known: Whether the old and the new model know their load; one that does not is taken as loaded alike.
        common_form: As what both curves were compared, in words; empty where both laws are of one form.
    """

    changes: tuple[ParameterChange, ...]
    p_value: float
    significance: float
    added: tuple[str, ...]
    removed: tuple[str, ...]
    largest_torque_change: float
    at_velocity: float
    normal_load: float | None = None
    load_known: tuple[bool, bool] = (False, False)
    common_form: str = ""

    @property
    def changed(self) -> bool:
        """Whether the joint has changed."""
        return self.p_value < self.significance or bool(self.added or self.removed)

    @property
    def significant(self) -> tuple[ParameterChange, ...]:
        """The parameters that changed."""
        return tuple(change for change in self.changes if change.p_value < self.significance)


def compare_models(old: FrictionModel, new: FrictionModel, significance: float = 0.05) -> ModelComparison:
    """Compare two models that were identified from independent data.

    Dry friction grows with the normal load, so models that know theirs are brought to one load first: that of the old
    model, or the new one's where the old one does not know its own. Where the zero of the torque was taken off one of
    them alone, as a sweep can and a log cannot, what an offset may be is no change. Curves of laws that differ in form
    are compared by the parameters of the form that both can hold.

    Args:
        old: The model from before.
        new: The model from now, in the same units.
        significance: Chance to call an unchanged joint changed.

    Raises:
        ParameterError: The units differ, a model has no covariance, nothing can be compared, or a law has no dry
            friction left under the load of the other.
    """
    if (old.torque_unit, old.motion) != (new.torque_unit, new.motion):
        raise ParameterError(
            f"models in {old.torque_unit} ({old.motion}) and {new.torque_unit} ({new.motion}) cannot be compared"
        )
    if not 0.0 < significance < 1.0:
        raise ParameterError(f"significance must lie between 0 and 1, got {significance}")
    old, new, load, known = _evaluate_at_one_load(old, new)
    velocity, change = _find_largest_torque_change(old, new)
    form = find_common_form((old, new))
    if form is not None:
        old, new = bring_to_form((old, new), form)
    difference = _compute_difference(old, new)
    before, after, units = old.law.parameters(), new.law.parameters(), new.units()
    changes = [
        ParameterChange(name, units[name], before[name], after[name], float(sd), float(p))
        for name, sd, p in zip(difference.names, difference.deviation, difference.each(), strict=True)
    ]
    terms_before, terms_after = ({term.name for term in model.law.terms} for model in (old, new))
    return ModelComparison(
        changes=tuple(sorted(changes, key=lambda c: (c.p_value, -abs(c.difference) / c.standard_deviation))),
        p_value=difference.together(),
        significance=significance,
        added=tuple(sorted(terms_after - terms_before)),
        removed=tuple(sorted(terms_before - terms_after)),
        largest_torque_change=change,
        at_velocity=velocity,
        normal_load=load,
        load_known=known,
        common_form="" if form is None else str(form),
    )


class _AtOneLoad(NamedTuple):
    """Two models at one normal load, that load if any is known, and whose own load is known."""

    old: FrictionModel
    new: FrictionModel
    load: float | None
    known: tuple[bool, bool]


def _evaluate_at_one_load(old: FrictionModel, new: FrictionModel) -> _AtOneLoad:
    before, after = own_load(old), own_load(new)
    load = after if before is None else before
    if before is not None:
        old = at_normal_load(old, before)
    if load is not None and after is not None:
        new = at_normal_load(new, load)
    return _AtOneLoad(old, new, load, (before is not None, after is not None))


class _Difference(NamedTuple):
    """What two models say of the parameters that both have.

    Attributes:
        names: Dotted names.
        value: New minus old. Shape (n,).
        covariances: Of the old and the new values. Shape (n, n) each.
        freedoms: Degrees of freedom that the size of each was estimated from.
    """

    names: list[str]
    value: FloatArray
    covariances: tuple[FloatArray, FloatArray]
    freedoms: tuple[float, float]

    @property
    def deviation(self) -> FloatArray:
        """Standard deviation of each difference. Shape (n,)."""
        return np.asarray(np.sqrt(np.diag(self.covariances[0] + self.covariances[1])))

    def each(self) -> FloatArray:
        """p of each parameter, by Student's t, corrected for their number. Shape (n,)."""
        shares = [np.diag(covariance) / self.deviation**2 for covariance in self.covariances]
        return correct_for_number(2.0 * stats.t.sf(np.abs(self.value) / self.deviation, self._compute_freedom(*shares)))

    def together(self) -> float:
        """p of all parameters, by Fisher's F; 1 where there is none."""
        if self.value.size == 0:
            return 1.0
        scale = np.outer(self.deviation, self.deviation)
        correlations = [covariance / scale for covariance in self.covariances]
        rank = int(np.linalg.matrix_rank(sum(correlations), tol=1e-10))
        inverse = np.linalg.pinv(sum(correlations), rcond=1e-10)
        z = self.value / self.deviation
        shares = [np.trace(correlation @ inverse) / rank for correlation in correlations]
        return float(stats.f.sf(float(z @ inverse @ z) / rank, rank, self._compute_freedom(*shares)))

    def _compute_freedom(self, old: Scalar, new: Scalar) -> Scalar:
        """Degrees of freedom of the sum of both, by their shares in it [satterthwaite1946]."""
        return 1.0 / (old**2 / self.freedoms[0] + new**2 / self.freedoms[1])


def _compute_difference(old: FrictionModel, new: FrictionModel) -> _Difference:
    """The parameters with a variance in both models."""
    if old.covariance is None or new.covariance is None:
        raise ParameterError(_describe_missing_covariance(*(("old", old) if old.covariance is None else ("new", new))))
    both = (old.covariance, new.covariance)
    names = [name for name in old.covariance.names if name in new.covariance.names]
    if not names:
        laws = [" + ".join(term.name for term in model.law.terms) for model in (old, new)]
        raise ParameterError(
            f"the two models share no identified parameter, since their laws differ ({laws[0]} and {laws[1]}): "
            "identify the data of both with the same law (fricomp identify --law symmetric_stribeck, or "
            "coulomb_viscous where that is not determined)"
        )
    rows = [[covariance.names.index(name) for name in names] for covariance in both]
    first, second = (covariance.matrix[np.ix_(row, row)] for covariance, row in zip(both, rows, strict=True))
    known = np.flatnonzero(np.diag(first + second) > 0.0)
    names, part = [names[i] for i in known], np.ix_(known, known)
    before, after = old.law.parameters(), new.law.parameters()
    first, second = first[part], second[part]
    if says_other_zero(old, new):
        shift = _shift_by_offset(names)
        largest = np.max(np.abs(shift * [before[name] for name in names]), initial=0.0)
        second = second + np.outer(shift, shift) * largest**2
    return _Difference(
        names,
        np.array([after[name] - before[name] for name in names]),
        (first, second),
        (both[0].degrees_of_freedom or _KNOWN, both[1].degrees_of_freedom or _KNOWN),
    )


def says_other_zero(old: FrictionModel, new: FrictionModel) -> bool:
    """Whether the zero of the torque was taken off one of the models and counts as friction in the other."""
    return _has_zero(old) != _has_zero(new)


def _has_zero(model: FrictionModel) -> bool:
    return "+-" in model.provenance.notes.get("torque_offset", "")  # a number that was measured has a deviation


def _shift_by_offset(names: Sequence[str]) -> FloatArray:
    """By how much a constant torque of 1 shifts each parameter: the levels of both directions, opposite. Shape (n,)."""
    side = np.array([1.0 if ".forward." in name else -1.0 if ".reverse." in name else 0.0 for name in names])
    return side * [name.endswith(("coulomb_torque", "static_torque")) for name in names]


def _describe_missing_covariance(which: str, model: FrictionModel) -> str:
    """What to do about a model without a covariance, by where it comes from."""
    if model.provenance.method == "diagnosis":
        return (
            f"the {which} model was written by a diagnosis, which writes no covariance, so no change can be judged: "
            "make both models with fricomp identify or fricomp calibrate, or let fricomp watch follow the folder that "
            "both diagnoses lie in"
        )
    return f"the {which} model has no covariance, so no change can be judged: identify it from data"


def correct_for_number(p_values: FloatArray) -> FloatArray:
    """p of each of several comparisons, corrected for their number [holm1979]. Shape (n,).

    The smallest times n, the next times n - 1, never falling.
    """
    order = np.argsort(p_values)
    corrected = np.maximum.accumulate(p_values[order] * np.arange(p_values.size, 0, -1))
    result = np.empty_like(p_values)
    result[order] = np.minimum(corrected, 1.0)
    return result


def _find_largest_torque_change(old: FrictionModel, new: FrictionModel) -> tuple[float, float]:
    """The velocity at which the curves differ most, and by how much, over the range that both cover."""
    ranges = [model.validity.velocity or (-1.0, 1.0) for model in (old, new)]
    low, high = max(r[0] for r in ranges), min(r[1] for r in ranges)
    if low > high:
        raise ParameterError("the two models were identified over speeds that do not overlap")
    v = np.linspace(low, high, 2001)
    v = v[v != 0.0] if np.any(v != 0.0) else v
    change = np.asarray(new.torque(v)) - np.asarray(old.torque(v))
    i = int(np.argmax(np.abs(change)))
    return float(v[i]), float(change[i])

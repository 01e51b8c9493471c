"""Has a joint changed? Two identified models compared, parameter by parameter and as a whole."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy import stats

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from .normal_load import at_normal_load, own_load

__all__ = ["ModelComparison", "ParameterChange", "compare_models"]


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
        p_value: Of all of them together (Wald), or 1 where there is none.
        significance: Level that decides `changed`.
        added: Terms only the new law has.
        removed: Terms only the old law has.
        largest_torque_change: Of the curve over the speeds that both models cover, in the models' torque unit.
        at_velocity: Where that is [rad/s] or [m/s].
        normal_load: At which parameters and curves of both models hold, in the unit of their loads; None where neither
            model knows its load.
        load_known: Whether the old and the new model know their load; one that does not is taken as loaded alike.
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
    model, or the new one's where the old one does not know its own.

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
    old, new, load, known = _at_one_load(old, new)
    names, difference, covariance = _difference(old, new)
    deviation = np.sqrt(np.diag(covariance))
    p_values = _holm(2.0 * stats.norm.sf(np.abs(difference) / deviation))
    before, after, units = old.law.parameters(), new.law.parameters(), new.units()
    changes = [
        ParameterChange(name, units[name], before[name], after[name], float(sd), float(p))
        for name, sd, p in zip(names, deviation, p_values, strict=True)
    ]
    velocity, change = _largest_torque_change(old, new)
    terms_before, terms_after = ({term.name for term in model.law.terms} for model in (old, new))
    return ModelComparison(
        changes=tuple(sorted(changes, key=lambda c: (c.p_value, -abs(c.difference) / c.standard_deviation))),
        p_value=_wald(difference, covariance),
        significance=significance,
        added=tuple(sorted(terms_after - terms_before)),
        removed=tuple(sorted(terms_before - terms_after)),
        largest_torque_change=change,
        at_velocity=velocity,
        normal_load=load,
        load_known=known,
    )


class _AtOneLoad(NamedTuple):
    """Two models at one normal load, that load if any is known, and whose own load is known."""

    old: FrictionModel
    new: FrictionModel
    load: float | None
    known: tuple[bool, bool]


def _at_one_load(old: FrictionModel, new: FrictionModel) -> _AtOneLoad:
    before, after = own_load(old), own_load(new)
    load = after if before is None else before
    if before is not None:
        old = at_normal_load(old, before)
    if load is not None and after is not None:
        new = at_normal_load(new, load)
    return _AtOneLoad(old, new, load, (before is not None, after is not None))


def _difference(old: FrictionModel, new: FrictionModel) -> tuple[list[str], FloatArray, FloatArray]:
    """Names with a variance in both models, new minus old, and the covariance of that."""
    if old.covariance is None or new.covariance is None:
        raise ParameterError(_no_covariance(*(("old", old) if old.covariance is None else ("new", new))))
    names = [name for name in old.covariance.names if name in new.covariance.names]
    if not names:
        raise ParameterError("the two models share no identified parameter")
    blocks = []
    for covariance in (old.covariance, new.covariance):
        rows = [covariance.names.index(name) for name in names]
        blocks.append(covariance.matrix[np.ix_(rows, rows)])
    total = blocks[0] + blocks[1]
    known = np.flatnonzero(np.diag(total) > 0.0)
    names = [names[i] for i in known]
    before, after = old.law.parameters(), new.law.parameters()
    return names, np.array([after[n] - before[n] for n in names]), total[np.ix_(known, known)]


def _no_covariance(which: str, model: FrictionModel) -> str:
    """What to do about a model without a covariance, by where it comes from."""
    if model.provenance.method == "diagnosis":
        return (
            f"the {which} model was written by a diagnosis, which writes no covariance, so no change can be judged: "
            "make both models with fricomp identify or fricomp calibrate"
        )
    return f"the {which} model has no covariance, so no change can be judged: identify it from data"


def _wald(difference: FloatArray, covariance: FloatArray) -> float:
    if difference.size == 0:
        return 1.0
    scale = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(scale, scale)
    z = difference / scale
    statistic = float(z @ np.linalg.pinv(correlation, rcond=1e-10) @ z)
    return float(stats.chi2.sf(statistic, np.linalg.matrix_rank(correlation, tol=1e-10)))


def _holm(p_values: FloatArray) -> FloatArray:
    """Step-down correction: the smallest times n, the next times n - 1, never falling [holm1979]."""
    order = np.argsort(p_values)
    corrected = np.maximum.accumulate(p_values[order] * np.arange(p_values.size, 0, -1))
    result = np.empty_like(p_values)
    result[order] = np.minimum(corrected, 1.0)
    return result


def _largest_torque_change(old: FrictionModel, new: FrictionModel) -> tuple[float, float]:
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

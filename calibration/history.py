"""How the friction of joints goes over weeks: models of one joint in order of time, trends, and when it has changed."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats

from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.errors import FricompError
from fricomp.laws import FloatArray
from fricomp.report import Chart, Panel, Points

from .common_form import bring_to_form, find_common_form
from .comparison import compare_models, correct_for_number
from .kept_model import Estimate, KeptModel, list_parameters, read_kept

_DAY = 86_400.0
_FEWEST = 3
"""Models from which on a trend has an interval: two points always lie on a line."""
_REACH = 0.95
_SIGNIFICANCE = 0.05
"""Chance to call a joint changed whose diagnoses differ by chance alone, as that of `compare_models`."""


@dataclass(frozen=True, eq=False)
class Trend:
    """One parameter over time.

    Attributes:
        name: Dotted name.
        unit: Of its values.
        days: Since the first model, shape (n_models,) [d].
        values: Shape (n_models,).
        deviations: Their standard deviations, shape (n_models,).
        slope: Change a day, weighted by the deviations.
        reach: Half of its 95 % interval; it allows for scatter beyond the deviations. Infinite for two models.
    """

    name: str
    unit: str
    days: FloatArray
    values: FloatArray
    deviations: FloatArray
    slope: float
    reach: float

    @property
    def is_significant(self) -> bool:
        """Whether the interval of the slope leaves out zero."""
        return abs(self.slope) > self.reach


class Change(NamedTuple):
    """What differs between a model and the one before.

    Attributes:
        changed: Whether the joint has changed.
        names: Parameters that changed.
        added: Terms that only the later law has, or effects that only the later diagnosis named.
        removed: Those that only the earlier one has.
    """

    changed: bool
    names: tuple[str, ...]
    added: tuple[str, ...]
    removed: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class JointHistory:
    """The models of one joint: those that were identified, or those that diagnoses wrote.

    Attributes:
        joint: Its name.
        diagnosed: Whether diagnoses wrote them.
        models: In order of time.
        trends: Of every parameter that all models have, with a deviation.
        comparisons: Of each model but the first with the one before; None where they cannot be compared.
        refusals: Why not, for each of these; empty where they were compared.
        unit: Of their torque, where other models of the joint are in another one; else empty.
    """

    joint: str
    diagnosed: bool
    models: tuple[KeptModel, ...]
    trends: tuple[Trend, ...]
    comparisons: tuple[Change | None, ...]
    refusals: tuple[str, ...] = ()
    unit: str = ""

    @property
    def title(self) -> str:
        """The joint, that its diagnoses are followed where it has any, and the unit where there are several."""
        return ", ".join([self.joint, *(["diagnoses"] if self.diagnosed else []), *([self.unit] if self.unit else [])])

    @property
    def temperatures(self) -> FloatArray:
        """In the middle of what each model was identified at, NaN where that is not known, shape (n_models,) [°C]."""
        ranges = [one.model.validity.temperature for one in self.models]
        return np.array([np.nan if limits is None else float(np.mean(limits)) for limits in ranges])


def read_histories(folder: Path) -> tuple[tuple[JointHistory, ...], tuple[str, ...]]:
    """The joints whose models lie anywhere below a folder, and why files were left out.

    Args:
        folder: Of calibrations, identifications and diagnoses; every `friction.json` counts.
    """
    kept: dict[tuple[str, bool, str, str], list[KeptModel]] = {}
    left_out = []
    for path in sorted(folder.rglob("friction.json")):
        try:
            found = read_kept(path)
        except FricompError as error:
            said = str(error)
            left_out.append(said if said.startswith(str(path)) else f"{path}: {error}")
            continue
        model = found.model
        made = model.provenance  # what no fit has written says nothing of itself
        doubt = find_doubt_in_status(made.status, made.message) if made.status else None
        if doubt is not None:
            left_out.append(f"{path}: its identification is not usable ({doubt})")
            continue
        others = kept.setdefault((model.joint, found.effects is not None, model.torque_unit, model.motion), [])
        same = next((one for one in others if _is_copy(found, one)), None)
        if same is None:
            others.append(found)
        else:
            left_out.append(f"{path}: a copy of {same.path}")
    units: dict[tuple[str, bool], int] = Counter(of[:2] for of in kept)
    histories = [_follow(*of[:3], models, units[of[:2]] > 1) for of, models in sorted(kept.items())]
    return tuple(histories), tuple(left_out)


def _is_copy(one: KeptModel, other: KeptModel) -> bool:
    """Whether two files hold one identification; both would make a trend look surer than it is."""
    return one.when == other.when and one.model.law.parameters() == other.model.law.parameters()


def _follow(joint: str, diagnosed: bool, unit: str, models: list[KeptModel], is_one_of_several: bool) -> JointHistory:
    """The models of a joint in one unit; those in amperes and those in N·m say nothing of each other."""
    ordered = tuple(sorted(models, key=lambda one: one.when))
    days = np.array([(one.when - ordered[0].when).total_seconds() / _DAY for one in ordered])
    estimates = _list_estimates(ordered)
    shared = [name for name in estimates[0] if all(name in one for one in estimates)]
    trends = [_fit_trend(name, days, [one[name] for one in estimates]) for name in shared]
    compared = [_compare(old, new) for old, new in pairwise(ordered)]
    comparisons = tuple(None if isinstance(one, str) else one for one in compared)
    refusals = tuple(one if isinstance(one, str) else "" for one in compared)
    return JointHistory(
        joint, diagnosed, ordered, tuple(trends), comparisons, refusals, unit if is_one_of_several else ""
    )


def _list_estimates(models: Sequence[KeptModel]) -> list[Mapping[str, Estimate]]:
    """What each model says of the joint, by the form that all laws have in common where these differ in form."""
    own = [one.estimates for one in models]
    form = find_common_form([one.model for one in models])
    try:
        brought = [] if form is None else bring_to_form([one.model for one in models], form)
    except FricompError:  # over no common speed: what all have by name is left
        return own
    return [list_parameters(model) for model in brought] or own


def _fit_trend(name: str, days: FloatArray, known: Sequence[Estimate]) -> Trend:
    values, deviations = np.array([(one.value, one.deviation) for one in known]).T
    unit = known[0].unit
    weights = deviations**-2
    centred = days - np.average(days, weights=weights)
    spread = float(weights @ centred**2)
    if spread == 0.0:  # all of one moment
        return Trend(name, unit, days, values, deviations, 0.0, float("inf"))
    slope = float(weights * centred @ values) / spread
    free = len(days) - 2
    left = values - np.average(values, weights=weights) - slope * centred
    excess = max(float(weights @ left**2) / free, 1.0) if free else np.inf
    quantile = stats.t.ppf(0.5 + _REACH / 2.0, free) if len(days) >= _FEWEST else np.inf
    return Trend(name, unit, days, values, deviations, slope, float(quantile * np.sqrt(excess / spread)))


def _compare(old: KeptModel, new: KeptModel) -> Change | str:
    """What two models say otherwise; why they cannot be compared, where they cannot."""
    if old.effects is not None and new.effects is not None:
        return _compare_diagnoses(old, new)
    try:
        found = compare_models(old.model, new.model, _SIGNIFICANCE)
    except FricompError as error:
        return str(error)
    return Change(found.changed, tuple(one.name for one in found.significant), found.added, found.removed)


def _compare_diagnoses(old: KeptModel, new: KeptModel) -> Change:
    """What two diagnoses of a joint say otherwise: effects, and numbers by their intervals, one by one.

    A record has no correlations, so each number stands for itself, corrected for how many they are.
    """
    names = [name for name in old.estimates if name in new.estimates]
    pairs = [(old.estimates[name], new.estimates[name]) for name in names]
    z = [(after.value - before.value) / np.hypot(before.deviation, after.deviation) for before, after in pairs]
    chances = correct_for_number(2.0 * stats.norm.sf(np.abs(np.asarray(z, dtype=np.float64))))
    moved = tuple(name for name, p in zip(names, chances, strict=True) if p < _SIGNIFICANCE)
    before, after = set(old.effects or ()), set(new.effects or ())
    added, removed = tuple(sorted(after - before)), tuple(sorted(before - after))
    return Change(bool(moved or added or removed), moved, added, removed)


def shorten(name: str) -> str:
    """A dotted name without what all of its kind begin with."""
    return name.removeprefix("stribeck.").removeprefix("base.")


def draw_history(history: JointHistory, *, over_temperature: bool = False) -> Chart:
    """Each parameter with its 95 % interval, over the days since the first model or over the temperature.

    Args:
        history: Of one joint.
        over_temperature: Of the models whose temperature is known, over that.
    """
    panels = []
    for trend in history.trends:
        x = history.temperatures if over_temperature else trend.days
        there = np.isfinite(x)
        mark = Points(x[there], trend.values[there], error=1.96 * trend.deviations[there])
        label = f"{shorten(trend.name).replace('_', ' ')} [{trend.unit}]"
        panels.append(Panel((mark,), "temperature [°C]" if over_temperature else "time since the first [d]", label))
    kind = "temperature" if over_temperature else "time"
    return Chart(
        f"{kind}-{history.title}", f"Joint {history.title} over {kind}", tuple(panels), columns=2,
        caption="Bars are 95 % intervals.",
    )  # fmt: skip

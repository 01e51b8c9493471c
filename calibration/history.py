"""How the friction of joints goes over weeks: models of one joint in order of time, trends, and when it has changed."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy import stats

from fricomp.errors import FricompError, ParameterError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel, load_model
from fricomp.report import Chart, Panel, Points

from .comparison import ModelComparison, compare_models

_DAY = 86_400.0
_FEWEST = 3
"""Models from which on a trend has an interval: two points always lie on a line."""
_REACH = 0.95


@dataclass(frozen=True)
class KeptModel:
    """A model file.

    Attributes:
        path: Where it is.
        model: What it holds.
        when: When it was identified, UTC.
    """

    path: Path
    model: FrictionModel
    when: datetime


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


@dataclass(frozen=True, eq=False)
class JointHistory:
    """The models of one joint.

    Attributes:
        joint: Its name.
        models: In order of time.
        trends: Of every parameter that all models have, with a deviation.
        comparisons: Of each model but the first with the one before; None where they cannot be compared.
    """

    joint: str
    models: tuple[KeptModel, ...]
    trends: tuple[Trend, ...]
    comparisons: tuple[ModelComparison | None, ...]

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
    kept: dict[str, list[KeptModel]] = {}
    left_out = []
    for path in sorted(folder.rglob("friction.json")):
        try:
            model = load_model(path)
            found = KeptModel(path, model, _read_date(model))
        except FricompError as error:
            left_out.append(f"{path}: {error}")
            continue
        others = kept.setdefault(model.joint, [])
        same = next((one for one in others if _is_copy(found, one)), None)
        if same is None:
            others.append(found)
        else:
            left_out.append(f"{path}: a copy of {same.path}")
    return tuple(_follow(joint, models) for joint, models in sorted(kept.items())), tuple(left_out)


def _is_copy(one: KeptModel, other: KeptModel) -> bool:
    """Whether two files hold one identification; both would make a trend look surer than it is."""
    return one.when == other.when and one.model.law.parameters() == other.model.law.parameters()


def _read_date(model: FrictionModel) -> datetime:
    """When a model was made, UTC.

    Raises:
        ParameterError: It does not say, or not as a date.
    """
    said = model.provenance.created
    try:
        when = datetime.fromisoformat(said)
        return (when if when.tzinfo is not None else when.replace(tzinfo=UTC)).astimezone(UTC)
    except (ValueError, OverflowError) as error:
        told = f"{said!r}, which is not a date" if said else "nothing"
        raise ParameterError(
            f"when it was made is not known: its provenance.created says {told}; write one such as 2026-03-01T12:00"
        ) from error


def _follow(joint: str, models: list[KeptModel]) -> JointHistory:
    ordered = tuple(sorted(models, key=lambda one: one.when))
    days = np.array([(one.when - ordered[0].when).total_seconds() / _DAY for one in ordered])
    known = [_read_parameters(one.model) for one in ordered]
    shared = [name for name in known[0] if all(name in one for one in known)]
    trends = [_fit_trend(name, ordered[0].model.units()[name], days, known) for name in shared]
    comparisons = tuple(_compare(old.model, new.model) for old, new in pairwise(ordered))
    return JointHistory(joint, ordered, tuple(trends), comparisons)


def _read_parameters(model: FrictionModel) -> dict[str, tuple[float, float]]:
    """Value and standard deviation of the parameters that have one."""
    if model.covariance is None:
        return {}
    values, deviations = model.law.parameters(), np.sqrt(np.diag(model.covariance.matrix))
    pairs = zip(model.covariance.names, deviations.tolist(), strict=True)
    return {name: (values[name], sd) for name, sd in pairs if name in values and 0.0 < sd < np.inf}


def _fit_trend(name: str, unit: str, days: FloatArray, known: list[dict[str, tuple[float, float]]]) -> Trend:
    values, deviations = np.array([one[name] for one in known]).T
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


def _compare(old: FrictionModel, new: FrictionModel) -> ModelComparison | None:
    try:
        return compare_models(old, new)
    except FricompError:
        return None


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
        label = f"{trend.name.partition('.')[2].replace('_', ' ')} [{trend.unit}]"
        panels.append(Panel((mark,), "temperature [°C]" if over_temperature else "time since the first [d]", label))
    kind = "temperature" if over_temperature else "time"
    return Chart(
        f"{kind}-{history.joint}", f"Joint {history.joint} over {kind}", tuple(panels), columns=2,
        caption="Bars are 95 % intervals.",
    )  # fmt: skip

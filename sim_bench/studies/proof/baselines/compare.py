"""All baselines on the same cases: what they name, and how much of the gap they close on held-out blocks."""

import json
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
import numpy as np

from fricomp.errors import DiagnosisError

from ....cases import CaseSpec, generate, write_answer, write_case
from ...kit.case import run_cases
from ...kit.page import fill_template
from ...kit.rigid_joint import Samples
from ...kit.statistics import compute_share, format_quartiles
from ...kit.store import Row, RowStore
from ..making import name_case
from ..plan import NULLS, PlannedCase
from ..score import Score
from .data import fit_columns, load_data
from .methods import METHODS, fit_base

_VISIBLE = 0.5
"""Effect-to-noise ratio from which single effects count."""

_GAP = 1.1
"""Held-out error of the refitted joint, over that with the true torque, from which a gap can be closed."""

_STORE = "baselines.jsonl"


@dataclass(frozen=True)
class BaselineScore:
    """One method on one case.

    Attributes:
        method: Key of `METHODS`.
        case: Name of the case.
        group: Of the plan.
        enr: Effect-to-noise ratio.
        names: What it named, strongest first.
        top_right: The strongest name is a concealed effect, or was accepted for it.
        false_alarm: It named something where nothing is missing.
        error: Held-out error over that of a refit with the true concealed torque; 1 is the best there is.
        before: The same of the refitted rigid joint alone.
    """

    method: str
    case: str
    group: str
    enr: float
    names: tuple[str, ...]
    top_right: bool
    false_alarm: bool
    error: float
    before: float

    @property
    def gap_closed(self) -> float:
        """Share of the squared held-out error above that of the true torque that the method removes.

        NaN where the refitted joint alone leaves hardly more than the true torque does.
        """
        return (self.before**2 - self.error**2) / (self.before**2 - 1.0) if self.before > _GAP else float("nan")


def compare_baselines(
    planned: Sequence[PlannedCase],
    folder: Path,
    executor: tuple[Executor, int],
    progress: Callable[[], None] = lambda: None,
) -> list[BaselineScore]:
    """Every method on every case that can be made.

    Args:
        planned: The cases; those of real recordings have no noise-free truth and are left out.
        folder: Keeps what is finished, so that a comparison that was stopped goes on.
        executor: With the number of its workers.
        progress: Called after each case.
    """
    cases = {name_case(each.spec): (each,) for each in planned if isinstance(each.spec, CaseSpec)}
    for _ in range(len(planned) - len(cases)):
        progress()
    rows = run_cases(cases, _compare_case, RowStore(folder / _STORE), executor, progress=progress)
    return [msgspec.convert(score, BaselineScore) for row in rows for score in row["scores"]]


def _compare_case(planned: PlannedCase) -> Row:
    return {"scores": [asdict(score) for score in _score_case(planned)]}


def _score_case(planned: PlannedCase) -> list[BaselineScore]:
    from pyarrow import parquet

    assert isinstance(planned.spec, CaseSpec)
    try:
        case = generate(planned.spec)
    except DiagnosisError:
        return []
    with TemporaryDirectory() as place:
        folder = write_case(case, Path(place) / "cases")
        answer, _ = write_answer(case, Path(place) / "answers", "baseline")
        truth = json.loads(answer.read_text(encoding="utf-8"))
        data = load_data(folder)
        concealed = parquet.read_table(answer.with_suffix(".parquet")).column("concealed_torque").to_numpy()
        before = fit_base(data).error
        floor = fit_columns(data, np.hstack([data.base, _smooth(concealed)[data.kept, None]]))
        right = {name for each in truth["effects"] for name in (each["name"], *each["accepted"])}
        scores = []
        for method, fit in METHODS.items():
            found = fit(data)
            scores.append(
                BaselineScore(
                    method=method,
                    case=truth["id"],
                    group=planned.group,
                    enr=truth["enr"],
                    names=found.names,
                    top_right=bool(found.names) and found.names[0] in right,
                    false_alarm=not truth["effects"] and bool(found.names),
                    error=found.error / floor,
                    before=before / floor,
                )
            )
        return scores


def _smooth(torque: Samples) -> Samples:
    from scipy.signal import savgol_filter

    return np.asarray(savgol_filter(torque, 21, 3))


def format_table(baselines: Sequence[BaselineScore], scores: Sequence[Score], measured: str) -> str:
    """The comparison as Markdown; where `scores` has some of the cases, on these alone, with the diagnosis first.

    Args:
        baselines: Of the other methods.
        scores: Of the diagnosis.
        measured: When, and at which commit.
    """
    cases = {score.case for score in baselines}
    own = [score for score in scores if score.case in cases]
    if own:
        cases &= {score.case for score in own}
    shared = [score for score in baselines if score.case in cases]
    rows = [_list_own(own)] if own else []
    rows += [_list_base(shared)]
    rows += [_list_method(method, [score for score in shared if score.method == method]) for method in METHODS]
    return fill_template("proof/baselines.md", measured=measured, count=len(cases), open=f"{_GAP:g}", rows=rows)


def _list_method(method: str, scores: Sequence[BaselineScore]) -> list[str]:
    single, nothing = _select_single(scores), [s for s in scores if s.group in NULLS]
    names = compute_share(sum(s.top_right for s in single), len(single))
    alarms = compute_share(sum(s.false_alarm for s in nothing), len(nothing))
    told = [str(names), str(alarms)] if any(s.names for s in scores) else ["–", "–"]
    errors = format_quartiles([s.error for s in single])
    return [method, *told, errors, format_quartiles([s.gap_closed for s in single])]


def _list_own(scores: Sequence[Score]) -> list[str]:
    single = [s for s in scores if s.group == "single" and s.enr >= _VISIBLE]
    nothing = [s for s in scores if s.group in NULLS]
    names = compute_share(sum(s.top_right for s in single), len(single))
    alarms = compute_share(sum(s.false_names > 0 for s in nothing), len(nothing))
    return ["**fricomp diagnose**", str(names), str(alarms), "–", "–"]


def _list_base(baselines: Sequence[BaselineScore]) -> list[str]:
    first = [s for s in _select_single(baselines) if s.method == next(iter(METHODS))]
    return ["rigid joint refitted", "–", "–", format_quartiles([s.before for s in first]), "0"]


def _select_single(scores: Sequence[BaselineScore]) -> list[BaselineScore]:
    return [s for s in scores if s.group == "single" and s.enr >= _VISIBLE]

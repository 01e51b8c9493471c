"""How much of the held-out gap the diagnosis closes, of what the right structure could: measured by a second diagnosis.

The first sees the recording, the second the same recording without its concealed torque, which the generator knows.
What a refit of the believed joint leaves there is what the right structure could reach, whatever the first one says:

    closed = (before² - after²) / (before² - reachable²)
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from itertools import count, islice
from pathlib import Path
from tempfile import TemporaryDirectory

import msgspec
import numpy as np
from numpy.typing import NDArray

from fricomp.diagnosis import HeldOut
from fricomp.errors import DiagnosisError

from ...cases import CATALOGUE, CaseSpec, generate, write_answer, write_case
from ..kit.blind import BlindAnswer, Diagnose, diagnose_blind
from ..kit.case import run_cases
from ..kit.page import fill_template
from ..kit.score import read_diagnosis
from ..kit.statistics import compute_median
from ..kit.store import Row, RowStore
from .making import name_case
from .plan import PlannedCase, plan_cases
from .score import Score, score_case

_STORE = "gap.jsonl"

GAP = "gap.md"
"""File beside a page that holds the table of the gaps closed."""

_VISIBLE = 0.5
"""Wanted strength from which a case is taken: weaker effects leave hardly a gap."""

_OPEN = 1.1
"""Error of the refitted joint over the reachable one from which there is a gap to close."""

_ON_THE_JOINT = ("torque", "torque_command")
"""Channels that hold the concealed torque [N·m]."""


class GapScore(msgspec.Struct, frozen=True):
    """Held-out errors of one case.

    Attributes:
        case: Its name.
        truth: The concealed effect.
        named: What was named, strongest first, joined by a plus sign.
        top_right: The strongest name is the concealed effect, or was accepted for it.
        before: Of the refitted joint without the effect [N·m]; None where a diagnosis gave no held-out error.
        after: With what was named [N·m]; None likewise.
        reachable: Of the refitted joint on the recording without the concealed torque [N·m]; None likewise.
        floor: What the first diagnosis takes for noise [N·m]; None likewise.
    """

    case: str
    truth: str
    named: str
    top_right: bool
    before: float | None
    after: float | None
    reachable: float | None
    floor: float | None

    @property
    def closed(self) -> float:
        """Share of the gap that is closed; NaN where there is hardly one, or an error is not known."""
        if self.before is None or self.after is None or self.reachable is None:
            return float("nan")
        if self.before <= _OPEN * self.reachable:
            return float("nan")
        return (self.before**2 - self.after**2) / (self.before**2 - self.reachable**2)


def plan_gaps(number: int, seeds: Iterator[int], duration: float | None) -> list[PlannedCase]:
    """The first single effects of a plan that are a torque on the joint, of a strength that can be seen.

    Args:
        number: How many.
        seeds: One is taken for each case of the plan, used or not.
        duration: Of every recording [s]; by default as in a proof.
    """
    return list(islice(filter(_has_gap, _plan(seeds, duration)), number))


def _plan(seeds: Iterator[int], duration: float | None) -> Iterator[PlannedCase]:
    """Single effects without end: a plan is as long as it is asked for, so each time a longer one is made."""
    drawn: list[int] = []
    for size in count(50, 50):
        drawn += islice(seeds, 50)
        yield from plan_cases(size, iter(drawn), duration, ("single",))[-50:]


def _has_gap(planned: PlannedCase) -> bool:
    assert isinstance(planned.spec, CaseSpec)
    strength = planned.spec.strength
    visible = strength == "clear" or float(strength) >= _VISIBLE
    return visible and all(CATALOGUE[name].kind == "physics" for name in planned.spec.effects)


def measure_gaps(
    planned: Sequence[PlannedCase],
    folder: Path,
    executor: tuple[Executor, int],
    *,
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[], None] = lambda: None,
) -> list[GapScore]:
    """Diagnose every case that can be made twice: as it was recorded, and without its concealed torque.

    Args:
        planned: Of `plan_gaps`.
        folder: Keeps what is finished, so that a measurement that was stopped goes on.
        executor: With the number of its workers.
        diagnose: What runs for the files of a case.
        progress: Called after each case.
    """
    cases = {name_case(each.spec): (each, diagnose) for each in planned}
    rows = run_cases(cases, _measure, RowStore(folder / _STORE), executor, progress=progress)
    return [msgspec.convert(row["gap"], GapScore) for row in rows if "gap" in row]


def _measure(planned: PlannedCase, diagnose: Diagnose) -> Row:
    """A row with the errors; without them where the case could not be made."""
    assert isinstance(planned.spec, CaseSpec)
    try:
        case = generate(planned.spec)
    except DiagnosisError:
        return {}
    with TemporaryDirectory() as place:
        folder = write_case(case, Path(place) / "cases")
        answer = write_answer(case, Path(place) / "answers", "gap")[0].read_bytes()
        files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
        _take_away(case.outcome.torque, case.scene.joint.gear_ratio, folder / "recording.parquet")
        without = files | {"recording.parquet": (folder / "recording.parquet").read_bytes()}
    first, second = diagnose(files), diagnose(without)
    return {"gap": msgspec.to_builtins(_compare(score_case(planned, answer, first), first, second))}


def _take_away(torque: NDArray[np.float64], gear_ratio: float, recording: Path) -> None:
    """Rewrite a recording as a drive without the concealed torque would have written it on the same motion.

    The command and the current go with the torque: else the drive would seem to follow its command badly.
    """
    from pyarrow import parquet

    table = parquet.read_table(recording)
    scales = dict.fromkeys(_ON_THE_JOINT, 1.0) | {"current": 0.1 * gear_ratio}
    for name, scale in scales.items():
        index = table.schema.get_field_index(name)
        table = table.set_column(index, name, [table.column(index).to_numpy() - torque / scale])
    parquet.write_table(table, recording)


def _compare(score: Score, first: BlindAnswer, second: BlindAnswer) -> GapScore:
    found, bare = (_read_held_out(each) for each in (first, second))
    return GapScore(
        case=score.case,
        truth=score.truth,
        named=score.named,
        top_right=score.top_right,
        before=found.rmse_refitted if found else None,
        after=found.rmse_after if found else None,
        reachable=bare.rmse_refitted if bare else None,
        floor=found.noise_floor if found else None,
    )


def _read_held_out(answer: BlindAnswer) -> HeldOut | None:
    """Held-out errors of a diagnosis; None where it gave none."""
    return msgspec.convert(read_diagnosis(answer.diagnosis).get("heldout"), HeldOut | None)


def format_gaps(scores: Sequence[GapScore], reproduce: str, measured: str) -> str:
    """A section of the page: the share closed over all cases and over those named right, and each case.

    Args:
        scores: Of the cases that could be made.
        reproduce: Command that measures them again.
        measured: When, and at which commit.
    """
    known = [score for score in scores if np.isfinite(score.closed)]
    right = [score for score in known if score.top_right]
    return fill_template(
        "proof/gap.md",
        reproduce=reproduce,
        measured=measured,
        visible=f"{_VISIBLE:g}",
        open=f"{_OPEN:g}",
        count=len(scores),
        closed_gaps=len(scores) - len(known),
        shares=[_summarise("right name first", "≥ 0.95", right), _summarise("all", "–", known)],
        cases=[_list_errors(score) for score in sorted(known, key=lambda s: -s.closed)],
    )


def _summarise(name: str, target: str, scores: Sequence[GapScore]) -> list[object]:
    closed = compute_median([score.closed for score in scores])
    return [name, target, closed, compute_median([_close_to_own_floor(score) for score in scores])]


def _close_to_own_floor(score: GapScore) -> float:
    """What the share would be if the first diagnosis were believed about the floor too."""
    before, after, floor = (np.float64(value) ** 2 for value in (score.before, score.after, score.floor))
    return float((before - after) / (before - floor)) if before > floor else float("nan")


def _list_errors(score: GapScore) -> list[str]:
    errors = [f"{value:.4g}" for value in (score.before, score.after, score.reachable)]
    return [score.truth, score.named or "–", *errors, f"{score.closed:.2f}"]

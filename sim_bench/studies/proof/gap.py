"""How much of the held-out gap the diagnosis closes, of what the right structure could: measured by a second diagnosis.

The first sees the recording, the second the same recording without its concealed torque, which the generator knows.
What a refit of the believed joint leaves there is what the right structure could reach, whatever the first one says:

    closed = (before² - after²) / (before² - reachable²)
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor
from itertools import count, islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import msgspec
import numpy as np

from fricomp.diagnosis import HeldOut
from fricomp.errors import DiagnosisError
from fricomp.fleet import stream
from fricomp.whole_file import whole_file

from ...cases import CATALOGUE, CaseSpec, generate, write_answer, write_case
from ..diagnosis_version import diagnosis_version
from .blind import BlindAnswer, diagnose_blind
from .making import name_of
from .plan import PlannedCase, plan_cases
from .run import Diagnose
from .score import Score, read_diagnosis, score_case
from .statistics import compute_median

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["GAP", "GapScore", "format_gaps", "measure_gaps", "plan_gaps"]

GAP = "gap.md"
"""File beside a page that holds the table of the gaps closed."""

_VISIBLE = 0.5  # wanted strength from which a case is taken
_OPEN = 1.1  # error of the refitted joint over the reachable one, from which there is a gap to close
_ON_THE_JOINT = ("torque", "torque_command")  # channels that hold the concealed torque [N·m]


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
        diagnosis: Version of the diagnosis.
    """

    case: str
    truth: str
    named: str
    top_right: bool
    before: float | None
    after: float | None
    reachable: float | None
    floor: float | None
    diagnosis: str = ""

    @property
    def closed(self) -> float:
        """Share of the gap that is closed; NaN where there is hardly one, or an error is not known."""
        if self.before is None or self.after is None or self.reachable is None:
            return float("nan")
        if self.before <= _OPEN * self.reachable:
            return float("nan")
        return (self.before**2 - self.after**2) / (self.before**2 - self.reachable**2)


def plan_gaps(number: int, seeds: Iterator[int], duration: float | None = None) -> list[PlannedCase]:
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
        folder: Keeps one file a case, so that a measurement of the same diagnosis that was stopped goes on.
        executor: With the number of its workers.
        diagnose: What runs for the files of a case.
        progress: Called after each case.
    """
    folder.mkdir(parents=True, exist_ok=True)
    paths = {name_of(each.spec): folder / f"{name_of(each.spec)}.json" for each in planned}
    done = {name for name, path in paths.items() if path.exists() and _read(path).diagnosis == diagnosis_version()}
    todo = [(paths[name_of(each.spec)], (each, diagnose)) for each in planned if name_of(each.spec) not in done]
    for _ in range(len(planned) - len(todo)):
        progress()
    for path, future in stream(todo, _measure, executor):
        if (score := future.result()) is not None:
            with whole_file(path, DiagnosisError) as part:
                part.write_bytes(msgspec.json.encode(msgspec.structs.replace(score, diagnosis=diagnosis_version())))
        progress()
    return [_read(path) for path in paths.values() if path.exists()]


def _read(path: Path) -> GapScore:
    return msgspec.json.decode(path.read_bytes(), type=GapScore)


def _measure(planned: PlannedCase, diagnose: Diagnose) -> GapScore | None:
    """None where the case could not be made."""
    assert isinstance(planned.spec, CaseSpec)
    try:
        case = generate(planned.spec)
    except DiagnosisError:
        return None
    with TemporaryDirectory() as place:
        folder = write_case(case, Path(place) / "cases")
        answer = write_answer(case, Path(place) / "answers", "gap")[0].read_bytes()
        files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
        _take_away(case.outcome.torque, case.scene.joint.gear_ratio, folder / "recording.parquet")
        without = files | {"recording.parquet": (folder / "recording.parquet").read_bytes()}
    first, second = diagnose(files), diagnose(without)
    return _compare(score_case(planned, answer, first), first, second)


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
    found, bare = (_held_out(each) for each in (first, second))
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


def _held_out(answer: BlindAnswer) -> HeldOut | None:
    """Held-out errors of a diagnosis; None where it gave none."""
    return msgspec.convert(read_diagnosis(answer.diagnosis).get("heldout"), HeldOut | None)


def format_gaps(scores: Sequence[GapScore], reproduce: str, measured: str) -> str:
    """A section of the page: the share closed over all cases and over those named right, and each case.

    Args:
        scores: Of the cases that could be made.
        reproduce: Command that measures them again.
        measured: When, and of which diagnosis.
    """
    known = [score for score in scores if np.isfinite(score.closed)]
    right = [score for score in known if score.top_right]
    lines = [
        "## Held-out gap closed, of what the right structure could close",
        "",
        f"    {reproduce}",
        "",
        f"{measured} "
        "Each case is diagnosed twice: as it was recorded, and with the concealed torque taken away from torque, "
        "command and current. What the refitted joint leaves there could be reached, whatever the first diagnosis says."
        " Closed is (before² - after²) / (before² - reachable²), on held-out blocks. Single effects on the joint, ENR "
        f"{_VISIBLE:g} or more, development seeds, {len(scores)} cases; "
        f"{len(scores) - len(known)} of them have no gap (before is not above {_OPEN:g} times what could be reached) "
        "or no held-out error. Either diagnosis weighs rows by its own estimate of their noise.",
        "",
        "| cases | target | closed (95 % interval) | from the diagnosis' own floor |",
        "|---|---|---|---|",
        _row("right name first", "≥ 0.95", right),
        _row("all", "–", known),
        "",
        "| concealed | named | before [N·m] | after [N·m] | reachable [N·m] | closed |",
        "|---|---|---|---|---|---|",
        *(_case_row(score) for score in sorted(known, key=lambda s: -s.closed)),
    ]
    return "\n".join(lines)


def _row(name: str, target: str, scores: Sequence[GapScore]) -> str:
    closed, of_own = ([share(score) for score in scores] for share in (lambda s: s.closed, _closed_of_own))
    return f"| {name} | {target} | {compute_median(closed)} | {compute_median(of_own)} |"


def _closed_of_own(score: GapScore) -> float:
    """What the share would be if the first diagnosis were believed about the floor too."""
    before, after, floor = (np.float64(value) ** 2 for value in (score.before, score.after, score.floor))
    return float((before - after) / (before - floor)) if before > floor else float("nan")


def _case_row(score: GapScore) -> str:
    errors = " | ".join(f"{value:.4g}" for value in (score.before, score.after, score.reachable))
    return f"| {score.truth} | {score.named or '–'} | {errors} | {score.closed:.2f} |"

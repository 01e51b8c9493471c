"""Running a proof: cases are made, sealed, diagnosed blind, opened and scored, as many at a time as there are workers.

Each score is a line of `scores.jsonl` at once, so that a run which is stopped goes on where it was. Answers and
diagnoses are kept beside it, and `refused.jsonl` lists the cases that could not be made.
"""

import hashlib
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from fricomp.errors import DiagnosisError
from fricomp.fleet import always
from fricomp.whole_file import write_whole

from ..kit.blind import BlindAnswer, Diagnose, diagnose_blind
from ..kit.store import RowStore
from .making import Prepared, name_case, prepare, prepare_follow_up, write_command
from .plan import PlannedCase
from .score import Score, asks_for_more, read_score, score_again, score_case
from .seal import SealBook

SCORES, REFUSED, SEALS = "scores.jsonl", "refused.jsonl", "seals.jsonl"
"""Files of a run: scores, cases that could not be made, and hashes of answers."""

ANSWERS, DIAGNOSES, FOLLOW_UPS = "answers", "diagnoses", "follow_ups"
"""Folders of a run: opened answers, what was said, and what was said once the proposed motion was recorded too."""

_NO_ANSWER = BlindAnswer(b"", b"", 0.0, "no answer")


@dataclass(frozen=True)
class _Pending:
    """A case under way.

    Attributes:
        planned: The case.
        files: What the diagnosis may read, once it is made.
        first: The first answer, once the motion that it proposes is being recorded.
        making: Whether a recording is being made; otherwise one is being diagnosed.
    """

    planned: PlannedCase
    files: dict[str, bytes] = field(default_factory=dict)
    first: BlindAnswer | None = None
    making: bool = True


class _Run:
    """State of one proof in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in (ANSWERS, DIAGNOSES, FOLLOW_UPS):
            (folder / name).mkdir(parents=True, exist_ok=True)
        self.seals = SealBook(folder / SEALS)
        self.scores, self.refused = RowStore(folder / SCORES), RowStore(folder / REFUSED)

    def list_finished(self) -> set[str]:
        return {*self.scores.index_by_case(), *self.refused.index_by_case()}

    def refuse(self, planned: PlannedCase, reason: str) -> None:
        known = {"case": name_case(planned.spec), "group": planned.group, "command": write_command(planned.spec)}
        self.refused.append(known | {"reason": reason})

    def seal(self, prepared: Prepared) -> None:
        self.seals.seal(prepared.case, prepared.answer)
        write_whole(self.folder / ANSWERS / f"{prepared.case}.json", prepared.answer)

    def score(self, planned: PlannedCase, blind: BlindAnswer, follow_up: BlindAnswer | None) -> Score:
        name = name_case(planned.spec)
        write_whole(self.folder / DIAGNOSES / f"{name}.json", blind.diagnosis)
        if follow_up is not None:
            write_whole(self.folder / FOLLOW_UPS / f"{name}.json", follow_up.diagnosis)
        answer = (self.folder / ANSWERS / f"{name}.json").read_bytes()
        self.seals.open(name, answer)
        score = score_case(planned, answer, blind, follow_up)
        self.scores.append(asdict(score))
        return score


def run_proof(
    planned: Sequence[PlannedCase],
    folder: Path,
    executor: tuple[Executor, int],
    *,
    salt: str,
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[Score | None], None] = lambda score: None,
    go_on: Callable[[], bool] = always,
) -> list[Score]:
    """Score all cases that the folder does not hold yet, in the order planned.

    Args:
        planned: The cases.
        folder: Where everything is kept.
        executor: With the number of its workers, as `open_executor` gives it.
        salt: Secret of the run.
        diagnose: What runs on a worker for the files of a case.
        progress: Called after each case; with None for one that could not be made.
        go_on: Asked before each case; once it says no, those under way are finished and the rest is left.

    Returns:
        The scores of the planned cases, those of earlier runs in the folder included.
    """
    run = _Run(folder)
    finished = run.list_finished()
    todo = iter([each for each in planned if name_case(each.spec) not in finished])
    pool, workers = executor
    waiting: dict[Future[Any], _Pending] = {}

    def submit(pending: _Pending, call: Callable[..., Any], *arguments: Any) -> None:
        waiting[pool.submit(call, *arguments)] = pending

    while True:
        while len(waiting) < 2 * workers and go_on() and (each := next(todo, None)) is not None:
            submit(_Pending(each), prepare, each.spec, derive_salt(salt, name_case(each.spec)))
        if not waiting:
            break
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            pending = waiting.pop(future)
            result = _get_result(future, pending)
            if isinstance(result, Prepared) and not (result.refused and pending.first):
                _take_prepared(run, pending, result, submit, diagnose, progress)
            elif isinstance(result, Prepared):
                progress(run.score(pending.planned, pending.first or _NO_ANSWER, None))
            elif pending.first is None and asks_for_more(result):
                first = replace(pending, first=result, making=True)
                submit(first, prepare_follow_up, pending.planned.spec, result.motion)
            else:
                progress(_finish(run, pending, result))
    names = {name_case(each.spec) for each in planned}
    return [score for score in read_scores(folder) if score.case in names]


def derive_salt(salt: str, case: str) -> str:
    """The salt of one answer, not to be guessed without the run's own."""
    return hashlib.sha256(f"{salt}:{case}".encode()).hexdigest()[:32]


def _get_result(future: Future[Any], pending: _Pending) -> BlindAnswer | Prepared:
    """What a worker gave; what failed in an unforeseen way counts against its own case, so that the others go on.

    A case that could not be made is refused; one whose worker was lost while it diagnosed has no answer.
    """
    try:
        result: BlindAnswer | Prepared = future.result()
    except (BrokenExecutor, AssertionError, DiagnosisError, ImportError):  # an installation that makes no case
        raise
    except Exception as error:  # of a generator or of the cluster
        reason = f"{type(error).__name__}: {error}"
        return Prepared("", {}, b"", refused=reason) if pending.making else BlindAnswer(b"", b"", 0.0, reason)
    return result


def _take_prepared(
    run: _Run,
    pending: _Pending,
    prepared: Prepared,
    submit: Callable[..., None],
    diagnose: Diagnose,
    progress: Callable[[Score | None], None],
) -> None:
    """Seal a case and have it diagnosed, or diagnose it again with the recording of the proposed motion."""
    if prepared.refused:
        run.refuse(pending.planned, prepared.refused)
        progress(None)
    else:
        if pending.first is None:
            run.seal(prepared)
        files = pending.files | prepared.files
        submit(replace(pending, files=files, making=False), diagnose, files)


def _finish(run: _Run, pending: _Pending, result: BlindAnswer) -> Score:
    if pending.first is None:
        return run.score(pending.planned, result, None)
    return run.score(pending.planned, pending.first, result)


def count_open(planned: Sequence[PlannedCase], folder: Path) -> int:
    """How many of the planned cases the folder neither has a score of nor knows as refused."""
    finished = RowStore(folder / SCORES).index_by_case().keys() | read_refused(folder).keys()
    return sum(name_case(each.spec) not in finished for each in planned)


def read_refused(folder: Path) -> dict[str, str]:
    """Cases of a run that could not be made, each with the reason."""
    return {name: row["reason"] for name, row in RowStore(folder / REFUSED).index_by_case().items()}


def read_scores(folder: Path) -> list[Score]:
    """All scores in the folder of a run, by name of the case.

    Where answer and diagnosis of a case are there, it is scored again by the rules of today.

    Raises:
        DiagnosisError: There is none.
    """
    rows = RowStore(folder / SCORES).index_by_case()
    if not rows:
        raise DiagnosisError(f"no scores in {folder}: run 'fricomp bench mismatch run --out {folder}' first")
    return [_score_again(folder, rows[case]) for case in sorted(rows)]


def _score_again(folder: Path, row: dict[str, Any]) -> Score:
    paths = [folder / name / f"{row['case']}.json" for name in (ANSWERS, DIAGNOSES, FOLLOW_UPS)]
    answer, diagnosis, follow_up = (path.read_bytes() if path.exists() else None for path in paths)
    if answer is None or diagnosis is None:
        return read_score(row)
    return score_again(row, answer, diagnosis, follow_up or b"")

"""Running a proof: cases are made, sealed, diagnosed blind, opened and scored, as many at a time as there are workers.

Each score becomes a Parquet file of its own in `scores/` at once, so that a run which is stopped goes on where it
was; answers and diagnoses are kept beside it, and `refused.jsonl` lists the cases that could not be made.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, wait
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from fricomp.errors import DiagnosisError
from fricomp.fleet import always
from fricomp.whole_file import whole_file

from .blind import BlindAnswer, Prepared, diagnose_blind, prepare, prepare_follow_up
from .making import command_of, name_of
from .plan import PlannedCase
from .score import Score, asks_for_more, score_again, score_case
from .seal import SealBook

__all__ = [
    "ANSWERS",
    "DIAGNOSES",
    "FOLLOW_UPS",
    "REFUSED",
    "SEALS",
    "Diagnose",
    "count_open",
    "read_opened",
    "read_refused",
    "read_scores",
    "run_proof",
    "salt_of",
]

Diagnose = Callable[[dict[str, bytes]], BlindAnswer]

REFUSED, SEALS = "refused.jsonl", "seals.jsonl"
"""Files of a run: cases that could not be made, and hashes of answers."""

ANSWERS, DIAGNOSES, FOLLOW_UPS = "answers", "diagnoses", "follow_ups"
"""Folders of a run: opened answers, what was said, and what was said once the proposed motion was recorded too."""

_NO_ANSWER = BlindAnswer(b"", b"", 0.0, "no answer")


@dataclass(frozen=True)
class _Pending:
    """A case under way: its files, its first answer once the proposed motion is being recorded, and whether a recording
    is being made or diagnosed."""

    planned: PlannedCase
    files: dict[str, bytes] = field(default_factory=dict)
    first: BlindAnswer | None = None
    making: bool = True


class _Run:
    """State of one proof in a folder."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        for name in ("scores", ANSWERS, DIAGNOSES, FOLLOW_UPS):
            (folder / name).mkdir(parents=True, exist_ok=True)
        self.seals = SealBook(folder / SEALS)
        self.refused = read_refused(folder)

    def finished(self, planned: PlannedCase) -> bool:
        return self._score_path(planned).exists() or name_of(planned.spec) in self.refused

    def refuse(self, planned: PlannedCase, reason: str) -> None:
        name = name_of(planned.spec)
        self.refused[name] = reason
        entry = {"case": name, "group": planned.group, "reason": reason, "command": command_of(planned.spec)}
        with (self.folder / REFUSED).open("a", encoding="utf-8") as file:
            file.write(json.dumps(entry, ensure_ascii=False) + "\n")

    def seal(self, prepared: Prepared) -> None:
        self.seals.seal(prepared.case, prepared.answer)
        (self.folder / ANSWERS / f"{prepared.case}.json").write_bytes(prepared.answer)

    def score(self, planned: PlannedCase, blind: BlindAnswer, follow_up: BlindAnswer | None) -> Score:
        name = name_of(planned.spec)
        (self.folder / DIAGNOSES / f"{name}.json").write_bytes(blind.diagnosis)
        if follow_up is not None:
            (self.folder / FOLLOW_UPS / f"{name}.json").write_bytes(follow_up.diagnosis)
        answer = (self.folder / ANSWERS / f"{name}.json").read_bytes()
        self.seals.open(name, answer)
        score = score_case(planned, answer, blind, follow_up)
        _write_score(score, self._score_path(planned))
        return score

    def _score_path(self, planned: PlannedCase) -> Path:
        return self.folder / "scores" / f"{name_of(planned.spec)}.parquet"


def run_proof(
    planned: Sequence[PlannedCase],
    folder: Path,
    executor: tuple[Executor, int],
    *,
    salt: str,
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[Score | None], None] = lambda score: None,
    go_on: Callable[[], bool] = always,
    check: Callable[[], None] = lambda: None,
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
        check: Called before each answer counts; raises where it is no longer that of this run.

    Returns:
        The scores of the planned cases, those of earlier runs in the folder included.
    """
    run = _Run(folder)
    todo = iter([each for each in planned if not run.finished(each)])
    pool, workers = executor
    waiting: dict[Future[Any], _Pending] = {}

    def submit(pending: _Pending, call: Callable[..., Any], *arguments: Any) -> None:
        waiting[pool.submit(call, *arguments)] = pending

    while True:
        while len(waiting) < 2 * workers and go_on() and (each := next(todo, None)) is not None:
            submit(_Pending(each), prepare, each.spec, salt_of(salt, name_of(each.spec)))
        if not waiting:
            break
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            pending = waiting.pop(future)
            result = _result_of(future, pending)
            if isinstance(result, Prepared) and not (result.refused and pending.first):
                _take_prepared(run, pending, result, submit, diagnose, progress)
            elif isinstance(result, Prepared):
                check()
                progress(run.score(pending.planned, pending.first or _NO_ANSWER, None))
            elif pending.first is None and asks_for_more(result):
                first = replace(pending, first=result, making=True)
                submit(first, prepare_follow_up, pending.planned.spec, result.motion)
            else:
                check()
                progress(_finish(run, pending, result))
    names = {name_of(each.spec) for each in planned}
    return [score for score in read_scores(folder) if score.case in names]


def salt_of(salt: str, case: str) -> str:
    """The salt of one answer, not to be guessed without the run's own."""
    return hashlib.sha256(f"{salt}:{case}".encode()).hexdigest()[:32]


def _result_of(future: Future[Any], pending: _Pending) -> BlindAnswer | Prepared:
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
    refused = read_refused(folder)
    done = {path.stem for path in (folder / "scores").glob("*.parquet")} | set(refused)
    return sum(name_of(each.spec) not in done for each in planned)


def read_refused(folder: Path) -> dict[str, str]:
    """Cases of a run that could not be made, each with the reason."""
    path = folder / REFUSED
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    return {entry["case"]: entry["reason"] for entry in map(json.loads, lines)}


def _write_score(score: Score, path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    with whole_file(path, DiagnosisError) as part:
        parquet.write_table(pyarrow.Table.from_pylist([asdict(score)]), part)


def read_scores(folder: Path) -> list[Score]:
    """All scores in the folder of a run, by name of the case and by the rules of today.

    Raises:
        DiagnosisError: There is none, or an answer is not kept beside its score, as in runs of earlier versions.
    """
    return sorted(_read(folder), key=lambda score: score.case)


def _read(folder: Path) -> Iterator[Score]:
    from pyarrow import parquet

    paths = sorted((folder / "scores").glob("*.parquet"))
    if not paths:
        raise DiagnosisError(f"no scores in {folder}: run 'fricomp bench mismatch --out {folder}' first")
    for path in paths:
        opened = read_opened(folder, path.stem)
        if not opened:
            raise DiagnosisError(f"{path} was written by another version: start a new folder")
        yield score_again(parquet.read_table(path).to_pylist()[0], *opened)


def read_opened(folder: Path, case: str) -> tuple[bytes, bytes, bytes] | None:
    """Answer, diagnosis and follow-up (empty for none) of a case; None where either of the first two is missing."""
    answer, diagnosis, follow_up = (folder / name / f"{case}.json" for name in (ANSWERS, DIAGNOSES, FOLLOW_UPS))
    if not (answer.exists() and diagnosis.exists()):
        return None
    return answer.read_bytes(), diagnosis.read_bytes(), follow_up.read_bytes() if follow_up.exists() else b""

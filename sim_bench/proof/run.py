"""Running a proof: cases are made, sealed, diagnosed blind, opened and scored, as many at a time as there are workers.

Each score becomes a Parquet file of its own in `scores/` at once, so that a run which is stopped goes on where it
was; answers and diagnoses are kept beside it.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait
from dataclasses import asdict, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

from fricomp.errors import DiagnosisError

from ..concealed import case_id
from .blind import BlindAnswer, Prepared, diagnose_blind, prepare, prepare_follow_up
from .plan import PlannedCase
from .score import Score, read_diagnosis, score_case
from .seal import SealBook

__all__ = ["Diagnose", "read_scores", "run_proof"]

Diagnose = Callable[[dict[str, bytes]], BlindAnswer]

_NO_ANSWER = BlindAnswer(b"", b"", 0.0, "no answer")


@dataclass(frozen=True)
class _Pending:
    """A case under way: its files, and its first answer once the proposed motion is being recorded."""

    planned: PlannedCase
    files: dict[str, bytes] = field(default_factory=dict)
    first: BlindAnswer | None = None


class _Run:
    """State of one proof in a folder."""

    def __init__(self, folder: Path, salt: str) -> None:
        self.folder, self.salt = folder, salt
        for name in ("scores", "answers", "diagnoses"):
            (folder / name).mkdir(parents=True, exist_ok=True)
        self.seals = SealBook(folder / "seals.jsonl")

    def finished(self, planned: PlannedCase) -> bool:
        return self._score_path(planned).exists()

    def salt_of(self, planned: PlannedCase) -> str:
        """The salt of one answer, not to be guessed without the run's own."""
        return hashlib.sha256(f"{self.salt}:{case_id(planned.spec)}".encode()).hexdigest()[:32]

    def seal(self, prepared: Prepared) -> None:
        self.seals.seal(prepared.case, prepared.answer)
        (self.folder / "answers" / f"{prepared.case}.json").write_bytes(prepared.answer)

    def score(self, planned: PlannedCase, blind: BlindAnswer, follow_up: BlindAnswer | None) -> Score:
        name = case_id(planned.spec)
        (self.folder / "diagnoses" / f"{name}.json").write_bytes(blind.diagnosis)
        answer = (self.folder / "answers" / f"{name}.json").read_bytes()
        self.seals.open(name, answer)
        score = score_case(planned, answer, blind, follow_up)
        _write_score(score, self._score_path(planned))
        return score

    def _score_path(self, planned: PlannedCase) -> Path:
        return self.folder / "scores" / f"{case_id(planned.spec)}.parquet"


def run_proof(
    planned: Sequence[PlannedCase],
    folder: Path,
    executor: tuple[Executor, int],
    *,
    salt: str,
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[Score | None], None] = lambda score: None,
) -> list[Score]:
    """Score all cases that the folder does not hold yet.

    Args:
        planned: The cases.
        folder: Where everything is kept.
        executor: With the number of its workers, as `open_executor` gives it.
        salt: Secret of the run.
        diagnose: What runs on a worker for the files of a case.
        progress: Called after each case; with None for one that could not be made.

    Returns:
        The scores of the planned cases, those of earlier runs in the folder included.
    """
    run = _Run(folder, salt)
    todo = iter([each for each in planned if not run.finished(each)])
    pool, workers = executor
    waiting: dict[Future[Any], _Pending] = {}

    def submit(pending: _Pending, call: Callable[..., Any], *arguments: Any) -> None:
        waiting[pool.submit(call, *arguments)] = pending

    while True:
        while len(waiting) < 2 * workers and (each := next(todo, None)) is not None:
            submit(_Pending(each), prepare, each.spec, run.salt_of(each))
        if not waiting:
            break
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            pending, result = waiting.pop(future), future.result()
            if isinstance(result, Prepared):
                _take_prepared(run, pending, result, submit, diagnose, progress)
            elif pending.first is None and _asks_for_more(result):
                first = replace(pending, first=result)
                submit(first, prepare_follow_up, pending.planned.spec, result.motion)
            else:
                progress(_finish(run, pending, result))
    names = {case_id(each.spec) for each in planned}
    return [score for score in read_scores(folder) if score.case in names]


def _take_prepared(
    run: _Run,
    pending: _Pending,
    prepared: Prepared,
    submit: Callable[..., None],
    diagnose: Diagnose,
    progress: Callable[[Score | None], None],
) -> None:
    """Seal a case and have it diagnosed, or diagnose it again with the recording of the proposed motion."""
    if prepared.refused and pending.first is None:
        progress(None)
    elif prepared.refused:
        progress(run.score(pending.planned, pending.first or _NO_ANSWER, None))
    else:
        if pending.first is None:
            run.seal(prepared)
        files = pending.files | prepared.files
        submit(replace(pending, files=files), diagnose, files)


def _asks_for_more(answer: BlindAnswer) -> bool:
    """Whether a diagnosis printed a set and proposed a motion to tell it apart."""
    said = read_diagnosis(answer.diagnosis)
    return bool(answer.motion) and any(each.get("indistinguishable_from") for each in said["effects"])


def _finish(run: _Run, pending: _Pending, result: BlindAnswer) -> Score:
    if pending.first is None:
        return run.score(pending.planned, result, None)
    return run.score(pending.planned, pending.first, result)


def _write_score(score: Score, path: Path) -> None:
    import pyarrow
    from pyarrow import parquet

    temporary = path.with_suffix(".part")
    parquet.write_table(pyarrow.Table.from_pylist([asdict(score)]), temporary)
    temporary.replace(path)


def read_scores(folder: Path) -> list[Score]:
    """All scores in the folder of a run, by name of the case.

    Raises:
        DiagnosisError: There is none, or they are of another version.
    """
    return sorted(_read(folder), key=lambda score: score.case)


def _read(folder: Path) -> Iterator[Score]:
    from pyarrow import parquet

    paths = sorted((folder / "scores").glob("*.parquet"))
    if not paths:
        raise DiagnosisError(f"no scores in {folder}: run 'fricomp bench mismatch --out {folder}' first")
    names = {each.name for each in fields(Score)}
    for path in paths:
        row = parquet.read_table(path).to_pylist()[0]
        if set(row) != names:
            raise DiagnosisError(f"{path} was written by another version: start a new folder")
        yield Score(**row)

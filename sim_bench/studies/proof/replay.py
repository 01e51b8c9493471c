"""Making a scored run again: the same cases from its kept settings, and its answers held against the kept seals."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Executor
from pathlib import Path
from typing import NamedTuple

import msgspec

from fricomp.errors import DiagnosisError
from fricomp.fleet import stream

from .blind import Prepared, prepare
from .kept import find_kept, read_kept_answers
from .making import name_of
from .run import SEALS, read_refused, salt_of
from .same_answer import same_answer
from .seal import SealBook
from .settings import SETTINGS, RunSettings, check_diagnosis, check_generator, plan_run, read_settings, write_settings

__all__ = ["SealCheck", "load_replay", "verify_seals"]


class SealCheck(NamedTuple):
    """Answers made again, beside their seals.

    Attributes:
        agree: Answers with the sealed hash.
        near: Answers with another hash that tell the same as the kept one, which has it: made on another processor.
        differ: Cases whose answer tells something else, or that cannot be made though they are sealed.
        unplanned: Sealed cases that the settings do not lead to.
        unmade: Cases that could not be made, then or now.
        unexpected: Cases that can be made now and could not be then.
    """

    agree: int
    near: int
    differ: tuple[str, ...]
    unplanned: tuple[str, ...]
    unmade: int
    unexpected: tuple[str, ...]

    @property
    def holds(self) -> bool:
        """Whether nothing is other than it was sealed."""
        return not (self.differ or self.unplanned or self.unexpected)


def load_replay(run: int, out: Path, log: Path, repository: Path, cases: int | None = None) -> RunSettings:
    """The settings of a scored run in a folder of its own, which no log knows of; one that is there goes on.

    Args:
        run: Number of the scored run.
        out: Folder of the replay.
        log: Of the scored runs, with the kept data beside it.
        repository: The checkout, whose diagnosis and generator must be those of the run.
        cases: How many; all of the run by default.

    Raises:
        DiagnosisError: The run is not kept, `out` holds another, or the code is not that of the run.
    """
    settings = msgspec.structs.replace(read_settings(find_kept(log.parent, run) / SETTINGS), replayed=True)
    check_diagnosis(settings, repository)
    path = out / SETTINGS
    if path.exists() and read_settings(path) != settings:
        raise DiagnosisError(f"{out} holds another run: give another --out")
    write_settings(settings, path)
    return msgspec.structs.replace(settings, cases=cases or settings.cases)


def verify_seals(
    run: int,
    log: Path,
    executor: tuple[Executor, int],
    repository: Path,
    progress: Callable[[int], None] = lambda total: None,
) -> SealCheck:
    """Make the sealed answers of a scored run again, from tree, number and salt alone, and compare without a diagnosis.

    Args:
        run: Number of the scored run.
        log: Of the scored runs, with the kept data beside it.
        executor: With the number of its workers.
        repository: The checkout, whose generator must be that of the run.
        progress: Called after each case with how many there are.

    Raises:
        DiagnosisError: The run is not kept, or the generator is not that of the run.
    """
    kept = find_kept(log.parent, run)
    settings = read_settings(kept / SETTINGS)
    check_generator(settings, repository)
    book, refused, opened = SealBook(kept / SEALS), read_refused(kept), read_kept_answers(kept)
    settings = msgspec.structs.replace(settings, cases=max(settings.cases, len(book.cases) + len(refused)))
    planned = {name_of(each.spec): each.spec for each in plan_run(settings)}
    todo = [name for name in planned if name in book.cases or name in refused]
    calls = ((name, (planned[name], salt_of(settings.salt, name))) for name in todo)
    found: dict[str, list[str]] = {each: [] for each in ("agree", "near", "differ", "unmade", "unexpected")}
    for name, future in stream(calls, prepare, executor):
        made: Prepared = future.result()
        if name in refused:
            found["unmade" if made.refused else "unexpected"].append(name)
        else:
            found[_compare(book, made, opened.get(name))].append(name)
        progress(len(todo))
    return SealCheck(
        agree=len(found["agree"]),
        near=len(found["near"]),
        differ=tuple(found["differ"]),
        unplanned=tuple(sorted(book.cases - set(planned))),
        unmade=len(found["unmade"]),
        unexpected=tuple(found["unexpected"]),
    )


def _compare(book: SealBook, made: Prepared, kept: bytes | None) -> str:
    """Which of the answers in `SealCheck` this one is; `kept` is the opened one."""
    if made.refused:
        return "differ"
    if book.matches(made.case, made.answer):
        return "agree"
    if kept is not None and book.matches(made.case, kept) and same_answer(kept, made.answer):
        return "near"
    return "differ"

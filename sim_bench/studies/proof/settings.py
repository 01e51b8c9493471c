"""What decides the cases of a run: kept in its folder before anything starts."""

import hashlib
import secrets
import time
from collections.abc import Callable, Iterator, Sequence
from itertools import count
from pathlib import Path

import msgspec

from fricomp.errors import DiagnosisError
from fricomp.whole_file import write_json

from ..kit.commit import find_commit
from .plan import GROUPS, NULLS, PlannedCase, plan_cases, plan_clear_cases

SETTINGS = "run.json"
"""File of a run that holds its settings."""

QUICK_DURATION = 30.0
"""Length of the recordings of a quick run [s]: half the usual one, which leaves most effects visible."""

_SCORED = 1 << 62
"""Set in every seed of a scored run and in no development seed."""

_ORDER_DIGITS = 8
"""Hexadecimal digits of the key that decide the order of the designs."""


class RunSettings(msgspec.Struct, frozen=True):
    """Settings of a run.

    Attributes:
        cases: How many.
        quick: Recordings of 30 s.
        clear: Every effect once, clear.
        scored: The seeds follow from a key that was drawn when the run began.
        first_seed: First development seed, where the run is not scored.
        salt: Secret of the run, by which nobody can guess an answer from its hash.
        injected: Effects in real recordings instead of simulated ones.
        nulls: Only cases in which nothing is missing.
        key: Decides the seeds of a scored run; empty for others.
        order: Number of the order in which designs follow each other.
        commits: Commits at which the run began and went on.
        replayed: The cases are those of another run, made again.
    """

    cases: int
    quick: bool = False
    clear: bool = False
    scored: bool = False
    first_seed: int = 0
    salt: str = ""
    injected: bool = False
    nulls: bool = False
    key: str = ""
    order: int = 0
    commits: tuple[str, ...] = ()
    replayed: bool = False


def load_or_start(out: Path, wanted: RunSettings, *, resume: bool) -> RunSettings:
    """The settings of the run in a folder; those of a new run are written down before anything else.

    A run that is resumed keeps its own settings but for the number of cases. A scored run keeps that too: a number
    chosen in view of the answers would choose the figures.

    Args:
        out: Folder of the run.
        wanted: Settings of a new run.
        resume: Whether a run that is there may go on.

    Raises:
        DiagnosisError: There is a run and it is not to be resumed, or a scored one began with another number of cases.
    """
    path = out / SETTINGS
    if path.exists():
        if not resume:
            raise DiagnosisError(f"{out} holds a run: give --resume to go on with it, or another --out")
        settings = _go_on(read_settings(path), wanted.cases)
    else:
        settings = msgspec.structs.replace(wanted, salt=secrets.token_hex(16), commits=(find_commit(),))
        if wanted.scored:
            key = secrets.token_hex(16)
            settings = msgspec.structs.replace(settings, key=key, order=int(key[:_ORDER_DIGITS], 16))
    write_json(path, settings)
    return settings


def _go_on(found: RunSettings, cases: int) -> RunSettings:
    if found.scored and not found.replayed and cases != found.cases:
        raise DiagnosisError(
            f"this scored run began with {found.cases} cases and keeps to them: give --cases {found.cases}, and "
            "--minutes to stop before"
        )
    commits = tuple(dict.fromkeys((*found.commits, find_commit())))
    return msgspec.structs.replace(found, cases=cases, commits=commits)


def load_replay(kept: Path, out: Path, cases: int | None = None) -> RunSettings:
    """The settings by which the cases of a kept run are made again in a folder of their own.

    Args:
        kept: Folder with the `run.json` of the run, such as `docs/proof`.
        out: Folder of the replay; one that is there goes on.
        cases: How many; all of the run by default.

    Raises:
        DiagnosisError: No run is kept there, or `out` holds another one.
    """
    if not (kept / SETTINGS).exists():
        raise DiagnosisError(
            f"{kept} holds no {SETTINGS}: give the folder beside the page of a run, such as docs/proof"
        )
    settings = msgspec.structs.replace(read_settings(kept / SETTINGS), replayed=True, commits=())
    path = out / SETTINGS
    if path.exists():
        found = read_settings(path)
        if msgspec.structs.replace(found, cases=settings.cases, commits=()) != settings:
            raise DiagnosisError(f"{out} holds another run: give another --out")
        settings = msgspec.structs.replace(settings, commits=found.commits)
    settings = _go_on(settings, cases or settings.cases)
    write_json(path, settings)
    return settings


def read_settings(path: Path) -> RunSettings:
    """The settings in a file."""
    return msgspec.json.decode(path.read_bytes(), type=RunSettings)


def list_development_seeds(first: int = 0) -> Iterator[int]:
    """Seeds first, first + 1, … that the diagnosis may be developed on.

    Raises:
        DiagnosisError: `first` is negative or among the seeds of scored runs.
    """
    if not 0 <= first < _SCORED // 2:
        raise DiagnosisError(f"development seeds start between 0 and {_SCORED // 2}, got {first}")
    return count(first)


def draw_seeds(settings: RunSettings) -> Iterator[int]:
    """The seeds of a run, one a case. Those of a scored run are hashes of its key and the number of the case."""
    if not settings.scored:
        yield from list_development_seeds(settings.first_seed)
    for index in count():
        digest = hashlib.sha256(f"{settings.key}:{index}".encode()).digest()
        yield _SCORED | int.from_bytes(digest[:7], "big")


def plan_run(settings: RunSettings) -> Sequence[PlannedCase]:
    """The cases of a run on simulated joints."""
    if settings.clear:
        return plan_clear_cases(draw_seeds(settings))[: settings.cases]
    groups = NULLS if settings.nulls else tuple(GROUPS)
    duration = QUICK_DURATION if settings.quick else None
    return plan_cases(settings.cases, draw_seeds(settings), duration, groups, settings.order)


def stop_after(minutes: float | None) -> Callable[[], bool]:
    """Tells whether another case may start: until so many minutes from now, or without end for None."""
    end = time.monotonic() + 60.0 * minutes if minutes is not None else float("inf")
    return lambda: time.monotonic() < end

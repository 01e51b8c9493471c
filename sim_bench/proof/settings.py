"""What decides the cases of a run: kept in its folder, and for scored runs in the log before anything starts."""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec

from fricomp.errors import DiagnosisError

from ..diagnosis_version import imported_diagnosis
from .plan import GROUPS, NULLS, PlannedCase, plan_cases, plan_clear_cases
from .run_log import append_entry, next_run
from .seeds import development_seeds, diagnosis_tree, scored_seeds

__all__ = [
    "SETTINGS",
    "RunSettings",
    "check_diagnosis",
    "load_or_start",
    "log_outcome",
    "plan_run",
    "seeds_of",
    "watch",
]

SETTINGS = "run.json"
"""File of a run that holds its settings."""

_QUICK = 30.0  # [s] of a recording


class RunSettings(msgspec.Struct, frozen=True):
    """Settings of a run.

    Attributes:
        cases: How many.
        quick: Recordings of 30 s.
        clear: Every effect once, clear.
        scored: Seeds that follow from the diagnosis.
        first_seed: First development seed.
        salt: Secret of the run.
        injected: Effects in real recordings instead of simulated ones.
        tree: Hash of the diagnosis; empty where it was not committed when a run on development seeds began.
        run: Number of the scored run; 0 for development seeds.
        nulls: Only cases in which nothing is missing.
        order: Of the designs; the number of the run for scored ones, so that what one run missed
            is not what the next one begins with.
    """

    cases: int
    quick: bool = False
    clear: bool = False
    scored: bool = False
    first_seed: int = 0
    salt: str = ""
    injected: bool = False
    tree: str = ""
    run: int = 0
    nulls: bool = False
    order: int = 0


def load_or_start(out: Path, wanted: RunSettings, *, resume: bool, log: Path, repository: Path) -> RunSettings:
    """The settings of the run in a folder; a new run is written down, a scored one in the log too.

    A run that is resumed keeps its own settings, but for the number of cases.

    Args:
        out: Folder of the run.
        wanted: Of a new run, without salt, tree and number.
        resume: Whether a run that is there may go on.
        log: Of the scored runs.
        repository: Whose diagnosis is scored.

    Raises:
        DiagnosisError: There is a run and it is not to be resumed, or the diagnosis of a scored run is not committed or
            not the one that would run.
    """
    path = out / SETTINGS
    if path.exists():
        if not resume:
            raise DiagnosisError(f"{out} holds a run: give --resume to go on with it, or another --out")
        found = msgspec.json.decode(path.read_bytes(), type=RunSettings)
        return msgspec.structs.replace(found, cases=wanted.cases)
    settings = msgspec.structs.replace(wanted, salt=secrets.token_hex(16))
    if not wanted.scored:
        with suppress(DiagnosisError):
            settings = msgspec.structs.replace(settings, tree=_tree_that_runs(repository))
    else:
        run = next_run(log)
        settings = msgspec.structs.replace(settings, tree=_tree_that_runs(repository), run=run, order=run)
        append_entry(log, {"run": settings.run, "tree": settings.tree, "event": "started", "cases": wanted.cases})
    out.mkdir(parents=True, exist_ok=True)
    path.write_bytes(msgspec.json.format(msgspec.json.encode(settings), indent=1) + b"\n")
    return settings


def seeds_of(settings: RunSettings) -> Iterator[int]:
    """The seeds of the run, one a case."""
    return scored_seeds(settings.tree, settings.run) if settings.scored else development_seeds(settings.first_seed)


def plan_run(settings: RunSettings) -> Sequence[PlannedCase]:
    """The cases of a run on simulated joints."""
    if settings.clear:
        return plan_clear_cases(seeds_of(settings))[: settings.cases]
    groups = NULLS if settings.nulls else tuple(GROUPS)
    duration = _QUICK if settings.quick else None
    return plan_cases(settings.cases, seeds_of(settings), duration, groups, settings.order)


def watch(settings: RunSettings, repository: Path, minutes: float | None = None) -> Callable[[], bool]:
    """Whether a run may start another case: its time is not over and its diagnosis, where known, is unchanged.

    Raises:
        DiagnosisError: By the returned function, where the diagnosis is another than the one the run began with.
    """
    end = time.monotonic() + 60.0 * minutes if minutes is not None else float("inf")

    def go_on() -> bool:
        check_diagnosis(settings, repository)
        return time.monotonic() < end

    return go_on


def check_diagnosis(settings: RunSettings, repository: Path) -> None:
    """Nothing, where the diagnosis is the one that the run began with or that one is not known.

    Raises:
        DiagnosisError: It is another one, is not committed, or is not the one that workers import.
    """
    if settings.tree and (now := _tree_that_runs(repository)) != settings.tree:
        raise DiagnosisError(
            f"the run measures the diagnosis {settings.tree[:12]}, and now it is {now[:12]}: "
            "go back to the commit of the run, or start a new one in another --out"
        )


def _tree_that_runs(repository: Path) -> str:
    """Git's tree hash of the diagnosis, which is the one that workers import.

    Raises:
        DiagnosisError: It is not committed, or workers import that of another folder.
    """
    tree, imported = diagnosis_tree(repository), imported_diagnosis()
    if (repository / "sim_bench/diagnosis").resolve() != imported:
        raise DiagnosisError(
            f"the fricomp that runs has its diagnosis in {imported}, not in this checkout: run the command of the "
            "environment that this checkout is installed in"
        )
    return tree


def log_outcome(settings: RunSettings, log: Path, left: int, count: int, figures: Mapping[str, Any]) -> None:
    """Append what came of a scored run so far: `finished`, or `paused` where cases are left."""
    if settings.scored:
        entry = {"run": settings.run, "tree": settings.tree, "event": "paused" if left else "finished", "cases": count}
        append_entry(log, entry | ({"left": left} if left else {}) | {"figures": dict(figures)})

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
from .making import name_of
from .plan import GROUPS, NULLS, PlannedCase, plan_cases, plan_clear_cases
from .run import SEALS
from .run_log import append_entry, next_run
from .seal import SealBook
from .seeds import current_commit, development_seeds, diagnosis_tree, folder_tree, scored_seeds

__all__ = [
    "GENERATOR",
    "QUICK_DURATION",
    "SCORER",
    "SETTINGS",
    "RunSettings",
    "check_diagnosis",
    "check_generator",
    "load_or_start",
    "log_outcome",
    "plan_run",
    "read_settings",
    "require_plan",
    "seeds_of",
    "watch",
    "write_settings",
]

SETTINGS = "run.json"
"""File of a run that holds its settings."""

GENERATOR, SCORER = "sim_bench/cases", "sim_bench/studies/proof"
"""Folders that, with the diagnosis, decide what a scored run measures."""

QUICK_DURATION = 30.0
"""Of the recordings of a quick run [s]."""


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
        generator: Git's tree hash of the generator of a scored run; empty for others and for runs before the 26th.
        scorer: The same of plan and scoring.
        commit: That was checked out when the scored run began.
        replayed: The run is made again: it is no entry of the log.
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
    generator: str = ""
    scorer: str = ""
    commit: str = ""
    replayed: bool = False


def load_or_start(out: Path, wanted: RunSettings, *, resume: bool, log: Path, repository: Path) -> RunSettings:
    """The settings of the run in a folder; a new run is written down, a scored one in the log too.

    A run that is resumed keeps its own settings, but for the number of cases; a scored one keeps that too, as a number
    chosen in view of the answers would choose the figures.

    Args:
        out: Folder of the run.
        wanted: Of a new run, without salt, tree and number.
        resume: Whether a run that is there may go on.
        log: Of the scored runs.
        repository: Whose diagnosis is scored.

    Raises:
        DiagnosisError: There is a run and it is not to be resumed, a scored one was begun with another number of cases,
            or its diagnosis is not committed or not the one that would run, or generator or scoring are not committed.
    """
    path = out / SETTINGS
    if path.exists():
        if not resume:
            raise DiagnosisError(f"{out} holds a run: give --resume to go on with it, or another --out")
        found = read_settings(path)
        if found.scored and wanted.cases != found.cases:
            raise DiagnosisError(
                f"scored run {found.run} was begun with {found.cases} cases, and keeps to them: give "
                f"--cases {found.cases}, and --minutes to stop before"
            )
        return msgspec.structs.replace(found, cases=wanted.cases)
    settings = msgspec.structs.replace(wanted, salt=secrets.token_hex(16))
    if not wanted.scored:
        with suppress(DiagnosisError):
            settings = msgspec.structs.replace(settings, tree=_tree_that_runs(repository))
    else:
        settings = _start_scored(settings, log, repository)
    write_settings(settings, path)
    return settings


def _start_scored(settings: RunSettings, log: Path, repository: Path) -> RunSettings:
    """Number and code of a new scored run, which is in the log from now on."""
    run = next_run(log)
    code = {
        "tree": _tree_that_runs(repository),
        "generator": folder_tree(repository, GENERATOR),
        "scorer": folder_tree(repository, SCORER),
        "commit": current_commit(repository),
    }
    append_entry(log, {"run": run, "tree": code["tree"], "event": "started", "cases": settings.cases} | code)
    return msgspec.structs.replace(settings, run=run, order=run, **code)


def read_settings(path: Path) -> RunSettings:
    """The settings in a file."""
    return msgspec.json.decode(path.read_bytes(), type=RunSettings)


def write_settings(settings: RunSettings, path: Path) -> None:
    """Write the settings to a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(msgspec.json.format(msgspec.json.encode(settings), indent=1) + b"\n")


def seeds_of(settings: RunSettings) -> Iterator[int]:
    """The seeds of the run, one a case."""
    return scored_seeds(settings.tree, settings.run) if settings.scored else development_seeds(settings.first_seed)


def plan_run(settings: RunSettings) -> Sequence[PlannedCase]:
    """The cases of a run on simulated joints."""
    if settings.clear:
        return plan_clear_cases(seeds_of(settings))[: settings.cases]
    groups = NULLS if settings.nulls else tuple(GROUPS)
    duration = QUICK_DURATION if settings.quick else None
    return plan_cases(settings.cases, seeds_of(settings), duration, groups, settings.order)


def require_plan(planned: Sequence[PlannedCase], settings: RunSettings, out: Path) -> None:
    """Nothing, where a scored run in `out` has sealed no case but those that are planned.

    Raises:
        DiagnosisError: It has: the plan is another than that of its beginning.
    """
    if not settings.scored or settings.replayed:
        return
    stray = SealBook(out / SEALS).cases - {name_of(each.spec) for each in planned}
    if stray:
        raise DiagnosisError(
            f"{len(stray)} sealed cases of scored run {settings.run}, {min(stray)} first, are not in the plan of this "
            f"code: check out commit {settings.commit[:12]}"
        )


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
    """Nothing, where diagnosis and generator are those that the run began with or it is not known which they were.

    Raises:
        DiagnosisError: One is another, is not committed, or is not the one that workers import.
    """
    if settings.tree and (now := _tree_that_runs(repository)) != settings.tree:
        raise DiagnosisError(
            f"the run measures the diagnosis {settings.tree[:12]}, and now it is {now[:12]}: "
            "go back to the commit of the run, or start a new one in another --out"
        )
    check_generator(settings, repository)


def check_generator(settings: RunSettings, repository: Path) -> None:
    """Nothing, where the generator is that of a scored run, or it was not written down which that was.

    Raises:
        DiagnosisError: It is another, or not committed.
    """
    if settings.generator and (now := folder_tree(repository, GENERATOR)) != settings.generator:
        raise DiagnosisError(
            f"scored run {settings.run} began with {GENERATOR} {settings.generator[:12]}, here it is {now[:12]}: "
            f"check out commit {settings.commit[:12]} and give --log the runs.jsonl beside which the run is kept"
        )


def _tree_that_runs(repository: Path) -> str:
    """Git's tree hash of the diagnosis, which is the one that workers import.

    Raises:
        DiagnosisError: It is not committed, or workers import that of another folder.
    """
    tree, imported = diagnosis_tree(repository), imported_diagnosis()
    if (repository / "fricomp/diagnosis").resolve() != imported:
        raise DiagnosisError(
            f"the fricomp that runs has its diagnosis in {imported}, not in this checkout: run the command of the "
            "environment that this checkout is installed in"
        )
    return tree


def log_outcome(settings: RunSettings, log: Path, left: int, count: int, figures: Mapping[str, Any]) -> None:
    """Append what came of a scored run so far: `finished`, or `paused` where cases are left; nothing of a replay."""
    if settings.scored and not settings.replayed:
        entry = {"run": settings.run, "tree": settings.tree, "event": "paused" if left else "finished", "cases": count}
        append_entry(log, entry | ({"left": left} if left else {}) | {"figures": dict(figures)})

"""Ending a scored run: its reason in the log, its data in a folder of its own."""

from __future__ import annotations

from pathlib import Path

from fricomp.errors import DiagnosisError

from .kept import KEPT
from .run_log import append_entry, read_entries
from .settings import SETTINGS, read_settings

__all__ = ["close_run"]


def close_run(reason: str, log: Path) -> int:
    """End the scored run whose data is kept beside the log, and return its number.

    The reason is appended to the log, the data moved to `run-N` beside it. What follows no run stays where it is:
    charts, baselines, gaps and causes.

    Args:
        reason: Why it ended, as the page is to tell.
        log: Of the scored runs.

    Raises:
        DiagnosisError: There is no reason, no scored run beside the log, it is closed already, or its folder is taken.
    """
    if not reason.strip():
        raise DiagnosisError("a run is closed with a reason, which the page will tell: give one")
    settings = log.parent / SETTINGS
    found = read_settings(settings) if settings.exists() else None
    if found is None or not found.scored:
        raise DiagnosisError(f"no scored run is kept in {log.parent}: nothing to close")
    if any(entry["run"] == found.run and entry["event"] == "closed" for entry in read_entries(log)):
        raise DiagnosisError(f"scored run {found.run} is closed in {log} already")
    folder = log.parent / f"run-{found.run}"
    if folder.exists():
        raise DiagnosisError(f"{folder} is there already: the data of scored run {found.run} cannot be moved into it")
    folder.mkdir()
    append_entry(log, {"run": found.run, "tree": found.tree, "event": "closed", "reason": reason.strip()})
    for name in KEPT:
        if (log.parent / name).exists():
            (log.parent / name).replace(folder / name)
    return found.run

"""What commands share on the terminal: a console, and a progress bar that is quiet when nobody watches."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Console
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

if TYPE_CHECKING:
    from fricomp.recording import Finding

__all__ = ["careful", "console", "progress", "resumable"]


def careful(finding: Finding) -> str:
    """What was found in a recording, as a sentence beside a result."""
    return f"Careful: {finding.message.rstrip('.')}: {finding.advice}."


def console(*, stderr: bool = False) -> Console:
    """Where commands print tables and sentences; brackets in them, as of an extra or a folder, are no markup."""
    return Console(stderr=stderr, highlight=False, markup=False)


def progress(*, quiet: bool = False) -> Progress:
    """A progress bar with the time left; on stderr, and silent when that is not a terminal or quiet is asked for."""
    errors = Console(stderr=True)
    return Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=errors,
        transient=True,
        disable=quiet or not errors.is_terminal,
    )


@contextmanager
def resumable(out: Path, way: str = "--resume goes on") -> Iterator[None]:
    """Work whose finished parts are in a folder: on Ctrl-C it says so, and how to go on.

    Args:
        out: The folder.
        way: How to go on.
    """
    try:
        yield
    except KeyboardInterrupt:
        print(f"\nInterrupted; what is finished is in {out}: {way}", file=sys.stderr)
        raise

"""Calls on an executor under one progress bar."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TypeVar

__all__ = ["run_side_by_side"]

Result = TypeVar("Result")


def run_side_by_side(calls: Sequence[Callable[[], Result]], executor: str, label: str, out: Path) -> list[Result]:
    """What the calls return, in their order.

    Args:
        calls: They travel to workers, so they have to be picklable.
        executor: As `open_executor` reads it.
        label: Beside the bar.
        out: Folder in which each call leaves what it gave; on Ctrl-C it is named, for --resume.
    """
    from fricomp.cli.terminal import progress, resumable
    from fricomp.fleet import open_executor

    with resumable(out), progress() as bar, open_executor(executor) as (pool, _):
        task = bar.add_task(label, total=len(calls))
        futures = [pool.submit(call) for call in calls]
        for future in futures:
            future.add_done_callback(lambda _: bar.advance(task))
        return [future.result() for future in futures]

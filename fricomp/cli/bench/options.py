"""What several benchmarks share: options, and the pool and the bar of those that do one case after the other."""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer

ExecutorOption = Annotated[str, typer.Option(help="processes://N, serial or dask://host:port.")]
WorkersOption = Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")]


@contextmanager
def working(
    title: str, total: int, out: Path, executor: str, workers: int | None = None, *, way: str = "--resume goes on"
) -> Iterator[tuple[tuple[Executor, int], Callable[[], None]]]:
    """A pool of workers, and what counts a finished case; on Ctrl-C it says how to go on with what is in `out`."""
    from fricomp.cli.terminal import progress, resumable
    from fricomp.fleet import open_executor

    with resumable(out, way), progress() as bar, open_executor(executor, workers) as pool:
        task = bar.add_task(title, total=total)
        yield pool, lambda: bar.advance(task)

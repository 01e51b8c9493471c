"""Running the cases of a study that are not finished yet."""

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from typing import Any

from fricomp.fleet import stream

from .commit import find_commit
from .store import Row, RowStore


def run_cases(
    cases: Mapping[str, tuple[Any, ...]],
    work: Callable[..., Row],
    store: RowStore,
    executor: tuple[Executor, int],
    *,
    resume: bool = True,
    progress: Callable[[], None],
) -> list[Row]:
    """The rows of all cases, in their order. Each row is on disk as soon as its case is finished.

    Args:
        cases: Arguments of `work` by the name of the case.
        work: Does one case and gives its row. It runs on a worker, so it must be a function of a module.
        store: Keeps the rows, each with the name of the case and the commit at which it was made.
        executor: With the number of its workers.
        resume: Keep the cases that are in the store already; otherwise all are made anew.
        progress: Called after each case.
    """
    done = store.index_by_case() if resume else {}
    for _ in cases.keys() & done.keys():
        progress()
    todo = ((name, arguments) for name, arguments in cases.items() if name not in done)
    for name, future in stream(todo, work, executor):
        store.append(future.result() | {"case": name, "commit": find_commit()})
        progress()
    rows = store.index_by_case()
    return [rows[name] for name in cases]

"""Where cases run: in processes here, in this process, or on a Dask cluster."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from typing import Any

from fricomp.errors import DiagnosisError, MissingExtraError

__all__ = ["SerialExecutor", "open_executor"]

_RETRIES = 2  # of a call whose worker died


class SerialExecutor(Executor):
    """Runs each call at once in the calling thread."""

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """The finished future of `fn(*args, **kwargs)`."""
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future


@contextmanager
def open_executor(address: str = "processes") -> Iterator[tuple[Executor, int]]:
    """An executor and the number of its workers, closed at the end.

    Args:
        address: `processes` or `processes://N` (N workers, by default one a core), `serial`, or `dask://host:port`
            for the scheduler of a Dask cluster; `dask://local:N` starts a local one.

    Raises:
        DiagnosisError: The address is none of these, or no scheduler answers there.
        MissingExtraError: dask.distributed is not installed.
    """
    kind, _, rest = address.partition("://")
    if kind == "serial":
        yield SerialExecutor(), 1
    elif kind == "processes":
        workers = int(rest) if rest.isdecimal() and int(rest) > 0 else os.cpu_count() or 1
        context = multiprocessing.get_context("spawn")
        with ProcessPoolExecutor(workers, mp_context=context) as pool:
            yield pool, workers
    elif kind == "dask" and rest:
        yield from _open_dask(rest)
    else:
        raise DiagnosisError(f"unknown executor {address!r}: valid are processes://N, serial, dask://host:port")


def _open_dask(place: str) -> Iterator[tuple[Executor, int]]:
    try:
        import distributed
    except ImportError as error:
        raise MissingExtraError("dask.distributed", "bench") from error
    dask: Any = distributed  # its functions carry no types
    if place.startswith("local"):
        workers = int(place.partition(":")[2] or 2)
        local = dask.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
        with local as cluster, dask.Client(cluster) as client:
            yield client.get_executor(retries=_RETRIES), workers
        return
    try:
        client = dask.Client(f"tcp://{place}", timeout="10s")
    except OSError as error:
        raise DiagnosisError(f"no Dask scheduler answers at {place}: {error}") from error
    with client:
        yield client.get_executor(retries=_RETRIES), max(1, len(client.ncores()))

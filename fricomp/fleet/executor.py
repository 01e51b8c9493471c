"""Where many calls run: in processes here, in this process, or on a Dask cluster."""

import multiprocessing
import os
import re
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import (
    FIRST_COMPLETED,
    BrokenExecutor,
    CancelledError,
    Executor,
    Future,
    ProcessPoolExecutor,
    wait,
)
from contextlib import contextmanager
from multiprocessing.connection import wait as wait_for
from typing import Any, TypeVar
from urllib.parse import parse_qsl

from fricomp.errors import DiagnosisError
from fricomp.extras import needing

EXECUTORS = "processes, processes://N, serial, dask://host:port, dask://tls://host:port?ca=&cert=&key=, dask://local:N"

_ADDRESS = re.compile(
    r"serial|processes(://(?P<processes>[1-9][0-9]*))?"
    r"|dask://(local(:(?P<local>[1-9][0-9]*))?"
    r"|(?P<scheme>(tcp|tls)://)?(?P<scheduler>(?!local:)[^/?]+:[0-9]+(\?.*)?))"
)
_CERTIFICATES = {"ca": "tls_ca_file", "cert": "tls_client_cert", "key": "tls_client_key"}
_LOCAL_WORKERS = 2  # of a local Dask cluster whose address does not say it

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
_RETRIES = 2  # of a call whose worker died
_AHEAD = 2  # calls under way for each worker, so that none waits for the next one
_Item = TypeVar("_Item")


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


class _Processes(ProcessPoolExecutor):
    """Processes that start no call once they are told to stop, not even one that is on its way to a worker."""

    def __init__(self, count: int) -> None:
        context = multiprocessing.get_context("spawn")
        self._stopped = context.Event()
        super().__init__(count, mp_context=context, initializer=_heed, initargs=(self._stopped,))

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """The future of `fn(*args, **kwargs)`."""
        with _spared_from_interrupts():
            return super().submit(_unless_stopped, fn, *args, **kwargs)

    def stop(self) -> None:
        """Leave at once: what runs is given up, what waits is never begun."""
        self._stopped.set()
        for process in list((self._processes or {}).values()):
            process.terminate()
        self.shutdown(wait=False, cancel_futures=True)


@contextmanager
def _spared_from_interrupts() -> Iterator[None]:
    """Processes that are started in here never hear of Ctrl-C, which a terminal sends to all: the parent ends them."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


_stop: Any = None  # in a worker: the event that says that no further call may start


def _heed(stopped: Any) -> None:
    """In a worker, as it starts: heed the event, and end with the process that started it, however that ends."""
    global _stop
    _stop = stopped
    parent = multiprocessing.parent_process()
    if parent is not None:
        threading.Thread(target=_end_with, args=(parent.sentinel,), daemon=True).start()


def _end_with(sentinel: int) -> None:
    wait_for([sentinel])
    os._exit(1)  # a killed parent tells nobody, and what this worker does is of use to nobody


def _unless_stopped(call: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    if _stop is not None and _stop.is_set():
        raise CancelledError
    return call(*args, **kwargs)


def always() -> bool:
    """True: no reason to stop."""
    return True


@contextmanager
def open_executor(address: str = "processes", workers: int | None = None) -> Iterator[tuple[Executor, int]]:
    """An executor and the number of its workers, closed at the end; after an error or Ctrl-C no queued call starts.

    Args:
        address: `processes` or `processes://N` (N workers, by default one a core), `serial`, or `dask://host:port`
            for the scheduler of a Dask cluster; `dask://tls://host:port?ca=FILE&cert=FILE&key=FILE` for one that is
            reached by TLS, where files that are left out are those of Dask's own configuration; `dask://local:N` starts
            a local one.
        workers: How many, where the address does not say it.

    Raises:
        DiagnosisError: The address is none of these, no scheduler answers there, or a worker process died.
        MissingExtraError: dask.distributed is not installed.
    """
    found = _ADDRESS.fullmatch(address)
    if found is None:
        raise DiagnosisError(f"unknown executor {address!r}: valid are {EXECUTORS}, with a positive number N")
    if workers is not None and address != "processes":
        raise DiagnosisError(f"the executor {address!r} has its own number of workers: leave out --workers")
    try:
        if address == "serial":
            yield SerialExecutor(), 1
        elif address.startswith("processes"):
            with _one_thread_each():
                yield from _run_processes(int(found["processes"] or workers or os.cpu_count() or 1))
        elif found["scheduler"]:
            yield from _join_dask((found["scheme"] or "tcp://") + found["scheduler"])
        else:
            yield from _start_dask(int(found["local"] or _LOCAL_WORKERS))
    except BrokenExecutor as error:
        raise DiagnosisError(
            "a worker process died, killed or out of memory: what is finished is kept, --resume goes on with the rest"
        ) from error


def _run_processes(count: int) -> Iterator[tuple[Executor, int]]:
    pool = _Processes(count)
    try:
        yield pool, count
    except BaseException:  # Ctrl-C too
        pool.stop()
        raise
    pool.shutdown()


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes that start meanwhile use one thread each for linear algebra: there are as many of them as cores."""
    before = {name: os.environ.get(name) for name in _THREADS}
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


def _import_dask() -> Any:
    """dask.distributed, whose functions carry no types."""
    with needing("dask.distributed", "bench"):
        import distributed
    return distributed


# The executors are not shut down themselves: a client that is closed takes its calls back, without waiting for any.
def _start_dask(workers: int) -> Iterator[tuple[Executor, int]]:
    dask = _import_dask()
    local = dask.LocalCluster(n_workers=workers, threads_per_worker=1, dashboard_address=None)
    with local as cluster, dask.Client(cluster) as client:
        yield client.get_executor(retries=_RETRIES), workers


def _join_dask(place: str) -> Iterator[tuple[Executor, int]]:
    dask = _import_dask()
    scheduler, _, files = place.partition("?")
    is_safe = scheduler.startswith("tls://")
    if files and not is_safe:
        raise DiagnosisError(f"certificates are of TLS: write dask://tls://host:port?{files}")
    given = {"security": _read_certificates(dask, files)} if is_safe else {}
    try:
        client = dask.Client(scheduler, timeout="10s", **given)
    except OSError as error:
        raise DiagnosisError(f"no Dask scheduler answers at {scheduler}: {error}") from error
    with client:
        yield client.get_executor(retries=_RETRIES), max(1, len(client.ncores()))


def _read_certificates(dask: Any, files: str) -> Any:
    """What Dask needs for TLS, from `ca=FILE&cert=FILE&key=FILE`.

    Raises:
        DiagnosisError: A name is none of these, or a file cannot be read.
    """
    chosen = dict(parse_qsl(files, keep_blank_values=True))
    for name, path in chosen.items():
        if name not in _CERTIFICATES:
            raise DiagnosisError(f"{name!r} is no certificate of TLS: valid are {', '.join(_CERTIFICATES)}")
        if not os.access(path, os.R_OK):
            raise DiagnosisError(f"cannot read the file {path!r} that {name} of TLS names: check the path")
    return dask.Security(require_encryption=True, **{_CERTIFICATES[name]: path for name, path in chosen.items()})


def stream(
    items: Iterable[tuple[_Item, tuple[Any, ...]]], call: Callable[..., Any], executor: tuple[Executor, int]
) -> Iterator[tuple[_Item, Future[Any]]]:
    """Finished futures as they come; a few calls a worker are under way, so that any number of items fits in memory.

    Args:
        items: What is reported beside the future, and the arguments of the call; taken one by one.
        call: What a worker runs; it must be importable there.
        executor: With the number of its workers, as `open_executor` gives it.
    """
    pool, workers = executor
    todo = iter(items)
    waiting: dict[Future[Any], _Item] = {}
    while True:
        while len(waiting) < _AHEAD * workers and (each := next(todo, None)) is not None:
            waiting[pool.submit(call, *each[1])] = each[0]
        if not waiting:
            return
        done, _ = wait(waiting, return_when=FIRST_COMPLETED)
        for future in done:
            yield waiting.pop(future), future

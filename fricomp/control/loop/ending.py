"""The end of a motion: a stop that no signal disturbs, and a word where it did not get through."""

import atexit
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from typing import Protocol

from fricomp.control.loop.interruption import EndingSignals
from fricomp.errors import AdapterError

_TRIES = 3  # signals raise once in half a second at most


class Stoppable(Protocol):
    """What can be stopped; every adapter can."""

    @property
    def stop_failure(self) -> str: ...
    def safe_stop(self, reason: str = "") -> None: ...


@contextmanager
def stopping_on_error(adapter: Stoppable) -> Iterator[None]:
    """Whatever goes wrong inside, an interrupt too, stops the joints before files are closed or anything is said."""
    try:
        yield
    except BaseException as error:
        reason = _name(error)
        undisturbed(lambda: adapter.safe_stop(reason))
        raise


@contextmanager
def stopping_at_exit(adapter: Stoppable) -> Iterator[None]:
    """An interpreter that ends meanwhile stops the joints before it cuts off the thread that moves them."""

    def stop() -> None:  # one of its own: what the user has registered stays
        adapter.safe_stop("the process ends")

    atexit.register(stop)
    try:
        yield
    finally:
        atexit.unregister(stop)


def undisturbed(stop: Callable[[], None]) -> None:
    """Stop, whatever signals come: one that comes before they are kept off has it begun again."""
    for _ in range(_TRIES):
        with suppress(KeyboardInterrupt), EndingSignals(threading.Event()):
            stop()
            return
    stop()


def require_stopped(adapter: Stoppable) -> None:
    """Tell of a stop that did not get through, whatever else is being told: that can wait, the joints cannot.

    Raises:
        AdapterError: The last stop of `adapter` failed; its cause is the error that is on its way, if one is.
    """
    if failure := adapter.stop_failure:
        cause = sys.exception()
        by = "" if cause is None else f" ({_name(cause)})"
        raise AdapterError(f"the motion has ended{by}, but {failure}: cut the power of the joints") from cause


def _name(error: BaseException) -> str:
    return f"{type(error).__name__}: {error}".removesuffix(": ")

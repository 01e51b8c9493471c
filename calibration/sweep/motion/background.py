"""Work beside the control loop: in a thread of its own, while the loop goes on in this one."""

import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from typing import TypeVar

from fricomp.control.loop.ending import undisturbed

__all__ = ["in_background"]

# Time after which the interpreter may take the processor from the worker and give it to the loop [s]; by default it is
# 5 ms, several periods of a loop.
SWITCH_INTERVAL = 2e-4

Outcome = TypeVar("Outcome")


def in_background(
    work: Callable[[], Outcome], serve: Callable[[Callable[[], bool]], object], stop: Callable[[], None]
) -> Outcome:
    """What `work` returns, done in a thread while `serve` runs in this one.

    Args:
        work: Done once and to its end, come what may.
        serve: Returns once the function that it is given says that the work is done.
        stop: Called as soon as anything has gone wrong, an interrupt too, before the work is waited for.

    Raises:
        BaseException: What `serve` or `work` raises; the former if both do.
    """
    with _switch_quickly(), ThreadPoolExecutor(1, "sweep") as executor:
        try:
            future = executor.submit(work)
            serve(future.done)
            return future.result()
        except BaseException:
            undisturbed(stop)
            raise


@contextmanager
def _switch_quickly() -> Iterator[None]:
    before = sys.getswitchinterval()
    sys.setswitchinterval(min(before, SWITCH_INTERVAL))
    try:
        yield
    finally:
        sys.setswitchinterval(before)

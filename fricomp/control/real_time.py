"""What an ordinary Linux gives a control loop: FIFO scheduling, locked memory, one core, no garbage collection.

Soft real time: lateness is measured and reported, never promised. What is not allowed is said and left out.
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field

__all__ = ["RealTimeOptions", "RealTimeReport", "real_time"]

_MCL_CURRENT, _MCL_FUTURE = 1, 2  # mlockall(2)
_PR_SET_TIMERSLACK = 29  # prctl(2)
_DEFAULT_SLACK_NS = 50_000


@dataclass(frozen=True)
class RealTimeOptions:
    """What to ask for.

    Attributes:
        priority: FIFO priority, 1 to 99; 0 leaves the scheduler alone.
        core: Core to stay on; None for any.
        lock_memory: Keep all pages in memory.
        freeze_garbage: Collect once, then keep the collector off: a full collection takes tens of milliseconds.
    """

    priority: int = 0
    core: int | None = None
    lock_memory: bool = False
    freeze_garbage: bool = True


@dataclass
class RealTimeReport:
    """What was granted.

    Attributes:
        granted: What took effect.
        refused: What did not, and why.
    """

    granted: list[str] = field(default_factory=list)
    refused: list[str] = field(default_factory=list)


@contextlib.contextmanager
def real_time(options: RealTimeOptions) -> Iterator[RealTimeReport]:
    """Apply `options` to this thread for as long as the context lasts."""
    report = RealTimeReport()
    with contextlib.ExitStack() as stack:
        if options.freeze_garbage:
            stack.enter_context(_frozen_garbage())
            report.granted.append("garbage collector frozen")
        if sys.platform == "linux":
            _linux(options, stack, report)
        elif options.priority or options.lock_memory or options.core is not None:
            report.refused.append(f"scheduling and memory locking are for Linux, this is {sys.platform}")
        yield report


@contextlib.contextmanager
def _frozen_garbage() -> Iterator[None]:
    was_enabled = gc.isenabled()
    gc.collect()
    gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        gc.unfreeze()
        if was_enabled:
            gc.enable()


def _linux(options: RealTimeOptions, stack: contextlib.ExitStack, report: RealTimeReport) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0) == 0:
        report.granted.append("timer slack 1 ns")
        stack.callback(libc.prctl, _PR_SET_TIMERSLACK, _DEFAULT_SLACK_NS, 0, 0, 0)
    if options.lock_memory:
        if libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) == 0:
            report.granted.append("memory locked")
            stack.callback(libc.munlockall)
        else:
            report.refused.append(f"memory not locked: {os.strerror(ctypes.get_errno())}")
    if options.core is not None:
        try:
            before = os.sched_getaffinity(0)
            os.sched_setaffinity(0, {options.core})
            stack.callback(os.sched_setaffinity, 0, before)
            report.granted.append(f"on core {options.core}")
        except OSError as error:
            report.refused.append(f"not bound to core {options.core}: {error.strerror}")
    if options.priority:
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(options.priority))
            stack.callback(os.sched_setscheduler, 0, os.SCHED_OTHER, os.sched_param(0))
            report.granted.append(f"FIFO priority {options.priority}")
        except OSError as error:
            report.refused.append(f"no FIFO scheduling: {error.strerror}")

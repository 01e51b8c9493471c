"""What an ordinary Linux gives a control loop: FIFO scheduling, locked memory, one core, no garbage collection.

Soft real time: lateness is measured and reported, never promised. What is not allowed is said and left out.
"""

import contextlib
import ctypes
import gc
import os
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field

from fricomp.control.number import is_number
from fricomp.errors import ParameterError

_MCL_CURRENT, _MCL_FUTURE = 1, 2  # mlockall(2)
_PR_SET_TIMERSLACK, _PR_GET_TIMERSLACK = 29, 30  # prctl(2)


@dataclass(frozen=True)
class RealTimeOptions:
    """What to ask for.

    Attributes:
        priority: FIFO priority, 1 to 99; 0 leaves the scheduler alone.
        core: Core to stay on; None for any.
        lock_memory: Keep all pages in memory.
        freeze_garbage: Collect once, then keep the collector off: a full collection takes tens of milliseconds. What
            is frozen already stays so, and no more is added to it.

    Raises:
        ParameterError: Priority or core is out of its domain.
    """

    priority: int = 0
    core: int | None = None
    lock_memory: bool = False
    freeze_garbage: bool = True

    def __post_init__(self) -> None:
        if not (isinstance(self.priority, int) and is_number(self.priority, 0, 99)):
            raise ParameterError(f"priority must be from 0 to 99, got {self.priority!r}")
        if self.core is not None and not (isinstance(self.core, int) and is_number(self.core, 0)):
            raise ParameterError(f"core must be at least 0, got {self.core!r}")
        for name in ("lock_memory", "freeze_garbage"):
            if not isinstance(getattr(self, name), bool):
                raise ParameterError(f"{name} must be True or False, got {getattr(self, name)!r}")


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
    """Apply `options` to this thread for as long as the context lasts; then all is as it was before.

    Memory of which some was locked before stays locked: the system does not tell which.
    """
    report = RealTimeReport()
    with contextlib.ExitStack() as stack:
        if options.freeze_garbage:
            stack.enter_context(_freeze_garbage())
            report.granted.append("garbage collector frozen")
        if sys.platform == "linux":
            _ask_linux(options, stack, report)
        elif options.priority or options.lock_memory or options.core is not None:
            report.refused.append(f"scheduling and memory locking are for Linux, this is {sys.platform}")
        yield report


@contextlib.contextmanager
def _freeze_garbage() -> Iterator[None]:
    was_enabled, was_frozen = gc.isenabled(), gc.get_freeze_count() > 0
    gc.collect()
    if not was_frozen:
        gc.freeze()
    gc.disable()
    try:
        yield
    finally:
        if not was_frozen:
            gc.unfreeze()
        if was_enabled:
            gc.enable()


def _ask_linux(options: RealTimeOptions, stack: contextlib.ExitStack, report: RealTimeReport) -> None:
    libc = ctypes.CDLL(None, use_errno=True)
    slack = libc.prctl(_PR_GET_TIMERSLACK, 0, 0, 0, 0)
    if libc.prctl(_PR_SET_TIMERSLACK, 1, 0, 0, 0) == 0:
        report.granted.append("timer slack 1 ns")
        stack.callback(libc.prctl, _PR_SET_TIMERSLACK, max(slack, 0), 0, 0, 0)  # 0 is the thread's default
    if options.lock_memory:
        was_locked = _is_memory_locked()
        if libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) == 0:
            report.granted.append("memory locked")
            if not was_locked:
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
            policy, parameters = os.sched_getscheduler(0), os.sched_getparam(0)
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(options.priority))
            stack.callback(os.sched_setscheduler, 0, policy, parameters)
            report.granted.append(f"FIFO priority {options.priority}")
        except OSError as error:
            report.refused.append(f"no FIFO scheduling: {error.strerror}")


def _is_memory_locked() -> bool:
    """Whether this process has locked memory already [proc(5), VmLck]."""
    with contextlib.suppress(OSError), open("/proc/self/status", encoding="ascii", errors="replace") as status:
        return any(line.startswith("VmLck:") and line.split()[1] != "0" for line in status)
    return False

"""Signals that end a motion: Ctrl-C, a polite kill, a terminal that goes away."""

from __future__ import annotations

import contextlib
import math
import signal
import threading
import time
import warnings
from collections.abc import Iterator
from types import FrameType
from typing import Any

ENDING_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT") if hasattr(signal, name)
)
"""What this system has of them; each would otherwise leave the joints to their watchdogs."""

_TWICE = 0.5  # [s] within which signals are one


class EndingSignals(contextlib.AbstractContextManager["EndingSignals"]):
    """The first one ends a loop after its cycle: a handler that stopped the drives could meet a held lock.

    A signal whose handler is none of Python's, set by a library in C, is left to it: Python could not give it back.
    Inside `impatient` the second does not wait for a cycle that hangs. No other raises anything: what runs in this
    context beside that, the stop of the joints above all, is not disturbed.

    Args:
        stop: Set by the first.
    """

    def __init__(self, stop: threading.Event) -> None:
        self._stop, self._received, self._may_raise = stop, 0, False
        self._before: dict[int, Any] = {}

    def __enter__(self) -> EndingSignals:
        if threading.current_thread() is threading.main_thread():
            try:
                for number in ENDING_SIGNALS:
                    if signal.getsignal(number) is not None:
                        self._before[number] = signal.signal(number, self._handle)
            except BaseException:  # a signal whose handler raises came in between
                self.__exit__()
                raise
        return self

    def __exit__(self, *_: object) -> None:
        for number, handler in self._before.items():
            signal.signal(number, handler)

    def _handle(self, number: int, _: FrameType | None) -> None:
        self._received += 1
        self._stop.set()
        if self._may_raise and self._received >= 2:
            self._may_raise = False
            raise KeyboardInterrupt

    @contextlib.contextmanager
    def impatient(self) -> Iterator[None]:
        """Where the second signal raises `KeyboardInterrupt`, once; what must follow is in a `finally` around it."""
        self._may_raise = True
        try:
            yield
        finally:
            self._may_raise = False

    def raise_interrupt(self) -> None:
        """Hand on what was received, now that the joints are at rest."""
        if self._received:
            raise KeyboardInterrupt


def interrupt_on_ending_signals() -> None:
    """From here on each of them raises `KeyboardInterrupt`, SIGINT too: a shell switches it off for background jobs.

    One that follows within half a second, as from a key that is pressed twice or a terminal that goes away, raises
    nothing: it would cut off the stop that the first one began.
    """
    last = -math.inf

    def interrupt(number: int, frame: FrameType | None) -> None:
        nonlocal last
        now = time.monotonic()
        if now - last >= _TWICE:
            last = now
            raise KeyboardInterrupt

    for number in ENDING_SIGNALS:
        signal.signal(number, interrupt)


@contextlib.contextmanager
def interrupting_on_ending_signals() -> Iterator[None]:
    """`interrupt_on_ending_signals` as long as the context lasts; afterwards each signal does what it did before.

    Outside the main thread nothing can be done about signals, and `warn_of_unheard_signals` says which end the process.
    """
    if threading.current_thread() is not threading.main_thread():
        warn_of_unheard_signals()
        yield
        return
    before = {number: signal.getsignal(number) for number in ENDING_SIGNALS}
    interrupt_on_ending_signals()
    try:
        yield
    finally:
        for number, handler in before.items():
            if handler is not None:  # one that a library in C has set cannot be given back
                signal.signal(number, handler)


def warn_of_unheard_signals() -> None:
    """Say which signals end the process at once: outside the main thread a loop hears none, so the process must."""
    if threading.current_thread() is threading.main_thread():
        return
    unheard = [number.name for number in ENDING_SIGNALS if signal.getsignal(number) is signal.SIG_DFL]
    if unheard:
        warnings.warn(
            f"a loop outside the main thread hears no signal, and {', '.join(unheard)} would end this process without "
            "a stop of the joints: call fricomp.control.interrupt_on_ending_signals() in the main thread before, and "
            "stop() the loop there on KeyboardInterrupt",
            RuntimeWarning,
            stacklevel=4,
        )

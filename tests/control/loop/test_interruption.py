"""Signals that end a motion: two in a row are one, and none cuts off a stop."""

from __future__ import annotations

import atexit
import signal
import threading
import warnings
from collections.abc import Callable, Iterator

import pytest

from fricomp.control.loop.ending import stopping_at_exit, stopping_on_error, undisturbed
from fricomp.control.loop.interruption import (
    ENDING_SIGNALS,
    EndingSignals,
    interrupt_on_ending_signals,
    warn_of_unheard_signals,
)


@pytest.fixture(autouse=True)
def _signals_as_before() -> Iterator[None]:
    before = {number: signal.getsignal(number) for number in ENDING_SIGNALS}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


class _Joints:
    stop_failure = ""

    def __init__(self) -> None:
        self.stops = 0

    def safe_stop(self, reason: str = "") -> None:
        signal.raise_signal(signal.SIGTERM)
        self.stops += 1


def test_a_second_signal_that_follows_at_once_raises_nothing() -> None:
    interrupt_on_ending_signals()
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGTERM)
    signal.raise_signal(signal.SIGINT)


def test_a_signal_does_not_cut_off_the_stop_that_an_interrupt_began() -> None:
    interrupt_on_ending_signals()
    joints = _Joints()
    with pytest.raises(KeyboardInterrupt), stopping_on_error(joints):
        signal.raise_signal(signal.SIGINT)
    assert joints.stops == 1


def test_a_stop_that_a_signal_met_before_it_was_kept_off_begins_again() -> None:
    calls = []

    def stop() -> None:
        calls.append(1)
        if len(calls) == 1:
            raise KeyboardInterrupt

    undisturbed(stop)
    assert len(calls) == 2


def test_a_process_that_ends_stops_the_joints_of_a_loop_that_still_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    at_exit: list[Callable[[], None]] = []
    monkeypatch.setattr(atexit, "register", at_exit.append)
    monkeypatch.setattr(atexit, "unregister", at_exit.remove)
    joints = _Joints()
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    with stopping_at_exit(joints):
        at_exit[0]()
    assert (joints.stops, at_exit) == (1, [])


def _warned_in_a_thread() -> list[str]:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        thread = threading.Thread(target=warn_of_unheard_signals)
        thread.start()
        thread.join(timeout=5.0)
    return [str(warning.message) for warning in caught]


def test_outside_the_main_thread_signals_that_nobody_handles_are_named() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    (said,) = _warned_in_a_thread()
    assert "SIGTERM" in said
    interrupt_on_ending_signals()
    assert _warned_in_a_thread() == []


def test_in_the_main_thread_nothing_is_warned_of() -> None:
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    warn_of_unheard_signals()


def test_a_handler_that_python_cannot_put_back_is_left_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    before = signal.getsignal(signal.SIGTERM)
    of_python = signal.getsignal
    monkeypatch.setattr(signal, "getsignal", lambda number: None if number == signal.SIGTERM else of_python(number))
    with EndingSignals(threading.Event()):
        monkeypatch.undo()
        assert signal.getsignal(signal.SIGTERM) is before
        assert signal.getsignal(signal.SIGINT) is not signal.default_int_handler

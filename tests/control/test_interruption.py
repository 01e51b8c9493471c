"""Signals that end a motion: two in a row are one, and none cuts off a stop."""

from __future__ import annotations

import signal
from collections.abc import Iterator

import pytest

from fricomp.control.ending import stopping_on_error, undisturbed
from fricomp.control.interruption import ENDING_SIGNALS, interrupt_on_ending_signals


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

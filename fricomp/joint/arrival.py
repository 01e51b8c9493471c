"""Waiting for the first state of the joints: a drive answers some time after it was asked, never at once."""

from math import isfinite
from typing import Protocol

from fricomp.errors import AdapterTimeout

from .clock import Clock
from .exchange import JointFeedback

_PATIENCE = 1.0  # [s]


class FeedbackSource(Protocol):
    """What is read; `fricomp.adapters.JointAdapter` is one."""

    @property
    def clock(self) -> Clock: ...
    def read_into(self, feedback: JointFeedback) -> bool: ...


def await_feedback(source: FeedbackSource, feedback: JointFeedback, period: float) -> None:
    """Read until all joints have reported a position.

    Args:
        source: Open and configured.
        feedback: Filled with the state.
        period: Between looks [s].

    Raises:
        AdapterTimeout: They have not within a second.
        AdapterError: The bus failed.
    """
    clock = source.clock
    deadline = clock.now_ns() + round(_PATIENCE * 1e9)
    while not (source.read_into(feedback) and all(map(isfinite, feedback.position))):
        if clock.now_ns() > deadline:
            raise AdapterTimeout(f"no feedback within {_PATIENCE:g} s: check wiring, power and node ids")
        clock.sleep_until(clock.now_ns() + round(period * 1e9))

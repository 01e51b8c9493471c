"""The clock a control loop runs by: real, or virtual in lock step with a simulation."""

import time
from typing import Protocol


class Clock(Protocol):
    """Time in nanoseconds that never goes back."""

    def now_ns(self) -> int:
        """The time now [ns]."""

    def sleep_until(self, deadline_ns: int) -> None:
        """Return once the time is at or past `deadline_ns` [ns]."""


def stands_still(clock: Clock) -> bool:
    """Whether time passes in `sleep_until` only, as in lock step with a simulation: what is done meanwhile takes none.

    A clock that is so says it by the attribute `is_lock_step`; any other one counts as running by itself.
    """
    return bool(getattr(clock, "is_lock_step", False))


class MonotonicClock:
    """Real time. Sleeps, then spins over the last stretch, where sleeping alone would be late.

    Args:
        spin_ns: Length of the stretch that is spun [ns]; 150 µs cuts the median lateness of a sleep from tens of
            microseconds to well under one, at the price of that share of a core.
    """

    def __init__(self, spin_ns: int = 150_000) -> None:
        self._spin_ns = spin_ns

    def now_ns(self) -> int:
        """The time now [ns]."""
        return time.monotonic_ns()

    def sleep_until(self, deadline_ns: int) -> None:
        """Return once the time is at or past `deadline_ns` [ns]."""
        remaining = deadline_ns - time.monotonic_ns() - self._spin_ns
        if remaining > 0:
            time.sleep(remaining * 1e-9)
        while time.monotonic_ns() < deadline_ns:
            pass

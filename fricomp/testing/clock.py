"""Time that moves only when told to, and takes the drives along."""

from collections.abc import Callable


class VirtualClock:
    """Virtual time for tests in lock step; sleeping advances it.

    Args:
        start_ns: Where it starts [ns].
        step_ns: Longest step in which listeners follow [ns].
    """

    is_lock_step = True

    def __init__(self, start_ns: int = 1_000_000_000, step_ns: int = 1_000_000) -> None:
        self._now_ns = start_ns
        self._step_ns = step_ns
        self._listeners: list[Callable[[int], None]] = []

    def now_ns(self) -> int:
        """The time now [ns]."""
        return self._now_ns

    def sleep_until(self, deadline_ns: int) -> None:
        """Advance to `deadline_ns` [ns], in steps that the listeners see."""
        while self._now_ns < deadline_ns:
            self._now_ns = min(self._now_ns + self._step_ns, deadline_ns)
            for listener in self._listeners:
                listener(self._now_ns)

    def advance(self, seconds: float) -> None:
        """Let `seconds` [s] pass."""
        self.sleep_until(self._now_ns + round(seconds * 1e9))

    def follow(self, listener: Callable[[int], None]) -> None:
        """Call `listener` with the time [ns] after every step."""
        self._listeners.append(listener)

"""Counters of 32 bits that go on at their other end: their position goes on where it was."""

from __future__ import annotations

__all__ = ["CountUnwrapper", "wrap_count"]

WHOLE, HALF = 1 << 32, 1 << 31


class CountUnwrapper:
    """Counts on where a counter of 32 bits begins again at its other end.

    Between two counts no joint moves by half of the range, so that a larger step is the end of it.
    """

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """The next count stands for itself: the counter has started anew."""
        self._last: int | None = None
        self._offset = 0

    def unwrap(self, count: int) -> int:
        """The count, as if the counter had no end."""
        last, self._last = self._last, count
        if last is not None and not -HALF <= count - last < HALF:
            self._offset += WHOLE if count < last else -WHOLE
        return count + self._offset


def wrap_count(count: int) -> int:
    """A count as a counter of 32 bits with a sign has it."""
    return (count + HALF) % WHOLE - HALF

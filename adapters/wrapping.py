"""Counters of 32 bits that go on at their other end: their position goes on where it was."""

__all__ = ["CountUnwrapper", "wrap_count"]

WHOLE, HALF = 1 << 32, 1 << 31
NEAR = 1 << 29
"""Counts by which no joint moves between two states: 128 turns a state with 22 bits a turn."""


class CountUnwrapper:
    """Counts on where a counter of 32 bits begins again at its other end.

    A count far from the one before, whichever way round, is none of this joint's motion: it is told as it is, nearest
    to where the joint was, and the next one is compared with that before it. Two damaged ones on both sides of the end
    would else pass for its end, and leave every later position off by the whole range.
    """

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """The next count stands for itself: the counter has started anew."""
        self._last: int | None = None
        self._offset = 0
        self._is_followed = False

    def unwrap(self, count: int) -> int:
        """The count, as if the counter had no end."""
        last, offset = self._last, self._offset
        if last is None:
            self._last = count
            return count
        step = count - last
        if not -NEAR <= step <= NEAR:
            nearest = wrap_count(step)
            offset += nearest - step
            if not -NEAR <= nearest <= NEAR:
                if not self._is_followed:  # the first one was damaged, or this one is: either stands for itself
                    self._last = count
                    return count
                return count + offset
        self._last, self._offset, self._is_followed = count, offset, True
        return count + offset


def wrap_count(count: int) -> int:
    """A count as a counter of 32 bits with a sign has it."""
    return (count + HALF) % WHOLE - HALF

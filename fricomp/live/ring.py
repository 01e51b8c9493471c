"""The newest cycles of a loop in shared memory: a writer that never waits, and readers that may miss some."""

import struct
from collections.abc import Sequence
from math import nan
from multiprocessing.shared_memory import SharedMemory

from fricomp.joint import JointFeedback

COLUMNS = ("position", "velocity", "torque", "temperature", "admitted")
"""Of each joint in a row, after the time [s]: SI, joint side; `admitted` is the torque that the gate let through."""

_ROWS = 16_384
"""Rows that are kept: 16 s at 1 kHz, of which a reader asks for the last few."""
_COUNT = struct.Struct("<q")


class CycleRing:
    """Rows of numbers in a ring; the count of all rows ever written stands before it.

    Args:
        n_joints: Joints in a row.
        name: Of shared memory that is there; empty makes it.
    """

    def __init__(self, n_joints: int, name: str = "") -> None:
        self.n_joints, self._row = n_joints, struct.Struct(f"<{1 + len(COLUMNS) * n_joints}d")
        size = _COUNT.size + _ROWS * self._row.size
        self._memory = SharedMemory(name or None, create=not name, size=0 if name else size)
        self._is_own, self._written = not name, 0
        if not name:
            _COUNT.pack_into(self._buffer, 0, 0)

    @property
    def name(self) -> str:
        """By which another process finds it."""
        return self._memory.name

    @property
    def _buffer(self) -> memoryview:
        return self._memory.buf  # type: ignore[return-value]  # None once it is closed, which raises where it is used

    def write(self, time: float, feedback: JointFeedback, admitted: Sequence[float]) -> None:
        """Add a row; takes some microseconds and waits for nothing.

        Args:
            time: Since the loop began [s].
            feedback: What the joints report.
            admitted: Torque of each joint that was let through last [N·m] or [N]; empty where there is none.
        """
        told = admitted or [nan] * self.n_joints
        columns = (feedback.position, feedback.velocity, feedback.torque, feedback.temperature, told)
        place = _COUNT.size + self._written % _ROWS * self._row.size
        self._row.pack_into(self._buffer, place, time, *(value for column in columns for value in column))
        self._written += 1
        _COUNT.pack_into(self._buffer, 0, self._written)

    def read(self, since: int, most: int) -> tuple[int, list[tuple[float, ...]]]:
        """Rows that came after the first `since`, every so many-th where there are more than `most`.

        Returns:
            How many there are by now, and the rows: the time, then the columns joint after joint of each.
        """
        (count,) = _COUNT.unpack_from(self._buffer, 0)
        first = max(since, count - _ROWS // 2, 0)
        step = max((count - first) // most, 1)
        numbers = range(count - 1, first - 1, -step)[::-1]
        places = (_COUNT.size + number % _ROWS * self._row.size for number in numbers)
        return count, [self._row.unpack_from(self._buffer, place) for place in places]

    def close(self) -> None:
        """Let go of the memory, which its maker takes away."""
        self._memory.close()
        if self._is_own:
            self._memory.unlink()

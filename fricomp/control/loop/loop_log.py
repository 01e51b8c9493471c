"""The log of a control loop: rows allocated before it starts, read and saved after it ends."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray

if TYPE_CHECKING:
    from fricomp.recording import Recording, RecordingMetadata

_SIGNALS = (
    "position",
    "velocity",
    "torque",
    "position_reference",
    "velocity_reference",
    "compensation",
    "torque_command",
)
_HEAD = 3  # time, lateness, busy


class LoopTiming(NamedTuple):
    """How a loop kept its time.

    Attributes:
        lateness_p50: Median delay of a cycle's start [s].
        lateness_p999: Its 99.9 % quantile [s].
        lateness_max: The largest [s].
        busy_p50: Median time a cycle took: read, control, compensate, gate, write [s].
        busy_p999: Its 99.9 % quantile [s].
        busy_max: The longest [s].
    """

    lateness_p50: float
    lateness_p999: float
    lateness_max: float
    busy_p50: float
    busy_p999: float
    busy_max: float


class LoopLog:
    """A ring of rows; the oldest are overwritten.

    Args:
        n_joints: Number of joints.
        capacity: Rows kept; 60 s at 1 kHz and seven joints take 26 MB.

    Raises:
        ParameterError: The capacity is not positive, or beyond the memory there is.
    """

    def __init__(self, n_joints: int, capacity: int = 60_000) -> None:
        if capacity < 1:
            raise ParameterError(f"the capacity of a log must be positive, got {capacity!r}")
        self.n_joints = n_joints
        try:
            self._rows = np.zeros((capacity, _HEAD + len(_SIGNALS) * n_joints))
        except (MemoryError, ValueError) as error:
            raise ParameterError(f"a log of {capacity} cycles does not fit into memory: keep fewer") from error
        self._count = 0

    def append(self, row: list[float]) -> None:
        """Keep one cycle: time [s], lateness [s], busy [s], then every signal for every joint."""
        self._rows[self._count % len(self._rows)] = row
        self._count += 1

    def __len__(self) -> int:
        return min(self._count, len(self._rows))

    @property
    def overwritten(self) -> int:
        """How many of the oldest rows were lost."""
        return self._count - len(self)

    @property
    def time(self) -> FloatArray:
        """Start of each cycle since the start of the loop, shape (n_cycles,) [s]."""
        return self._order()[:, 0]

    @property
    def lateness(self) -> FloatArray:
        """Delay of each cycle's start, shape (n_cycles,) [s]."""
        return self._order()[:, 1]

    @property
    def busy(self) -> FloatArray:
        """Time that each cycle took, shape (n_cycles,) [s]."""
        return self._order()[:, 2]

    def signal(self, name: str) -> FloatArray:
        """A signal of all joints, shape (n_cycles, n_joints).

        Raises:
            ParameterError: There is no such signal.
        """
        if name not in _SIGNALS:
            raise ParameterError(f"the log has no signal {name!r}; it has {', '.join(_SIGNALS)}")
        start = _HEAD + _SIGNALS.index(name) * self.n_joints
        return self._order()[:, start : start + self.n_joints]

    def timing(self) -> LoopTiming:
        """Quantiles of lateness and busy time.

        Raises:
            ParameterError: No cycle was logged.
        """
        if not len(self):
            raise ParameterError("the log is empty: the loop has not completed a cycle")
        lateness, busy = (np.quantile(values, (0.5, 0.999, 1.0)).tolist() for values in (self.lateness, self.busy))
        return LoopTiming(*lateness, *busy)

    def recording(self, joint: int, metadata: RecordingMetadata) -> Recording:
        """The log of one joint as a recording; where the drive reports no torque, with the command in its place."""
        from fricomp.recording import Recording  # after the loop, so that a robot's start does not wait for it

        signals = {name: self.signal(name)[:, joint] for name in _SIGNALS if name != "compensation"}
        if not np.all(np.isfinite(signals["torque"])):
            signals["torque"], metadata = signals["torque_command"], replace(metadata, torque_kind="commanded")
        return Recording(time=self.time, metadata=metadata, **signals)

    def _order(self) -> FloatArray:
        if self._count <= len(self._rows):
            return self._rows[: self._count]
        first = self._count % len(self._rows)
        return np.concatenate([self._rows[first:], self._rows[:first]])

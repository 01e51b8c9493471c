"""A zero of the position that is set anew while a log goes on, as by homing or at the index of an encoder."""

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.quantum import measure_quantum
from fricomp.recording.recording import Recording

_JUMP = 30.0
"""Step over those of fast motion, above which no motion makes it."""
_NOTED = 10.0
"""Step over those of fast motion above which it must be such a jump too: a stretch of zeros has one at either end."""
_LEAST_JUMP = 0.01
"""Part of the travel below which a jump does no harm."""
_MOST = 3
"""Jumps of a log that is homed; a position that jumps more often has another flaw."""
_SHORTEST = 1.0
"""Time on either side of a jump [s]: rows of another publisher and outliers come back sooner."""
_REACH = 5
"""Rows on either side of a jump over which motion and torque are compared."""
_ALIKE = 0.05
"""Part of the torque's range, and of a fast motion's steps, within which the joint goes on as before."""
_TAIL = 0.01
"""Part of the rows at either end of the torque's range that does not count."""


def find_new_zeros(recording: Recording) -> NDArray[np.intp]:
    """The last rows before the position is counted from another zero.

    There it jumps once, while time, speed and torque go on: had the joint moved so far, gravity would be another, and
    lost rows would have taken time. All jumps of a recording must be such; else none is told.
    """
    nothing = np.zeros(0, dtype=np.intp)
    step = np.diff(recording.position)
    size = np.abs(step)
    if not size.any():
        return nothing
    fast = float(np.percentile(size[size > 0.0], 90))
    least = _LEAST_JUMP * float(np.ptp(recording.position))
    rows = np.flatnonzero(size > max(_JUMP * fast, least))
    if not 0 < rows.size <= _MOST or rows.size < np.count_nonzero(size > max(_NOTED * fast, least)):
        return nothing
    ends = recording.time[np.concatenate([[0], rows, rows + 1, [-1]])]
    lengths = np.sort(ends)[1::2] - np.sort(ends)[::2]
    if np.min(lengths) < max(_SHORTEST, _REACH * recording.sample_period):
        return nothing
    return rows if all(_goes_on(recording, int(row), fast) for row in rows) else nothing


def _goes_on(recording: Recording, row: int, fast: float) -> bool:
    """Whether time, speed and torque after a jump are as before it.

    Args:
        recording: With the jump.
        row: The last one before it.
        fast: Way of a fast motion from row to row [rad] or [m].
    """
    before, after = slice(row + 1 - _REACH, row + 1), slice(row + 1, row + 1 + _REACH)
    if recording.time[row + 1] - recording.time[row] > 2.0 * recording.sample_period:
        return False
    speeds = [float(np.mean(np.diff(recording.position[rows]))) for rows in (before, after)]
    torques = [float(np.median(recording.torque[rows])) for rows in (before, after)]
    low, high = np.quantile(recording.torque, [_TAIL, 1.0 - _TAIL])
    steps_of_encoder = measure_quantum(np.asarray(recording.position)) / (_REACH - 1)
    is_as_fast = abs(speeds[1] - speeds[0]) <= max(_ALIKE * fast, 2.0 * steps_of_encoder)
    return bool(is_as_fast and abs(torques[1] - torques[0]) <= _ALIKE * (high - low))


def join_zeros(recording: Recording) -> tuple[Recording, tuple[str, ...]]:
    """The recording with all of its position counted from the last zero, and a sentence on each that came before."""
    said = []
    for row in find_new_zeros(recording):
        beside = recording.position[[row - 1, row, row + 1, row + 2]]
        way = float(beside[2] - beside[1] - 0.5 * (beside[1] - beside[0] + beside[3] - beside[2]))
        changed = {"position": _move(np.asarray(recording.position), int(row), way)}
        if recording.position_reference is not None:
            changed |= _move_reference(np.asarray(recording.position_reference), int(row), way)
        recording = recording.with_channels(**changed)
        said.append(
            f"Position: its zero is set anew at {recording.time[row + 1]:.4g} s, where it jumps by {way:.4g} "
            f"{recording.metadata.position_unit} and the joint goes on as before; what is before was moved there."
        )
    return recording, tuple(said)


def _move(values: NDArray[np.float64], row: int, way: float) -> NDArray[np.float64]:
    """The values with all rows up to one moved by a way."""
    return np.concatenate([values[: row + 1] + way, values[row + 1 :]])


def _move_reference(reference: NDArray[np.float64], row: int, way: float) -> dict[str, NDArray[np.float64]]:
    """The reference moved alike where it jumps alike, up to some rows earlier or later; nothing where it does not."""
    first = max(row - _REACH, 0)
    steps = np.diff(reference[first : row + 1 + _REACH])
    at = int(np.argmax(np.abs(steps)))
    is_alike = abs(float(steps[at]) - way) < _ALIKE * abs(way)
    return {"position_reference": _move(reference, first + at, way)} if is_alike else {}

"""Rows that repeat the one before: a log that is written faster than its drive answers has a lower true rate."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.recording import Recording

Rows = NDArray[np.bool_]
Indices = NDArray[np.intp]
Values = NDArray[np.float64]

_FAST = 3.0
"""Usual steps of position from one new value to the next that make a motion fast: each new reading differs then."""
_HELD = 0.3
"""Part of the rows in fast motion that repeat the one before, above which rows are held."""


_READINGS = ("torque", "velocity", "load_torque", "current", "motor_position")
"""Channels that are read from the drive, maybe in other rows than the position; a command is known in each."""

_LONGEST = 0.15
"""Time that a reading may last [s]: no drive answers more slowly, and a joint that is moved in steps looks alike."""


_EVEN = 0.75
"""Step over another one, from which on they are alike."""
_FEWEST_STALE = 5
"""Rows from which on it is no chance that readings repeat."""


class Hold(NamedTuple):
    """How rows were held.

    Attributes:
        rows: For how many rows a reading lasts, as a median.
        left_out: Rows that repeat the one before.
    """

    rows: float
    left_out: int


def thin_held_rows(recording: Recording) -> tuple[Recording, Hold | None]:
    """The recording at the rate of its readings: of held rows the first is kept, where the reading came in.

    The position tells how long a reading lasts: torque or velocity may be read more often, but without a position there
    is no motion to compare them with. At rest nothing changes either way; there rows are kept in the rhythm of the
    motion. A channel whose readings come in other rows is interpolated between them: where a bus sends the torque one
    row after the position, the torque in the position's row is nearly a whole reading old.
    """
    position = np.asarray(recording.position)
    held = _typical_hold(position)
    if held is None or held * recording.sample_period > _LONGEST:
        return recording, None
    spacing = max(round(held), 1)
    kept = _list_readings(position, spacing)
    read = {
        name: _read_between(recording, recording.channels[name], kept)
        for name in _READINGS
        if name in recording.channels
    }
    return recording.rows(kept).with_channels(**read), Hold(held, len(recording) - kept.size)


def find_stale_rows(recording: Recording) -> Rows:
    """Rows in which a reading failed now and then and all of the row before was logged again, though the joint moves.

    A joint that rests repeats its readings, too: only rows count about which the position changes by several of its
    steps, or evenly. Where readings last for some rows the rate is another one, and none failed. Shape (n_samples,).
    """
    position, none = np.asarray(recording.position), np.zeros(len(recording), dtype=bool)
    measured = [recording.channels[name] for name in ("position", *_READINGS) if name in recording.channels]
    same = np.concatenate([[False], np.all([np.diff(values) == 0.0 for values in measured], axis=0)])
    step = np.abs(np.diff(position))
    if not np.any(step > 0.0) or _typical_hold(position) is not None:
        return none
    about = np.abs(np.append(position[1:], position[-1]) - np.append(position[0], position[:-1]))
    moves = about > _FAST * float(np.quantile(step[step > 0.0], 0.02))
    stale = same & (moves | _find_steps_of_two(step))
    return stale if np.count_nonzero(stale) >= _FEWEST_STALE else none


def _find_steps_of_two(step: Values) -> Rows:
    """Rows without a step between even ones, after which the position makes up for it: a slow motion is even as well.

    Args:
        step: Sizes of the steps of position. Shape (n_samples - 1,).
    """
    found = np.zeros(step.size + 1, dtype=bool)
    before, none, after, later = step[:-3], step[1:-2], step[2:-1], step[3:]
    even = np.minimum(before, later) > _EVEN * np.maximum(before, later)
    found[2:-2] = (none == 0.0) & even & (after > 2.0 * _EVEN * np.maximum(before, later))
    return found


def _list_readings(values: Values, spacing: int) -> Indices:
    """Rows in which readings of a channel came in; one that stays is read again every `spacing` rows. Shape (m,)."""
    rows = np.flatnonzero(_find_new(values))
    kept: list[int] = []
    for row, following in zip(rows, [*rows[1:], values.size], strict=True):
        kept += range(int(row), int(following), spacing) if following - row > 2 * spacing else [int(row)]
    return np.array(kept, dtype=np.intp)


def _read_between(recording: Recording, values: Values, kept: Indices) -> Values:
    """A channel in the rows that are kept, between its own readings where those come in others. Shape (n_kept,)."""
    held = _typical_hold(values)
    if held is None:
        return np.asarray(values[kept])
    rows = _list_readings(values, max(round(held), 1))
    time = np.asarray(recording.time)
    return np.asarray(np.interp(time[kept], time[rows], values[rows]))


def _find_new(values: Values) -> Rows:
    return np.concatenate([[True], np.diff(values) != 0.0])


def _typical_hold(values: Values) -> float | None:
    """Rows that a reading lasts where it changes fast; None where readings do not last longer than a row."""
    rows = np.flatnonzero(_find_new(values))
    if rows.size < 50:
        return None
    step = np.abs(np.diff(values[rows]))
    moving = step > 0.0
    if not moving.any():
        return None
    least = float(np.quantile(step[moving], 0.02))
    fast = step >= max(_FAST * least, float(np.quantile(step[moving], 0.5)))
    lasted = np.diff(rows)[fast]
    if lasted.size < 20:
        return None
    repeated = 1.0 - lasted.size / float(np.sum(lasted))
    held = float(np.median(lasted))
    return held if repeated > _HELD and held >= 1.5 else None

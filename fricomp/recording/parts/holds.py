"""Rows that repeat the one before: a log that is written faster than its drive answers has a lower true rate."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.recording import Recording

__all__ = ["Hold", "thin_held_rows"]

Rows = NDArray[np.bool_]

_FAST = 3.0
"""Usual steps of position from one new value to the next that make a motion fast: each new reading differs then."""
_HELD = 0.3
"""Part of the rows in fast motion that repeat the one before, above which rows are held."""


_LONGEST = 0.15
"""Time that a reading may last [s]: no drive answers more slowly, and a joint that is moved in steps looks alike."""


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
    motion.
    """
    new = np.concatenate([[True], np.diff(recording.position) != 0.0])
    held = _typical_hold(recording, new)
    if held is None or held * recording.sample_period > _LONGEST:
        return recording, None
    rows = np.flatnonzero(new)
    kept: list[int] = []
    spacing = max(round(held), 1)
    for row, following in zip(rows, [*rows[1:], len(recording)], strict=True):
        kept += range(int(row), int(following), spacing) if following - row > 2 * spacing else [int(row)]
    return recording.rows(np.array(kept, dtype=np.intp)), Hold(held, len(recording) - len(kept))


def _typical_hold(recording: Recording, new: Rows) -> float | None:
    """Rows that a reading lasts in fast motion; None where readings do not last longer than a row."""
    rows = np.flatnonzero(new)
    if rows.size < 50:
        return None
    step = np.abs(np.diff(recording.position[rows]))
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

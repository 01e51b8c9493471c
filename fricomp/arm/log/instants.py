"""When the rows of a log were sampled, by positions and velocities: a controller's states that another clock reads.

A robot's state comes in even periods; a logger that reads it when it can writes some states twice, misses others, and
stamps all by its own clock. How far the joints came between two rows, over how fast they were, says how many periods
lie between:

    n = round(Σ_j v_j δq_j / (T Σ_j v_j²))

Stamps that are off by a tenth of a period would count as acceleration noise in every joint at once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording

__all__ = ["place_rows"]


@dataclass(frozen=True)
class InstantSettings:
    """From when on positions and velocities are believed rather than stamps.

    Attributes:
        moving: Part of the usual squared speed below which a row says nothing of its time.
        whole: Part of a period by which a time between two rows may miss a whole number of them.
        sure: Part of the moving rows that must be such.
        error: Part of a period by which stamps miss these instants, below which they stay.
        drift: Part of the time by which both may differ on the whole.
        most: Periods between two rows; more are a gap, whose stamps are believed.
    """

    moving: float = 0.05
    whole: float = 0.25
    sure: float = 0.95
    error: float = 0.1
    drift: float = 0.01
    most: int = 20


INSTANTS = InstantSettings()


def place_rows(recordings: Sequence[Recording]) -> Sequence[Recording]:
    """The recordings with the instants of their samples as stamps, and without rows that repeat one.

    They are the same object where a joint's velocity was not recorded, rows are not of one log, or stamps are right.

    Args:
        recordings: Of all joints.
    """
    time = np.asarray(recordings[0].time)
    one_log = all(one.velocity is not None and np.array_equal(one.time, time) for one in recordings)
    counts = _count_periods(recordings, time) if one_log else None
    if counts is None:
        return recordings
    number = np.concatenate([[0.0], np.cumsum(counts)])
    period, start = np.polyfit(number, time - time[0], 1)
    instants = time[0] + start + period * number
    if float(np.std(time - instants)) < INSTANTS.error * period:
        return recordings
    kept = np.flatnonzero(np.concatenate([[True], counts > 0.0]))
    return [one.rows(kept).with_channels(time=instants[kept]) for one in recordings]


def _count_periods(recordings: Sequence[Recording], time: FloatArray) -> FloatArray | None:
    """Periods between rows; None where positions and velocities do not tell. Shape (n - 1,)."""
    steps = np.diff(time)
    period = float(np.median(steps))
    position = np.stack([np.asarray(one.position) for one in recordings], axis=1)
    velocity = np.stack([np.asarray(one.velocity) for one in recordings], axis=1)
    middle = 0.5 * (velocity[1:] + velocity[:-1])
    squares = np.sum(middle**2, axis=1)
    moves = squares > INSTANTS.moving * float(np.mean(squares))
    if not np.any(moves):
        return None
    way = np.sum(middle * np.diff(position, axis=0), axis=1) / np.maximum(squares, 1e-300) / period
    whole = np.abs(way - np.round(way)) < INSTANTS.whole
    stamped = steps / period
    near = moves & whole & (np.round(way) >= 0.0) & (stamped < INSTANTS.most)
    if float(np.mean(whole[moves])) < INSTANTS.sure or np.ptp(np.round(way[near])) == 0.0:
        return None
    counts = np.asarray(np.where(near, np.round(way), np.round(stamped)), dtype=np.float64)
    total = float(np.sum(counts)) * period
    return counts if abs(total - float(time[-1] - time[0])) < INSTANTS.drift * total else None

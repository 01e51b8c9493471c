"""Rows that come in bursts: sampled evenly, sent several at a time, and stamped when they arrive."""

from typing import NamedTuple

import numpy as np

from fricomp.recording.clock import mend_clock
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_LONGER = 3.0
"""Step between two bursts over one within them, from which on they are bursts."""
_BEYOND = 1.25
"""Step over the mean one, from which on it lies between two bursts: those within are shorter, however uneven."""
_ROWS = 50
"""Rows over which the mean step is taken: the longest burst."""
_LEAST, _MOST = 0.02, 0.5
"""Part of the steps that lie between bursts, of 50 rows down to two."""
_REGULAR = 0.9
"""Part of the bursts that have the usual number of rows: what a bus sends is as long each time."""
_AS_FAR = 1.5
"""Way over a step between bursts in that over one within them, up to which rows were sampled evenly."""


class Bursts(NamedTuple):
    """How rows arrived.

    Attributes:
        rows: In a burst.
        every: Time from one to the next [s].
    """

    rows: int
    every: float

    @property
    def sentence(self) -> str:
        """For people."""
        return (
            f"Clock: rows come {self.rows} at a time every {1e3 * self.every:.4g} ms, and the joint moves as far from "
            f"one burst to the next as from row to row within: they were sampled at {self.rows / self.every:.5g} Hz "
            "and stamped when they arrived; the stamps were spread."
        )


def spread_bursts(recording: Recording) -> tuple[Recording, Bursts | None]:
    """The recording with the rows of each burst one period apart, the last one where it is; as it is without bursts.

    Rows that were taken in bursts stay: there the joint moves further from one burst to the next.
    """
    time = np.asarray(recording.time)
    step = np.diff(time)
    between = step > _BEYOND * _measure_period(time)
    if not np.any(between) or np.median(step[between]) < _LONGER * np.median(step[~between]):
        return recording, None
    starts = np.concatenate([[0], np.flatnonzero(between) + 1])
    bursts = _describe(time, starts) if _LEAST <= float(between.mean()) <= _MOST else None
    way = np.abs(np.diff(recording.position))
    if bursts is None or float(way[between].mean()) > _AS_FAR * float(way[~between].mean()):
        return recording, None
    row = np.arange(time.size)
    own = np.searchsorted(starts, row, side="right") - 1
    ends = np.append(starts[1:], time.size) - 1
    arrivals, clock = mend_clock(recording.rows(ends))  # a burst comes late as a whole
    spread = np.asarray(arrivals.time)[own] - bursts.every / bursts.rows * (ends[own] - row)
    if np.any(np.diff(spread) <= 0.0):
        return recording, None
    found = recording.with_channels(time=spread)
    return (found.with_metadata(clock_error=clock.error) if clock.mended else found), bursts


def _measure_period(time: Samples) -> float:
    """Time from row to row on the mean, which gaps do not change [s]."""
    rows = min(_ROWS, time.size - 1)
    return float(np.median(time[rows:] - time[:-rows])) / rows if rows > 0 else 0.0


def _describe(time: Samples, starts: np.ndarray[tuple[int], np.dtype[np.intp]]) -> Bursts | None:
    """What the bursts are like that begin at these rows; None where they are not alike."""
    sizes = np.diff(starts)
    usual = int(np.median(sizes))
    if usual < 2 or float(np.mean(sizes == usual)) < _REGULAR:
        return None
    return Bursts(usual, float(np.median(np.diff(time[starts]))))

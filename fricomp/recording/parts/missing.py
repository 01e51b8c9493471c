"""Rows that are missing though the stamps go on evenly: they were numbered as they were written.

The way of a joint tells: over a missing row it is twice as long as beside it, over two three times, and never half as
long again. That shows where a period's way is clear of the encoder's steps; where it is not, a missing row moves the
joint by less than such a step.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter, uniform_filter1d

from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_EVEN = 2e-3
"""Part of a period by which steps of time may differ: those of numbered rows differ by the digits of the stamps."""
_AROUND = (21, 7)
"""Rows whose mean way is that of one period: over the more the steps of an encoder count least, and a motion that bends
within them shows nothing, where the fewer may."""
_QUANTILE = 0.99
"""Of what ways are off those around them, where no row is missing: nearly all that an encoder does."""
_CLEAR = 3.0
"""Way of a period over that deviation, from which on it is clear."""
_NEARLY_ALL = 0.9
"""Part of the rows at which a missing one shows, from which on few can be missing unseen."""
_FEWEST = 8
"""Places at which rows are missing, below which nothing is said: one or two are knocks."""
_WHOLE = 0.18
"""What ways are off a whole number of periods in the mean, up to which they are so. Any others would be so by 0.25."""
_MOST_SHORT = 0.3
"""Ways of less than half a period, over those of more than one and a half, from which on the motion is uneven."""


class MissingRows(NamedTuple):
    """What is missing.

    Attributes:
        rows: That are missing.
        places: At which they are.
        period: Time between rows [s].
        seen: Part of the rows at which the joint moves fast enough for its encoder to show a missing one.
    """

    rows: int
    places: int
    period: float
    seen: float = 1.0

    @property
    def sentence(self) -> str:
        """For people."""
        return (
            f"Clock: {self.rows} rows are missing at {self.places} places, where the joint moves on by two or more of "
            f"its steps while the stamps go on by one of {1e3 * self.period:.4g} ms, as rows do that are numbered when "
            f"they are written; that time was put in. {self._unseen}Log the time of the device, where there is one."
        )

    @property
    def _unseen(self) -> str:
        if self.seen > _NEARLY_ALL:
            return ""
        left = self.rows * (1.0 / self.seen - 1.0)
        return (
            f"At {100 * (1 - self.seen):.0f} % of the rows the joint moves too slowly for its encoder to show one: "
            f"some {left:.0f} more may be missing, and what a diagnosis finds that nothing explains may be these. "
        )


def count_missing_rows(recording: Recording) -> tuple[Recording, MissingRows | None]:
    """The recording with the time of rows that are missing put in; as it is where none are, or the stamps tell them."""
    time = np.asarray(recording.time)
    step = np.diff(time)
    period = float(np.median(step))
    if np.max(np.abs(step - period)) > _EVEN * period + 4.0 * np.spacing(np.max(np.abs(time))):
        return recording, None
    way = np.diff(recording.position)
    counted = next((one for one in (_count(way, rows) for rows in _AROUND) if one is not None), None)
    if counted is None:
        return recording, None
    missing, clear = counted
    numbers = np.arange(time.size) + np.concatenate([[0.0], np.cumsum(missing)])
    found = MissingRows(int(missing.sum()), int(np.count_nonzero(missing)), period, float(np.mean(clear)))
    return recording.with_channels(time=time[0] + period * numbers), found


def _count(way: Samples, rows: int) -> tuple[Samples, NDArray[np.bool_]] | None:
    """How many rows are missing before each but the first, and where one would show; None where it is not rows that
    are missing. Shapes (n,).

    Args:
        way: From row to row. Shape (n,).
        rows: Around each, whose mean way is that of one period.
    """
    middle = median_filter(way, rows, mode="reflect")
    moved = np.abs(way[way != 0.0])
    step = float(np.quantile(moved, 1.0 - _QUANTILE)) if moved.size else 0.0
    near = np.abs(way - middle) <= 0.5 * np.abs(middle) + step
    pace = uniform_filter1d(np.where(near, way, middle), rows, mode="reflect")
    usual = float(np.quantile(np.abs(way - pace)[near], _QUANTILE)) if near.any() else np.inf
    clear = np.abs(pace) > max(_CLEAR * usual, 1e-300)
    ratio = np.divide(way, pace, out=np.ones(way.size), where=clear)
    long, periods = ratio > 1.5, np.round(ratio)
    count = int(np.count_nonzero(long))
    if count < _FEWEST or np.count_nonzero(ratio < 0.5) > _MOST_SHORT * count:
        return None
    if float(np.mean(np.abs(ratio - periods)[long])) > _WHOLE:
        return None
    return np.where(long, periods - 1.0, 0.0), clear

"""Stamps that are held over several rows, and which rows have a time that goes on."""

from bisect import bisect_left
from collections.abc import Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.finding import Finding

Samples = NDArray[np.float64]

_GAP = 5.0
"""Usual distances of two different stamps beyond which rows are missing between them."""
_FAR = 1000.0
"""Usual steps that part a corrupt stamp from all others."""
_HELD = 0.2
"""Part of the rows with the stamp of the one before, from which on a clock is coarser than they are."""
_AS_FAR = 1.25
"""Way between rows of two stamps in that between rows of one, or the other way round, up to which they were even."""
_FEWEST_STAMPS = 50
"""Different stamps from which on they tell the rate of the rows: of so many, to 0.3 %."""
_HELD_OFF = 1.5
"""Steps of such a clock that a row may be off its place among even ones; where rows are missing it is further off."""
_FEW = 0.01
"""Part of the rows that a stretch of time needs, to be no corruption."""


def spread_stamps(time: Samples) -> Samples:
    """Even stamps for rows that share one, each stretch between gaps on its own [s]. Shape (n,)."""
    new = np.flatnonzero(np.concatenate([[True], np.diff(time) != 0.0]))
    step = np.diff(time[new])
    if step.size < 2:
        return time
    cuts = new[1:][step > _GAP * float(np.median(step))]
    spread = np.array(time)
    for a, b in pairwise([0, *cuts.tolist(), time.size]):
        row = np.arange(a, b)
        if b - a > 2 and time[b - 1] > time[a]:
            slope, start = np.polyfit(row - a, time[a:b], 1)
            spread[a:b] = start + slope * (row - a)
    return spread


def spread_held(channels: Mapping[str, Samples]) -> tuple[dict[str, Samples], tuple[Finding, ...]]:
    """The channels with even stamps where several rows share one though the joint moves on as far within as between.

    Rows that were held with their stamp, or taken at uneven instants, stay as they are.

    Args:
        channels: By name; `time` [s] and `position` among them. Shape (n_samples,) each.
    """
    time, position = channels["time"], channels["position"]
    same = np.diff(time) == 0.0
    is_told = np.count_nonzero(same) > _HELD * same.size and np.count_nonzero(~same) >= _FEWEST_STAMPS
    if not is_told or np.any(np.diff(time) < 0.0) or not np.isfinite(time).all():
        return dict(channels), ()
    way = np.abs(np.diff(position))
    within, between = float(np.nanmean(way[same])), float(np.nanmean(way[~same]))
    spread = spread_stamps(time)
    step = float(np.median(np.diff(time)[~same]))
    off = float(np.max(np.abs(spread - time - np.median(spread - time))))
    if (
        not max(within, between) < _AS_FAR * min(within, between)
        or off > _HELD_OFF * step
        or np.any(np.diff(spread) <= 0.0)
    ):
        return dict(channels), ()
    message = (
        f"{np.count_nonzero(same)} of {time.size} rows are stamped as the one before, and the joint moves on between "
        f"them as evenly as from stamp to stamp: they were spread, at {1.0 / float(np.median(np.diff(spread))):.5g} Hz"
    )
    return {**channels, "time": spread}, (Finding("held_stamps", "note", message, "nothing to do", column="time"),)


def with_row_rate(columns: dict[str, Samples], rate: float | None) -> dict[str, Samples]:
    """The columns with a time of so many rows a second [Hz]; as they are where no rate is given."""
    if rate is None:
        return columns
    rows = max((values.size for values in columns.values()), default=0)
    return {**columns, "time": np.arange(rows) / rate}


def find_row_rate(time: Samples) -> float | None:
    """Rows a second where several rows share each stamp [Hz]; None where that does not show."""
    new = np.flatnonzero(np.diff(time) != 0.0) + 1  # the first stamp may have been there before the first row
    if new.size < 2:
        return None
    first, last = new[0], new[-1]
    span = float(time[last] - time[first])
    rate = float(last - first) / span if span > 0.0 and np.isfinite(span) else 0.0
    if rate <= 0.0 or not np.isfinite(rate) or np.any(np.diff(time) < 0.0):
        return None
    exact = round(rate / 10.0) * 10.0
    return exact if exact > 0.0 and abs(rate / exact - 1.0) < 0.02 else rate


def find_rising(time: Samples) -> NDArray[np.bool_]:
    """The most rows whose time rises from one to the next, without stamps far from all others. Shape (n,)."""
    everywhere = np.ones(time.size, dtype=bool)
    rising = everywhere if np.all(np.diff(time) > 0.0) else _longest_rise(time, everywhere)
    rows = np.flatnonzero(rising)
    step = np.diff(time[rows])
    if rows.size < 10 or np.max(step) <= _FAR * np.min(step):  # which spares even clocks the median
        return rising
    usual = float(np.median(step))
    if not np.any(step > _FAR * usual):
        return rising
    edges = [0, *(np.flatnonzero(step > _FAR * usual) + 1).tolist(), rows.size]
    stretches = [rows[a:b] for a, b in pairwise(edges) if b - a >= max(5.0, _FEW * rows.size)]
    if not stretches:
        return rising
    low = float(time[stretches[0][0]]) - _FAR * usual
    high = float(time[stretches[-1][-1]]) + _FAR * usual
    return _longest_rise(time, (time >= low) & (time <= high))


def _longest_rise(time: Samples, among: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Rows of the longest strictly rising sequence among some, by patience sorting. Shape (n,)."""
    rows = np.flatnonzero(among).tolist()
    tails: list[float] = []
    last: list[int] = []
    before = np.full(time.size, -1)
    for row in rows:
        stamp = float(time[row])
        at = bisect_left(tails, stamp)
        if at < len(tails) and tails[at] == stamp:
            continue  # of rows with one stamp the first stays
        before[row] = last[at - 1] if at else -1
        if at == len(tails):
            tails.append(stamp)
            last.append(row)
        else:
            tails[at], last[at] = stamp, row
    keep = np.zeros(time.size, dtype=bool)
    row = last[-1] if last else -1
    while row >= 0:
        keep[row] = True
        row = int(before[row])
    times = np.where(among, time, -np.inf)
    later = among & (time > np.maximum.accumulate(np.concatenate([[-np.inf], times[:-1]])))
    return later if np.count_nonzero(later) >= np.count_nonzero(keep) else keep  # of two such the earlier rows

"""The clock of a recording: how far its stamps are from the instants of the samples, and stamps without that error.

Most logs are taken at even intervals and stamped late, coarsely or both. A grid is laid through the stamps of each
part between gaps; what the stamps are off it is either their error or a true unevenness of the samples. The position
tells: where the stamps are right, a joint that moves is further by its speed times what the stamp is late.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fricomp.recording.checks.timing_checks import GAP_PERIODS, find_gap_length
from fricomp.recording.recording import Recording
from fricomp.recording.row_numbers import RowNumbers, count_rows
from fricomp.recording.validity import Samples

_FEWEST = 50
"""Rows of a part below which it does not tell its period."""
_EXACT = 2e-3
"""Deviation from the grid that is not worth a new stamp, in periods."""
_USUAL = 1.6
"""Steps up to so many medians are steps of one period: stamps in milliseconds at 400 Hz are 2 and 3 ms apart, and 5 ms
where a row is missing."""
_SCATTER = 0.55
"""Standard deviation from the grid above which a part has no grid, in periods: stamps at random instants are
further off."""
_WANDER = 1.0
"""Deviation from the grid over that of neighbouring steps, above which the clock wanders. White errors have 0.71."""
_WANDER_ROWS = 100
"""Rows to either side whose mean tells where a clock that wanders is: errors of single stamps are then a fourteenth."""
_MOST_BENT = 0.1
"""Part of a period by which the grid may change from row to row; two rates in turns differ by more."""
_STEADY = 0.02
"""Deviation of all steps from whole periods, in periods, up to which they count the rows by themselves, whatever the
clock's rate does."""
_GUESSED, _GUESSED_WELL = 10, 200
"""Stamps that tell a period as well as a guess: one by steps of which one in twenty is two periods, and a right one."""
_SURE = 0.2
"""Standard deviation of the share of the deviation that is true, below which the position has told it."""
_SMOOTH = 5
"""Rows whose line is taken off position and stamps when both are compared. Odd."""
_TICKS = (1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)
"""Steps that stamps are rounded to [s]."""


@dataclass(frozen=True)
class Clock:
    """What the stamps of a recording are worth.

    Attributes:
        period: Time between the samples [s].
        error: Standard deviation of the stamps that were given from the instants of the samples [s].
        tick: What the stamps are rounded to [s]; 0 where that does not show.
        mended: Whether the stamps were replaced.
    """

    period: float
    error: float
    tick: float
    mended: bool

    @property
    def sentence(self) -> str:
        """For people; empty where the stamps are as good as even."""
        if not self.mended:
            return ""
        why = f"in steps of {1e3 * self.tick:.4g} ms" if self.tick > 0.0 else "uneven"
        return (
            f"Clock: the stamps are {why}, {1e6 * self.error:.3g} µs (standard deviation) off the instants of the "
            f"samples, which come at {1.0 / self.period:.5g} Hz; the stamps were made even, and the error is counted."
        )


def mend_clock(recording: Recording) -> tuple[Recording, Clock]:
    """Return the recording with stamps as even as its samples are, and what its clock is worth.

    Stamps that are right, however uneven, stay as they are.
    """
    time = np.asarray(recording.time)
    period = _period(np.diff(time), _find_tick(time))
    cuts = np.flatnonzero(np.diff(time) > max(find_gap_length(recording), GAP_PERIODS * period)) + 1
    spans = list(pairwise([0, *cuts.tolist(), time.size]))
    grids = _lay_grids(time, np.asarray(recording.position), spans, period)
    off = np.concatenate([time[a:b] - grid for (a, b), grid in zip(spans, grids, strict=True)])
    size = float(np.std(off))
    tick = _find_tick(time)
    if size <= _EXACT * period:
        return recording, Clock(recording.sample_period, 0.0, tick if tick > _EXACT * period else 0.0, mended=False)
    share = 0.0 if np.max(np.abs(off)) <= 0.75 * tick else _true_share(recording, off, spans)
    mended = np.concatenate(grids) + share * off
    if share > 1.0 - _SURE or np.any(np.diff(mended) <= 0.0):
        return recording, Clock(recording.sample_period, 0.0, tick if tick > _EXACT * period else 0.0, mended=False)
    error = float(np.sqrt(1.0 - share) * size)
    clock = Clock(float(np.median(np.diff(mended))), error, tick if tick > 0.25 * size else 0.0, mended=True)
    return recording.with_channels(time=mended).with_metadata(clock_error=error), clock


def _period(step: Samples, tick: float) -> float:
    """Mean of the usual steps of time [s]: stamps in milliseconds have a median that no sample has.

    Where a row is missing the step is twice as long; it must not count, or rows are counted wrongly all along. Nor must
    steps that are as much too short, or the mean of stamps that jitter would lean to one side.
    """
    middle = float(np.median(step))
    usual = np.abs(step - middle) < max((_USUAL - 1.0) * middle, 1.01 * tick)
    return float(np.mean(step[usual]))


def _lay_grids(time: Samples, position: Samples, spans: Sequence[tuple[int, int]], period: float) -> list[Samples]:
    """Even instants for the stamps of each part; the longest tells the period best, and the others begin with its."""
    grids = [time[a:b] for a, b in spans]
    told_by = 0
    for k in sorted(range(len(spans)), key=lambda k: -grids[k].size):
        a, b = spans[k]
        if b - a >= _FEWEST:
            grids[k] = _lay_grid(time[a:b], position[a:b], period, told_by)
            if told_by == 0 and not np.array_equal(grids[k], time[a:b]):
                period, told_by = float(np.median(np.diff(grids[k]))), b - a
        elif told_by and b - a > 1:
            count = _count_periods(time[a:b], position[a:b], period, _number_rows(b - a), told_by).numbers
            grids[k] = period * (count - count.mean()) + time[a:b].mean()
    return grids


def _lay_grid(time: Samples, position: Samples, period: float, told_by: int) -> Samples:
    """Even instants for the stamps of a part, in which rows may be missing; the stamps where they are not even."""
    fits = [_fit_line(time, _number_rows(time.size)), _fit_grid(time, position, period, told_by)]
    # A row that is counted wrongly puts all that follow a period off the grid: what is least off is right.
    grid, slope = min(fits, key=lambda fit: float(np.std(time - fit[0])))
    if slope <= 0.0:
        return time
    off = time - grid
    rounded = float(np.max(np.abs(off))) <= 0.75 * _find_tick(time) and float(np.std(off)) <= _SCATTER * slope
    if rounded or _errs_alone(off, slope):
        return grid
    bent = grid + _follow_wander(off)
    follows = float(np.max(np.abs(np.diff(bent - grid)))) < _MOST_BENT * slope
    return bent if follows and _errs_alone(time - bent, slope) else time


def _fit_grid(time: Samples, position: Samples, period: float, told_by: int) -> tuple[Samples, float]:
    """Even instants by numbers of the rows, and their period [s]; it is known better with each fit, and with it which
    rows are missing.

    Args:
        time: Stamps [s]. Shape (n,).
        position: [rad] or [m]. Shape (n,).
        period: About that of the rows [s].
        told_by: Stamps that told it; 0 where it is a guess.
    """
    nothing = _number_rows(time.size)
    guesses = (told_by,) if told_by else (_GUESSED, _GUESSED_WELL)
    count, _ = min((_count_periods(time, position, period, nothing, one) for one in guesses), key=lambda one: one.cost)
    for _ in range(2):
        _, slope = _fit_line(time, count)
        if slope <= 0.0:
            break
        better = _count_periods(time, position, slope, count, time.size).numbers
        if np.array_equal(better, count):
            break
        count = better
    return _fit_line(time, count)


def _fit_line(time: Samples, count: Samples) -> tuple[Samples, float]:
    """Even instants by numbers of the rows, and their period [s]."""
    slope, start = (float(one) for one in np.polyfit(count, time - time[0], 1))
    return np.asarray(time[0] + start + slope * count, dtype=np.float64), slope


def _errs_alone(off: Samples, period: float) -> bool:
    """Whether stamps are off a grid each by itself, and by less than lets rows change places."""
    scatter, steps = float(np.std(off)), float(np.std(np.diff(off)))
    return scatter <= _SCATTER * period and scatter <= _WANDER * steps


def _follow_wander(off: Samples) -> Samples:
    """What stamps are off a straight grid as a mean of their neighbours: a clock of a changing rate. Shape (n,).

    At the ends the mean goes over fewer, of as many on either side.
    """
    total = np.concatenate([[0.0], np.cumsum(off)])
    row = np.arange(off.size)
    reach = np.minimum(np.minimum(row, off.size - 1 - row), _WANDER_ROWS)
    return np.asarray((total[row + reach + 1] - total[row - reach]) / (2 * reach + 1), dtype=np.float64)


def _count_periods(time: Samples, position: Samples, period: float, known: Samples, told_by: int) -> RowNumbers:
    """Number of each sample on its grid, in which rows may be missing."""
    periods = np.diff(time) / period
    steps = np.round(periods)
    if steps.min() >= 1.0 and np.max(np.abs(periods - steps)) < _STEADY:
        return RowNumbers(np.concatenate([known[:1], known[0] + np.cumsum(steps)]), 0.0)
    return count_rows(time, position, period, known, told_by)


def _number_rows(size: int) -> Samples:
    """Numbers of rows none of which is missing. Shape (size,)."""
    return np.arange(size, dtype=np.float64)


def _find_tick(time: Samples) -> float:
    """The decimal step that all stamps are multiples of [s]; 0 where there is none of a hundredth of a period."""
    period = float(np.median(np.diff(time)))
    from_first = time - time[0]
    for tick in _TICKS:
        if 0.01 * period < tick < 5.0 * period:
            steps = from_first / tick
            if float(np.max(np.abs(steps - np.round(steps)))) < 1e-3 + 1e-12 * float(np.max(np.abs(time))) / tick:
                return tick
    return 0.0


def _true_share(recording: Recording, off: Samples, spans: list[tuple[int, int]]) -> float:
    """Share of the deviation from the grid that the samples have themselves, by how far the joint has come.

    0 where the position does not tell: an error that moves the joint by less than its noise does no harm.
    """
    position = np.asarray(recording.position)
    left: list[Samples] = []
    claimed: list[Samples] = []
    for a, b in spans:
        if b - a < _FEWEST:
            continue
        speed = np.gradient(position[a:b]) / max(float(np.median(np.diff(recording.time[a:b]))), 1e-300)
        speed = np.convolve(speed, np.full(_SMOOTH, 1.0 / _SMOOTH), mode="same")
        left.append(_roughness(position[a:b]))
        claimed.append(_roughness(speed * off[a:b]))
    if not left:
        return 0.0
    rough, model = np.concatenate(left), np.concatenate(claimed)
    calm = np.abs(rough) <= 6.0 * np.median(np.abs(rough)) + 1e-300  # reversals and knocks are no stamps
    rough, model = rough[calm], model[calm]
    energy = float(model @ model)
    if energy <= 0.0:
        return 0.0
    share = float(rough @ model) / energy
    deviation = float(np.std(rough - share * model)) / np.sqrt(energy)
    return float(np.clip(share, 0.0, 1.0)) if deviation < _SURE else 0.0


def _roughness(values: Samples) -> Samples:
    """Fourth differences: what is left of a smooth motion is next to nothing. Shape (n - 4,)."""
    return np.diff(values, 4)

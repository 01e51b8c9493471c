"""Checks of the clock: gaps, jitter, a rate that changes, a rate that is too low, other units of time."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.finding import Finding
from fricomp.recording.recording import Recording

_NEARLY = 0.99  # part of a rate at which a clock that is slightly off still has it
LOWEST_RATE = 50.0
"""Rate below which breakaway and reversals fall between the samples [Hz]; they last some 20 ms."""

GAP_PERIODS = 5.0
"""A step of time longer than this many periods is a gap."""
_RHYTHM = 2.0
"""Times the longest of a hundred steps that make a gap where steps scatter."""
_LONGEST_RHYTHM = 10.0
"""Periods that are a gap all the same: pauses between short bursts of rows are not their rhythm."""

_JITTER_NOTED, _JITTER_WARNED = 0.1, 0.5  # 99th percentile of the deviation, in periods
_RATE_CHANGE = 1.25
_MIXED = 0.5  # part of the blocks that have steps of both lengths, above which the rate does not change but varies
_SLOWEST_PERIOD = 0.5  # [s] no joint is logged slower; milliseconds or sample numbers are


class RateChange(NamedTuple):
    """Two rates in one recording.

    Attributes:
        slow: [Hz]
        fast: [Hz]
        row: First row of the other rate, counted from 1; None where that cannot be told.
        mixed: Whether steps of both lengths come in turns.
    """

    slow: float
    fast: float
    row: int | None
    mixed: bool


def find_wrong_time_unit(recording: Recording) -> tuple[Finding, ...]:
    """A period of half a second or more is a clock in milliseconds, or no clock."""
    period = recording.sample_period
    if period < _SLOWEST_PERIOD:
        return ()
    message = f"the median step of time is {period:g} s: this looks like milliseconds or sample numbers"
    advice = (
        "give time in seconds, call the column time_ms where it is in milliseconds, or say how many rows come a second "
        "by 'fricomp convert LOG --row-rate 500 --out joint.csv'"
    )
    return (Finding("time_unit", "error", message, advice, column="time"),)


def find_low_rate(recording: Recording) -> tuple[Finding, ...]:
    """Friction at reversals needs some samples in 20 ms."""
    rate = 1 / recording.sample_period
    if rate >= _NEARLY * LOWEST_RATE or recording.sample_period >= _SLOWEST_PERIOD:
        return ()
    message = f"{rate:.3g} samples a second are too few for breakaway and reversals (at least {LOWEST_RATE:g})"
    return (Finding("low_rate", "warning", message, "record faster; only slow sliding can be judged", column="time"),)


def locate_gaps(recording: Recording, at_least: float = 0.0) -> NDArray[np.intp]:
    """Rows before each step of time that is a gap, and longer than `at_least` [s]. Shape (n_gaps,)."""
    return np.flatnonzero(np.diff(recording.time) > max(find_gap_length(recording), at_least))


def find_gap_length(recording: Recording) -> float:
    """Step of time above which rows are missing [s].

    A bus that answers when it can has some steps of five periods, which are its rhythm and no gaps.
    """
    step = np.diff(recording.time)
    period = recording.sample_period
    rhythm = min(_RHYTHM * float(np.quantile(step, 0.99)), _LONGEST_RHYTHM * period)
    return max(GAP_PERIODS * period, rhythm)


def find_gaps(recording: Recording) -> tuple[Finding, ...]:
    """Steps of time in which rows are missing."""
    step = np.diff(recording.time)
    gaps = locate_gaps(recording)
    if not gaps.size:
        return ()
    longest = gaps[np.argmax(step[gaps])]
    message = f"{gaps.size} gap(s) in time, the longest {step[longest]:.4g} s at {recording.time[longest]:.6g} s"
    return (
        Finding("gap", "warning", message, "identify and diagnose cut there by themselves", int(longest) + 2, "time"),
    )


def find_jitter(recording: Recording) -> tuple[Finding, ...]:
    """Uneven steps; filters and differences that assume a fixed period go wrong.

    A step of several periods is a gap of missing rows, not jitter.
    """
    period = recording.sample_period
    periods = np.diff(recording.time) / period
    deviation = np.abs(periods - np.maximum(np.round(periods), 1.0))
    jitter = float(np.percentile(deviation, 99))
    if jitter <= _JITTER_NOTED:
        return ()
    message = f"time is uneven: 1 % of the steps differ from {period:.4g} s by {100 * jitter:.0f} % or more"
    advice = "resample it (fricomp convert with resample_rate) before filtering"
    return (Finding("jitter", "warning" if jitter > _JITTER_WARNED else "note", message, advice, column="time"),)


def find_rate_change(recording: Recording) -> tuple[Finding, ...]:
    """A rate that is one thing in one part of the recording and another in the next, or in turns."""
    change = locate_rate_change(recording)
    if change is None:
        return ()
    message = f"two sample rates: {change.slow:.4g} Hz and {change.fast:.4g} Hz"
    if change.mixed:
        advice = "samples are taken between them as they come; resample for filters of your own"
        return (Finding("two_rates", "warning", f"{message}, in turns", advice, change.row, "time"),)
    return (Finding("two_rates", "error", message, "split the recording there, or resample it", change.row, "time"),)


def locate_rate_change(recording: Recording) -> RateChange | None:
    """The two rates of a recording; None where it has one."""
    step = np.diff(recording.time)
    if step.size < 200:
        return None
    blocks = np.array_split(step, 40)
    periods = np.array([np.median(block) for block in blocks])
    low, high = np.percentile(periods, [5, 95])
    if high < _RATE_CHANGE * low:
        return None
    fast = periods < np.sqrt(low * high)
    other = np.flatnonzero(fast != fast[0])
    row = sum(block.size for block in blocks[: int(other[0])]) + 2 if other.size else None
    both = [np.any(block < 1.1 * low) and np.any(block > 0.9 * high) for block in blocks]
    mixed = float(np.mean(both)) > _MIXED
    return RateChange(float(1.0 / high), float(1.0 / low), row, mixed)

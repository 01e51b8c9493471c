"""What a channel can show at all: the step of its values, and what it reads while the joint rests."""

from typing import NamedTuple

import numpy as np

from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_MOST_LEVELS = 0.5
"""Different values over rows, above which a channel is not quantised as far as it shows."""
_WHOLE = 0.05
"""Deviation of the distances between values from whole steps, in steps, up to which they are whole."""
_REST_ROWS = 5
"""Rows without a change of position that count as rest."""

TURN_IN_DEGREES = 360.0
"""Range of a position that can only be in degrees: nobody counts to 57.3 turns."""
ONE_TURN = 1.0
"""Range of a position that can only be in turns."""
_KNOWN_PERIODS = (
    2.0 * np.pi,
    4.0 * np.pi,
    np.pi,
    8.0 * np.pi,
    25.0,
    ONE_TURN,
    TURN_IN_DEGREES,
    4096.0,
    16384.0,
    65536.0,
)
"""Ranges of counters in use: turns, the position of MIT mode (±12.5 rad), counts."""
_NEAR = 0.01
"""Relative distance within which a range that was measured is a known one."""


class Reading(NamedTuple):
    """What a velocity column reads at rest.

    Attributes:
        bias: Median [rad/s] or [m/s].
        width: Largest deviation from it, or the quantum where that is more [rad/s] or [m/s].
    """

    bias: float
    width: float


def measure_quantum(values: Samples, most_levels: float = _MOST_LEVELS) -> float:
    """The step that the distances between the values of a channel are multiples of; 0 where none shows.

    Args:
        values: Shape (n_rows,).
        most_levels: Different values over rows, above which it is not looked for.
    """
    levels = np.unique(values)
    if levels.size < 2 or levels.size > most_levels * values.size:
        return 0.0
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * max(float(np.abs(levels).max()), 1e-300)]
    if gaps.size == 0:
        return 0.0
    least = float(np.quantile(gaps, 0.02))
    near = gaps[gaps < 1.5 * least]
    step = float(np.median(near))
    for reach in (3.5, 30.5):  # wider gaps tell the step better, once they can be counted
        small = gaps[gaps < reach * step]
        step = float(np.sum(small) / np.sum(np.maximum(np.round(small / step), 1.0)))
    small = gaps[gaps < 30.5 * step]
    whole = np.abs(small / step - np.round(small / step)) < _WHOLE
    return step if float(whole.mean()) > 0.95 else 0.0


def read_at_rest(recording: Recording) -> Reading:
    """What the velocity column reads where the position does not change; a code without a zero reads half a step."""
    velocity = recording.velocity
    if velocity is None or velocity.size < _REST_ROWS:
        return Reading(0.0, 0.0)
    quantum = measure_quantum(np.asarray(velocity))
    still = np.concatenate([[False], np.diff(recording.position) == 0.0])
    run = np.convolve(still, np.ones(_REST_ROWS), mode="same") >= _REST_ROWS
    slow = run & (np.abs(velocity) <= max(2.0 * quantum, 0.02 * float(np.abs(velocity).max())))
    if np.count_nonzero(slow) < _REST_ROWS:
        return Reading(0.0, quantum)
    rest = np.asarray(velocity)[slow]
    bias = float(np.median(rest))
    return Reading(bias, max(quantum, float(np.quantile(np.abs(rest - bias), 0.99))))


def snap_period(period: float, quantum: float) -> float:
    """A known range next to the one that was measured, else a whole power of two of the quantum, else the measured."""
    known = min(_KNOWN_PERIODS, key=lambda one: abs(period / one - 1.0))
    if abs(period / known - 1.0) < _NEAR:
        return known
    if quantum > 0.0:
        power = quantum * 2.0 ** round(np.log2(period / quantum))
        if abs(period / power - 1.0) < _NEAR:
            return float(power)
    return period

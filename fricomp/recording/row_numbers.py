"""The number of each row of a log in which rows are missing and whose stamps jitter.

A clock that jitters by a third of a period hides a missing row in its own step. All rows after it tell that it is
missing; where the joint moves, so does the way that it makes between the rows beside it. What is most likely by both is
found by dynamic programming over the number of rows that are missing so far [viterbi1967error]; each guess follows the
clock by itself.
"""

import math
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from fricomp.recording.validity import Samples

_FOLLOW = 0.02
"""Part of a stamp's deviation by which a guess follows it, so that jitter hardly moves it."""
_FOLLOW_PERIOD = 0.375
"""The same for the period, over its square: with a part of 4/n both are those of a straight line through n stamps."""
_LEAST_JITTER = 0.03
"""Standard deviation of the stamps that is taken at least, in periods: so well is the grid known at first."""
_TAIL = 3.0
"""Degrees of freedom of the errors of stamps and ways (Student's distribution): computers are late now and then by far
more than usually, stamps in whole periods are right or a period off, and joints that reverse are not steady."""
_MISSING = 4.0
"""Cost of missing rows, in nepers: they are missing at one of fifty places."""
_BEYOND = 25.0
"""Cost over that of the best guess, from which on a guess is given up [nepers]."""
_GUESSES = 8
"""Most guesses at a time."""
_PACE_ROWS = 3
"""Pairs of rows, one before and one after each, whose median way is that of one period: in the mean of a pair an
acceleration cancels, and a missing row doubles the way of one of them."""


class RowNumbers(NamedTuple):
    """How the rows of a part are counted.

    Attributes:
        numbers: Of each row. Shape (n,).
        cost: Negative logarithm of the likelihood of it [nepers].
    """

    numbers: Samples
    cost: float


class _Guess(NamedTuple):
    """How many rows are missing so far.

    Attributes:
        cost: Negative logarithm of its likelihood.
        instant: Of the last row [s].
        period: As followed [s].
        missing: Rows so far.
        places: Row after the last missing ones, how many these are, and the same before it; None where none are.
    """

    cost: float
    instant: float
    period: float
    missing: int
    places: tuple[int, int, Any] | None


def count_rows(time: Samples, position: Samples, period: float, known: Samples, told_by: int) -> RowNumbers:
    """Number of each row on its grid, in which rows may be missing.

    Args:
        time: Stamps that rise [s]. Shape (n,).
        position: [rad] or [m]. Shape (n,).
        period: About that of the rows [s].
        known: Their numbers as far as they are known; 0, 1, ... where nothing is. Shape (n,).
        told_by: Stamps that tell a period as well as it is known.
    """
    steps = np.diff(known)
    weight = 1.0 / (_TAIL * max(_measure_jitter(np.diff(time) / period - steps), _LEAST_JITTER) ** 2)
    way, pace, scatter = _measure_way(position, steps)
    guesses = [_Guess(0.0, float(time[0]), period, 0, None)]
    rows = zip(time.tolist()[1:], way.tolist(), pace.tolist(), strict=True)
    for row, (stamp, moved, usual) in enumerate(rows, 1):
        turn = max(_FOLLOW, 4.0 / (row + told_by))
        follow = (max(turn, 1.0 / (row + 1)), _FOLLOW_PERIOD * turn**2)
        found: dict[int, _Guess] = {}
        for guess in guesses:
            for one in _go_on(guess, row, stamp, (moved / scatter, usual / scatter), weight, follow):
                rival = found.get(one.missing)
                if rival is None or one.cost < rival.cost:
                    found[one.missing] = one
        least = min(one.cost for one in found.values())
        guesses = sorted(one for one in found.values() if one.cost < least + _BEYOND)[:_GUESSES]
    likely = min(guesses)
    return RowNumbers(np.arange(time.size) + _list_missing(likely, time.size), likely.cost)


def _go_on(
    guess: _Guess, row: int, stamp: float, way: tuple[float, float], weight: float, follow: tuple[float, float]
) -> Iterator[_Guess]:
    """What a guess may be a row later."""
    cost, instant, period, missing, places = guess
    ahead = (stamp - instant) / period
    whole = int(ahead)
    for step in (1, 2, *range(max(3, whole - 1), whole + 2)):
        off, left = ahead - step, way[0] - step * way[1]
        stamped = 1.0 + weight * (1.0 - follow[0]) * off * off
        more = 0.5 * (_TAIL + 1.0) * math.log(stamped * (1.0 + left * left / _TAIL)) + (_MISSING if step > 1 else 0.0)
        off = min(max(off, -1.0), 1.0) * period
        yield _Guess(
            cost + more,
            instant + step * period + follow[0] * off,
            period + follow[1] * off,
            missing + step - 1,
            places if step == 1 else (row, step - 1, places),
        )


def _list_missing(guess: _Guess, size: int) -> Samples:
    """How many rows are missing before each. Shape (n,)."""
    missing = np.zeros(size)
    places = guess.places
    while places is not None:
        row, count, places = places
        missing[row] = count
    return np.cumsum(missing)


def _measure_jitter(off: Samples) -> float:
    """Standard deviation of single stamps, by what steps are off; a missing row counts as a period [periods].

    Stamps in whole periods are mostly right and sometimes a period off: no quantile would show it.
    """
    return float(np.sqrt(0.5 * np.mean(np.minimum(np.abs(off), 1.0) ** 2)))


def _measure_way(position: Samples, steps: Samples) -> tuple[Samples, Samples, float]:
    """Way to each row from the one before, that of one period around it, and the scatter of their differences.

    Shapes (n - 1,).
    """
    way = np.diff(position)
    around = np.pad(way / steps, _PACE_ROWS, mode="reflect")
    middle = slice(_PACE_ROWS, -_PACE_ROWS)
    pairs = [0.5 * (np.roll(around, k) + np.roll(around, -k))[middle] for k in range(1, _PACE_ROWS + 1)]
    pace = np.median(pairs, axis=0)
    scatter = 1.25 * float(np.mean(np.abs(way - steps * pace)))
    return way, pace, max(scatter, 1e-3 * float(np.ptp(position)) / position.size, 1e-300)

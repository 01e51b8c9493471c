"""The step in which an encoder gives a position, and what it tells of the unit."""

from math import log10, pi

import numpy as np
from numpy.typing import NDArray

__all__ = ["find_position_step", "is_round", "is_rounding", "shows_radians"]

Samples = NDArray[np.float64]

_NEAR_LEVELS = 50.0
"""Steps between two levels within which their number is sure."""
_MOST_COUNTS = 200_000
"""Counts a turn of an encoder whose step is told by them."""


def find_position_step(position: Samples) -> float | None:
    """Return the step of a quantised position [as position], or None where it is not quantised."""
    levels = np.unique(position)
    gaps = np.diff(levels)
    gaps = gaps[gaps > 1e-9 * max(np.abs(levels).max(), 1e-300)]
    if gaps.size < 20:
        return None
    step = float(np.median(gaps[gaps < 1.5 * gaps.min()]))
    near = gaps[gaps < _NEAR_LEVELS * step]
    step = float(near.sum() / np.round(near / step).sum())  # numbers written with few decimals round each gap
    whole = np.abs(gaps / step - np.round(gaps / step)) < 0.02
    return step if whole.mean() > 0.98 else None


def shows_radians(position: Samples) -> bool:
    """Whether a position [rad] moves in steps of an encoder whose turn is 2 pi. Shape (n_samples,)."""
    step = find_position_step(position)
    if step is None or is_rounding(step):
        return False
    counts = round(2.0 * pi / step)
    binary = 256 <= counts < 2**27 and counts & (counts - 1) == 0
    return (binary or is_round(counts)) and abs(counts * step / (2.0 * pi) - 1.0) < 1e-5


def is_round(counts: int) -> bool:
    """Whether an encoder has so many counts a turn, as far as those in hundreds go."""
    return 0 < counts <= _MOST_COUNTS and counts % 100 == 0


def is_rounding(step: float) -> bool:
    """Whether a step is that of numbers written with so many decimals, which may be of anything."""
    return abs(log10(step) - round(log10(step))) < 1e-6

"""What no noise has: lines and peaks in the spectrum of rows, and how loud the rest of it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter

from ..inputs.track import FloatArray

__all__ = ["estimate_floor", "is_structured"]

_AROUND = 101  # lines whose median is the level about each of them
_LINE = 2.5  # times the loudest line of a null over its level, from which a line is none of noise
_BANDS, _LINES_OF_A_BAND = 20, 20
_PEAK, _LEAST_PEAK = 1.5, 2.0  # times the highest peak of a null, and peak at least, that is none of noise
_LIMIT = 4.0  # typical deviations that a row counts for at most: one bad moment fills the whole spectrum


def is_structured(ours: FloatArray, theirs: Sequence[FloatArray]) -> bool:
    """Whether rows have a line, or a peak between quieter frequencies, that no null comes near.

    The colour of noise rises or falls over the spectrum. What swings (a neighbouring joint, a mass that hangs on the
    link) does so at its own frequencies, and whitened or counted as noise it would be lost.

    Args:
        ours: Rows of a residual, without what is smooth. Shape (m,).
        theirs: The same of nulls.
    """
    loudest = max(float(np.max(_divide_by_level(one))) for one in theirs)
    if float(np.max(_divide_by_level(ours))) > _LINE * loudest:
        return True
    count = min(_BANDS, ours.size // (2 * _LINES_OF_A_BAND))
    if count < 3:
        return False
    bands = [_average_bands(one, count) for one in theirs]
    usual = np.mean(bands, axis=0)
    highest = max(_compute_peak(one / usual) for one in bands)
    return _compute_peak(_average_bands(ours, count) / usual) > max(_PEAK * highest, _LEAST_PEAK)


def estimate_floor(values: FloatArray) -> float:
    """Standard deviation of white noise with the typical line of a spectrum: what few lines hold is none."""
    return float(np.sqrt(np.median(_compute_power(values)) / (np.log(2.0) * values.size)))


def _compute_power(values: FloatArray) -> FloatArray:
    """Energy of each line but the mean, in rows that count for no more than a few. Shape (m // 2,)."""
    limit = _LIMIT * float(np.median(np.abs(values))) / 0.6745
    result: FloatArray = np.abs(np.fft.rfft(np.clip(values, -limit, limit))[1:]) ** 2
    return result


def _divide_by_level(values: FloatArray) -> FloatArray:
    """Energy of each line over the level about it. Shape (m // 2,)."""
    power = _compute_power(values)
    result: FloatArray = power * np.log(2.0) / np.maximum(median_filter(power, min(_AROUND, power.size)), 1e-300)
    return result


def _average_bands(values: FloatArray, count: int) -> FloatArray:
    """Mean energy of a line in each of so many bands. Shape (count,)."""
    return np.array([float(np.mean(band)) for band in np.array_split(_compute_power(values), count)])


def _compute_peak(bands: FloatArray) -> float:
    """How many times the loudest band is louder than quieter ones on both sides of it."""
    return max(
        float(bands[k] / max(np.min(bands[:k]), np.min(bands[k + 1 :]), 1e-300)) for k in range(1, bands.size - 1)
    )

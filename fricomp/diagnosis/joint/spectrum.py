"""What no noise has: lines and peaks in the spectrum of rows, and how loud the rest of it is."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import median_filter

from ..inputs.track import FloatArray
from .settings import JOINT


def is_structured(ours: FloatArray, theirs: Sequence[FloatArray]) -> bool:
    """Tell whether rows have a line, or a peak between quieter frequencies, which no null comes near.

    The colour of noise rises or falls over the spectrum. What swings (a neighbouring joint, a mass that hangs on the
    link) does so at its own frequencies, and whitened or counted as noise it would be lost.

    Args:
        ours: Rows of a residual, without what is smooth. Shape (m,).
        theirs: The same rows of nulls.
    """
    loudest = max(float(np.max(_divide_by_level(one))) for one in theirs)
    if float(np.max(_divide_by_level(ours))) > JOINT.line_ratio * loudest:
        return True
    count = min(JOINT.bands, ours.size // (2 * JOINT.band_lines))
    if count < 3:
        return False
    bands = [_average_bands(one, count) for one in theirs]
    usual = np.mean(bands, axis=0)
    highest = max(_compute_peak(one / usual) for one in bands)
    return _compute_peak(_average_bands(ours, count) / usual) > max(JOINT.peak_ratio * highest, JOINT.least_peak)


def estimate_floor(values: FloatArray) -> float:
    """Estimate the standard deviation of the noise from the median line of the spectrum. What lies in a few lines is no
    noise."""
    return float(np.sqrt(np.median(_compute_power(values)) / (np.log(2.0) * values.size)))


def _compute_power(values: FloatArray) -> FloatArray:
    """Energy of each line but the mean, in rows that count for no more than a few. Shape (m // 2,)."""
    limit = JOINT.row_limit * float(np.median(np.abs(values))) / 0.6745
    result: FloatArray = np.abs(np.fft.rfft(np.clip(values, -limit, limit))[1:]) ** 2
    return result


def _divide_by_level(values: FloatArray) -> FloatArray:
    """Energy of each line over the level about it. Shape (m // 2,)."""
    power = _compute_power(values)
    result: FloatArray = (
        power * np.log(2.0) / np.maximum(median_filter(power, min(JOINT.lines_around, power.size)), 1e-300)
    )
    return result


def _average_bands(values: FloatArray, count: int) -> FloatArray:
    """Mean energy of a line in each of so many bands. Shape (count,)."""
    return np.array([float(np.mean(band)) for band in np.array_split(_compute_power(values), count)])


def _compute_peak(bands: FloatArray) -> float:
    """How many times the loudest band is louder than quieter ones on both sides of it."""
    return max(
        float(bands[k] / max(np.min(bands[:k]), np.min(bands[k + 1 :]), 1e-300)) for k in range(1, bands.size - 1)
    )

"""A signal in samples, and its derivative."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import savgol_coeffs

from .settings import INPUT

FloatArray = NDArray[np.float64]


def differentiate(values: FloatArray, dt: float, window: float = INPUT.velocity_window, order: int = 1) -> FloatArray:
    """Differentiate with a local cubic (Savitzky and Golay) over `window` [s]; with order 0, smooth."""
    samples = min(max(INPUT.shortest_window, 2 * round(window / dt / 2) + 1), values.size - 1 + values.size % 2)
    inner, first, last = _build_weights(samples, dt, order)
    middle = np.convolve(values, inner, mode="valid")
    result: FloatArray = np.concatenate([first @ values[:samples], middle, last @ values[values.size - samples :]])
    return result


def draw_curve(at: FloatArray, values: FloatArray, wanted: FloatArray) -> FloatArray:
    """Draw a smooth curve through values at the instants `at` and read it at those `wanted` [s]. Shape of `wanted`."""
    curve: FloatArray = CubicSpline(at, values)(wanted)
    return curve


@lru_cache(maxsize=32)
def _build_weights(samples: int, dt: float, order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Weights of a cubic over `samples`, an odd number: to convolve with, and those of the halves at both ends.

    scipy's filter fits these ends anew at each call, and walks through the rest in a loop that no vector unit helps:
    three times as long in all. Shapes (samples,), (samples // 2, samples), (samples // 2, samples).
    """
    half = samples // 2
    inner = savgol_coeffs(samples, 3, deriv=order, delta=dt)
    ends = [savgol_coeffs(samples, 3, deriv=order, delta=dt, pos=at, use="dot") for at in range(samples)]
    shape = (half, samples)
    return inner, np.reshape(ends[:half], shape), np.reshape(ends[samples - half :], shape)

"""A signal in samples, and its derivative."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_filter

from .settings import INPUT

FloatArray = NDArray[np.float64]


def differentiate(values: FloatArray, dt: float, window: float = INPUT.velocity_window, order: int = 1) -> FloatArray:
    """Differentiate with a local cubic (Savitzky and Golay) over `window` [s]; with order 0, smooth."""
    samples = min(max(INPUT.shortest_window, 2 * round(window / dt / 2) + 1), values.size - 1 + values.size % 2)
    result: FloatArray = savgol_filter(values, samples, 3, deriv=order, delta=dt)
    return result

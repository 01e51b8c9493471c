"""Signals that come late, by a delay or through low passes, and how that is undone."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from .track import FloatArray


def shift(values: FloatArray, samples: float) -> FloatArray:
    """Return `values` as they will be `samples` later, which undoes a delay. Interpolation is linear; the ends are
    held."""
    if samples == 0.0:
        return values
    whole = int(np.floor(samples))
    share, n = samples - whole, values.size
    first = np.clip(whole, -n, n)
    held = np.concatenate([np.repeat(values[:1], max(-first, 0)), values, np.repeat(values[-1:], max(first, 0) + 1)])
    start = max(first, 0)
    return held[start : start + n] * (1.0 - share) + held[start + 1 : start + 1 + n] * share


def apply_lags(values: FloatArray, lags: tuple[float, ...], dt: float) -> FloatArray:
    """Pass `values` through low passes of the first order, which start at rest at the first value. Shape (n,).

    Each is late by its time constant in the mean. A factor exp(-dt / lag) would make it half a sample less, which the
    fit of a lag would add to its time constant.
    """
    for lag in lags:
        keep = lag / (lag + dt)
        values, _ = lfilter([1.0 - keep], [1.0, -keep], values, zi=[keep * values[0]])
    return values


def undo_lags(values: FloatArray, lags: tuple[float, ...], dt: float) -> FloatArray:
    """Return what gives `values` behind these low passes, so that a lag takes no noise away. Shape (n,)."""
    for lag in lags:
        before = np.concatenate([values[:1], values[:-1]])
        values = values + lag / dt * (values - before)
    return values

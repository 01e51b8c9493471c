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


def apply_lags(values: FloatArray, lags: tuple[complex, ...], dt: float) -> FloatArray:
    """Pass `values` through low passes of the first order, which start at rest at the first value. Shape (n,).

    Exact for values that go straight from sample to sample (first-order hold): however few samples a time constant
    has, it is neither later nor less spread than it is. Two conjugate ones are a low pass that overshoots.
    """
    for lag in (one for one in lags if one.real > 0.0):
        keep = np.exp(-dt / lag)
        mean = lag / dt * (1.0 - keep)
        values, _ = lfilter([1.0 - mean, mean - keep], [1.0, -keep], values, zi=[mean * values[0]])
    return values.real


def undo_lags(values: FloatArray, lags: tuple[complex, ...], dt: float) -> FloatArray:
    """Return what gives `values` behind these low passes, if they are smooth from sample to sample. Shape (n,)."""
    for lag in lags:
        values = values + lag * np.gradient(values, dt)
    return values.real

"""Lone samples of a torque that are no measurement."""

from __future__ import annotations

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view
from numpy.typing import NDArray
from scipy.ndimage import label, median_filter

from fricomp.recording.parts.kicks import find_answered_kicks

from .settings import INPUT
from .signal import FloatArray

_WINDOW = 7
"""Samples among which one stands out; three of them at most do."""


def remove_spikes(torque: FloatArray, noise: float, position: FloatArray, dt: float) -> FloatArray:
    """Put samples that stand out from their neighbours' median back on it, where the joint does not answer them.

    Args:
        torque: Recorded torque [N·m] or [N]. Shape (n,).
        noise: Standard deviation of its noise.
        position: Recorded position [rad] or [m]. Shape (n,).
        dt: Sample time [s].
    """
    calm = take_out_spikes(torque, noise, slow=_WINDOW // 2 * dt > INPUT.quickest_swing)
    lone = calm != torque
    return np.where(lone & ~find_answered_kicks(torque, lone, position, dt), calm, torque) if lone.any() else torque


def take_out_spikes(values: FloatArray, noise: float, *, slow: bool = False) -> FloatArray:
    """Put samples that stand out from their neighbours' median by many noise deviations back on that median.

    Args:
        values: Samples. Shape (n,).
        noise: Standard deviation of their noise.
        slow: Whether a few samples last as long as a swing of a loop. Its peak at a reversal is no spike then: only
            those samples are that come and go more abruptly than anything about them.
    """
    middle = median_filter(values, _WINDOW, mode="nearest")
    limit = INPUT.spike * max(noise, 1e-3 * float(np.std(values)))
    apart = np.abs(values - middle) > limit
    if slow and apart.any():
        apart &= _find_abrupt(values, apart)
    return np.where(apart, middle, values)


def _find_abrupt(values: FloatArray, apart: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Find the stretches of `apart` both of whose edges are steeper than what lies about them, and across. Shape (n,).

    Args:
        values: Samples. Shape (n,).
        apart: Those in question. Shape (n,).
    """
    number, _ = label(apart)
    edges = np.diff(np.pad(apart, 1).astype(np.int8))
    before, after = np.flatnonzero(edges == 1) - 1, np.flatnonzero(edges == -1)  # samples beside each
    held = np.pad(values, 1, mode="edge")  # one at an end has no edge there, and stays
    steps = np.abs(np.diff(held))
    into, out, across = steps[before + 1], steps[after], np.abs(held[after + 1] - held[before + 1])
    near = sliding_window_view(np.pad(steps, _WINDOW // 2), _WINDOW // 2).max(axis=1)
    steepest = np.maximum(across, np.maximum(near[before + 1], near[after + _WINDOW // 2 + 1]))
    abrupt: NDArray[np.bool_] = np.r_[False, np.minimum(into, out) > steepest][number]
    return abrupt

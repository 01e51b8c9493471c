"""Lone samples of a torque that are no measurement."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import median_filter

from fricomp.recording.parts.kicks import find_answered_kicks

from .settings import INPUT
from .signal import FloatArray


def remove_spikes(torque: FloatArray, noise: float, position: FloatArray, dt: float) -> FloatArray:
    """Put samples that stand out from their neighbours' median back on it, where the joint does not answer them.

    Args:
        torque: Recorded torque [N·m] or [N]. Shape (n,).
        noise: Standard deviation of its noise.
        position: Recorded position [rad] or [m]. Shape (n,).
        dt: Sample time [s].
    """
    calm = take_out_spikes(torque, noise)
    lone = calm != torque
    return np.where(lone & ~find_answered_kicks(torque, lone, position, dt), calm, torque) if lone.any() else torque


def take_out_spikes(values: FloatArray, noise: float) -> FloatArray:
    """Put samples that stand out from their neighbours' median by many noise deviations back on that median."""
    middle = median_filter(values, 7, mode="nearest")
    limit = INPUT.spike * max(noise, 1e-3 * float(np.std(values)))
    return np.where(np.abs(values - middle) > limit, middle, values)

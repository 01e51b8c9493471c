"""Noise of a recording's position and torque, and what filters leave of it."""

from collections.abc import Sequence

import numpy as np
from scipy.signal import butter, sosfreqz

from fricomp.laws import FloatArray
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

_ORDER = 6
"""Differences of this order are nothing of a motion that is sampled ten times faster than it changes."""
_SQUARES = 924.0
"""Sum of the squares of their binomial coefficients: their variance over that of white noise."""
_GLITCH = 3.0
"""Times the difference that nine of ten are below, from which on one is a glitch: five standard deviations."""
_FREQUENCIES = 4096
"""Frequencies at which a filter's gain is measured; the narrowest pass has dozens of them."""


def measure_position_noise(recording: Recording) -> float:
    """Standard deviation of the position's noise, mostly its quantisation [rad] or [m]."""
    return _measure_noise(recording, recording.position)


def measure_torque_noise(recording: Recording) -> float:
    """Standard deviation of the torque's white noise [N·m] or [N]; that of a loop's own fast torque counts as such."""
    return _measure_noise(recording, recording.torque)


def _measure_noise(recording: Recording, values: FloatArray) -> float:
    """Standard deviation of white noise, by differences that see next to nothing else.

    Those of an encoder at rest are zero and say nothing, and those across a gap are of the motion in it. Glitches count
    as no more than large noise.
    """
    if len(recording) <= _ORDER:
        return 0.0
    differences = np.abs(np.diff(values, _ORDER))
    jumps = np.abs(np.diff(recording.time) - recording.sample_period) > 0.5 * recording.sample_period
    steps = np.abs(np.diff(values)) > 1e-12 * np.ptp(values)
    steady, moves = (np.convolve(one, np.ones(_ORDER), mode="valid") for one in (jumps, steps))
    shown = differences[(steady == 0.0) & (moves > 0.0)]
    if not len(shown):
        return 0.0
    usual = np.minimum(shown, _GLITCH * np.quantile(shown, 0.9))
    return float(np.sqrt(np.mean(usual**2) / _SQUARES))


def pass_white_noise(filters: Sequence[FloatArray], rate: float, derivative: int = 0) -> float:
    """Standard deviation of filtered white noise, or of a derivative of it, over its own [1/s^derivative].

    Args:
        filters: Second-order sections of each, which is run forth and back.
        rate: Of the recording [Hz].
        derivative: How often it is differentiated.
    """
    angle = np.linspace(0.0, np.pi, _FREQUENCIES)
    gain = np.prod([np.abs(sosfreqz(sections, angle)[1]) ** 2 for sections in filters], axis=0)
    return compute_rms(gain * (angle * rate) ** derivative)


def position_filter(cutoff: float, rate: float) -> FloatArray:
    """Second-order sections of the low-pass before the position is differentiated.

    Args:
        cutoff: At most [Hz].
        rate: Of the recording [Hz].
    """
    return np.asarray(butter(4, min(cutoff, 0.4 * rate), fs=rate, output="sos"))

"""Lone samples of a torque that the joint answers: the kick of a controller whose set point steps, and no outlier."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation
from scipy.signal import savgol_coeffs, savgol_filter

from fricomp.recording.validity import Samples

Rows = NDArray[np.bool_]

_WINDOW = 0.02
"""Window over which a joint is seen to answer a lone sample of its torque [s]."""
_FEWEST = 11
"""Fewest samples of that window."""
_CLEAR = 4.0
"""Usual accelerations from which one is an answer to anything."""
_INERTIA_WINDOW = 0.05
"""Window of the inertia that such an answer is held against [s]: wide enough for coarse encoders."""
_FREE = 2.0
"""Factor by which that inertia may be off: lone samples and their neighbours are few."""


def find_answered_kicks(torque: Samples, lone: Rows, position: Samples, dt: float) -> Rows:
    """Find samples whose torque the joint answers with an acceleration that its inertia has for it. Shape (n,).

    Left out, the momentum of such a kick would be missing from the motion. Acceleration and torque are looked at
    through the same window, each beside its mean a window before and after.

    Args:
        torque: Recorded torque [N·m] or [N]. Shape (n,).
        lone: Samples that stand out from those about them, and tell nothing of the inertia. Shape (n,).
        position: Recorded position [rad] or [m]. Shape (n,).
        dt: Sample time [s].
    """
    samples = _count_samples(_WINDOW, dt)
    if torque.size < 4 * max(samples, _count_samples(_INERTIA_WINDOW, dt)):
        return np.zeros(torque.size, dtype=bool)
    second = savgol_coeffs(samples, 3, deriv=2, delta=dt, use="dot")
    seen = np.cumsum(np.cumsum(second))[:-2] * dt**2  # the torque in a window whose second difference is `second`
    acceleration = _stand_out(np.convolve(position, second[::-1], "same"), samples)
    peak = _stand_out(np.convolve(torque, seen, "same"), samples)
    clear = np.abs(acceleration) > _CLEAR * 1.4826 * np.median(np.abs(acceleration))
    low, high = _bound_inertia(torque, lone, position, dt)
    inertia = np.divide(peak, acceleration, out=np.zeros(peak.size), where=clear)
    answered: Rows = lone & clear & (low / _FREE < inertia) & (inertia < _FREE * high)
    return answered


def _count_samples(window: float, dt: float) -> int:
    return max(_FEWEST, 2 * round(0.5 * window / dt) + 1)


def _stand_out(values: Samples, samples: int) -> Samples:
    """`values` less the mean of those this many samples before and after. Shape (n,)."""
    padded = np.pad(values, samples, mode="edge")
    result: Samples = values - 0.5 * (padded[: values.size] + padded[2 * samples :])
    return result


def _bound_inertia(torque: Samples, lone: Rows, position: Samples, dt: float) -> tuple[float, float]:
    """Bound the inertia [N·m·s²/rad] of a rigid joint with friction and gravity, far from samples that are alone.

    Noise of the acceleration lowers the slope of torque over acceleration; that of the torque raises the inverse of the
    slope of acceleration over torque. The inertia lies between them.
    """
    samples = _count_samples(_INERTIA_WINDOW, dt)
    smooth, velocity, acceleration = (savgol_filter(position, samples, 3, deriv=k, delta=dt) for k in (0, 1, 2))
    known = np.column_stack([velocity, np.sign(velocity), np.cos(smooth), np.sin(smooth), np.ones(smooth.size)])
    far = ~binary_dilation(lone, iterations=samples)
    both = np.column_stack([acceleration, savgol_filter(torque, samples, 3)])[far]
    left = both - known[far] @ np.linalg.lstsq(known[far], both, rcond=None)[0]
    (speeding, common), (_, pushing) = left.T @ left
    return (common / speeding, pushing / common) if common > 0.0 else (0.0, np.inf)

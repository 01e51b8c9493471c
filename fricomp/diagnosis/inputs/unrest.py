"""How restless a torque is over time: where its loop chatters, samples hold less of it than elsewhere."""

from __future__ import annotations

import numpy as np
from scipy.ndimage import maximum_filter1d

from .settings import INPUT
from .signal import FloatArray


def measure_unrest(torque: FloatArray, velocity: FloatArray, dt: float) -> FloatArray:
    """Measure by how much more a torque jumps from sample to sample than it usually does, at least 1. Shape (n,).

    A loop that chatters at the steps of its encoder, or about to be unstable, changes its torque between the samples
    of a log. What acts then is known less well, and more of the residual is noise. Third differences hold next to
    nothing of a motion, and a quantile of them nothing of a kick. A torque that is restless for much of its motion is
    as usual: that is its noise.

    Args:
        torque: Shape (n,).
        velocity: Of the joint, shape (n,): while it moves the torque is as restless as it usually is.
        dt: Sample time [s].
    """
    size = max(INPUT.shortest_window, round(INPUT.unrest_window / dt))
    count = torque.size // size
    if count < INPUT.fewest_windows:
        return np.ones(torque.size)
    jumps = np.abs(np.diff(torque, 3, prepend=np.full(3, torque[0])))[: count * size].reshape(count, size)
    sizes = np.quantile(jumps, INPUT.unrest_quantile, axis=1)
    speeds = np.abs(velocity[: count * size]).reshape(count, size).mean(axis=1)
    moving = sizes[speeds >= INPUT.moving_share * np.quantile(speeds, 0.98)]
    usual = float(np.quantile(moving, INPUT.mostly))
    if usual <= 0.0:
        return np.ones(torque.size)
    times = maximum_filter1d(sizes, 3) / (INPUT.usual_unrest * usual)
    result: FloatArray = np.maximum(1.0, np.repeat(times, size))
    return np.append(result, np.full(torque.size - result.size, result[-1]))

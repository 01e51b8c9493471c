"""Means of a recording over blocks of 50 ms, in which a direction of motion is sure."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_FEWEST_BLOCKS = 80


class CoarseBlocks(NamedTuple):
    """Means over blocks of rows, the velocity between them, and which are fast and go the way of their neighbours.

    Swings as short as a block leave a torque of inertia that looks like friction of the other sign. Shapes (n_blocks,).
    """

    time: Samples
    position: Samples
    torque: Samples
    velocity: Samples
    fast: NDArray[np.bool_]


def average_blocks(recording: Recording) -> CoarseBlocks | None:
    """Means over 50 ms; None where there are too few."""
    rows = max(5, round(0.05 / recording.sample_period))
    count = len(recording) // rows * rows
    time, position, torque = (
        values[:count].reshape(-1, rows).mean(axis=1)
        for values in (recording.time, recording.position, recording.torque)
    )
    if time.size < _FEWEST_BLOCKS:
        return None
    velocity = np.gradient(position, time)
    fast = np.abs(velocity) > 0.1 * np.percentile(np.abs(velocity), 98)
    fast[1:-1] &= (velocity[1:-1] * velocity[:-2] > 0.0) & (velocity[1:-1] * velocity[2:] > 0.0)
    return CoarseBlocks(time, position, torque, velocity, fast)

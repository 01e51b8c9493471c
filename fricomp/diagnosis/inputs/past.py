"""How a joint was driven over the whole recording that a stretch is of: a joint stays warm between its stretches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.recording import Recording

from .settings import INPUT
from .signal import FloatArray, differentiate


@dataclass(frozen=True)
class Past:
    """How a joint was driven over a recording, in cells of `INPUT.past_cell`.

    Attributes:
        speed: Mean speed in each cell [rad/s] or [m/s]; 0 where nothing was recorded. Shape (n,).
        square: Mean square of the torque in each cell, likewise [(N·m)²]. Shape (n,).
        begin: When the stretch begins, from the beginning of the recording [s].
    """

    speed: FloatArray
    square: FloatArray
    begin: float


def build_past(parts: Sequence[Recording], stretches: Sequence[Recording]) -> list[Past | None]:
    """The past of each stretch.

    Args:
        parts: All usable parts of the recording.
        stretches: Parts or stretches of them.
    """
    begin = float(parts[0].time[0])
    count = int((float(parts[-1].time[-1]) - begin) / INPUT.past_cell) + 1
    speed, square, samples = np.zeros(count), np.zeros(count), np.zeros(count)
    for part in parts:
        cells = ((np.asarray(part.time) - begin) / INPUT.past_cell).astype(int)
        samples += np.bincount(cells, minlength=count)
        moving = np.abs(differentiate(np.asarray(part.position), part.sample_period))
        speed += np.bincount(cells, weights=moving, minlength=count)
        square += np.bincount(cells, weights=np.asarray(part.torque) ** 2, minlength=count)
    samples = np.maximum(samples, 1.0)
    return [Past(speed / samples, square / samples, float(one.time[0]) - begin) for one in stretches]

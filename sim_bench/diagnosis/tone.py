"""A vibration: a line in the spectrum of the residual over time, which no smooth torque and no place shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import periodogram

from .preparation import Prepared
from .track import FloatArray

__all__ = ["Tone", "find_tone"]

_LIMIT = 3.0  # deviations beyond which a row counts as that many: one bad moment fills the whole spectrum


class Tone(NamedTuple):
    """The strongest line.

    Attributes:
        frequency: Of the line [Hz].
        width: Resolution of the spectrum [Hz].
        energy: In it, in units of the noise variance; noise alone has about 2 in each line.
        energy_null: The most that a null has in any line.
    """

    frequency: float
    width: float
    energy: float
    energy_null: float


def find_tone(prepared: Prepared) -> Tone:
    """The strongest line in the spectra of what the base leaves of each recording."""
    ends = np.cumsum([grid.centres.size for grid in prepared.problem.grids])[:-1]
    lines = [
        _strongest(part, float(grid.centres[1] - grid.centres[0]) * track.dt)
        for part, grid, track in zip(
            np.split(prepared.fit.residual, ends), prepared.problem.grids, prepared.problem.tracks, strict=True
        )
    ]
    energy, frequency, width = max(lines)
    nulls = [max(_strongest(part, 1.0)[0] for part in np.split(null, ends)) for null in prepared.null_residuals]
    return Tone(frequency, width, energy, max(nulls))


def _strongest(rows: FloatArray, step: float) -> tuple[float, float, float]:
    """Energy, frequency [Hz] and resolution [Hz] of the strongest line."""
    frequency, energy = periodogram(np.clip(rows, -_LIMIT, _LIMIT), 1.0, detrend="constant")
    best = int(np.argmax(energy))
    return float(energy[best]), float(frequency[best]) / step, 1.0 / (rows.size * step)

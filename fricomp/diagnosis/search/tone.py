"""A vibration: a line in the spectrum of the residual over time, which no smooth torque and no place shows."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import periodogram

from ..inputs.track import FloatArray
from .preparation import Baseline
from .settings import SEARCH


class Tone(NamedTuple):
    """The strongest line above the frequencies of the motion.

    Attributes:
        frequency: Frequency of the line [Hz].
        width: Resolution of the spectrum [Hz].
        energy: In it, in units of the noise variance; noise alone has about 2 in each line.
        energy_null: The most that a null has in any line.
        share: Part of the energy beyond the noise that lies in it. What follows the motion is spread over many lines.
    """

    frequency: float
    width: float
    energy: float
    energy_null: float
    share: float


def find_tone(baseline: Baseline) -> Tone:
    """Find the strongest line in the spectra of what the base leaves of each recording."""
    problem = baseline.problem
    ends = np.cumsum([grid.centres.size for grid in problem.grids])[:-1]
    lines = []
    for part, grid, track in zip(np.split(baseline.fit.residual, ends), problem.grids, problem.tracks, strict=True):
        step = float(grid.centres[1] - grid.centres[0]) * track.dt
        energy, frequency, share = _find_strongest(part, _find_highest_of_motion(track.velocity[grid.centres]))
        lines.append((energy, frequency / step, 1.0 / (part.size * step), share))
    energy, frequency, width, share = max(lines)
    nulls = [max(_find_strongest(part, 0.0)[0] for part in np.split(null, ends)) for null in baseline.null_residuals]
    return Tone(frequency, width, energy, max(nulls), share)


def _find_highest_of_motion(velocity: FloatArray) -> float:
    """Frequency below which the joint moves, in cycles per row."""
    frequency, energy = periodogram(velocity, 1.0, detrend="constant")
    return float(frequency[int(np.searchsorted(np.cumsum(energy), SEARCH.motion_energy * energy.sum()))])


def _find_strongest(rows: FloatArray, above: float) -> tuple[float, float, float]:
    """Energy and frequency (in cycles per row) of the strongest line above a frequency, and its share of the excess."""
    clipped = np.clip(rows, -SEARCH.tone_limit, SEARCH.tone_limit)
    frequency, energy = periodogram(clipped, 1.0, detrend="constant")
    best = int(np.argmax(np.where(frequency > above, energy, 0.0)))
    excess = max(float(clipped @ clipped) - rows.size, float(energy[best]))
    share = float(energy[best]) / excess if excess > 0.0 else 0.0  # rows without any noise have no line either
    return float(energy[best]), float(frequency[best]), share

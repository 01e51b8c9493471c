"""By how much a recorded torque comes later than the motion that it belongs to.

A torque recorded late by the lag t_l is tau(t - t_l) = tau(t) - t_l dtau/dt + ..., which looks like viscous friction
where a joint swings. What rigid body and friction cannot imitate of dtau/dt tells the lag. The slope of the fitted
torque holds the noise of an acceleration and more: regressed on it alone, a lag would come out too small by the noise's
share. The slope of the measured torque has a noise of its own, so it serves as the instrument [fuller1987measurement]:
smoothed, because a loop that is closed on the encoder puts the encoder's noise into its torque too.
"""

from dataclasses import dataclass

import numpy as np
from scipy.ndimage import binary_erosion, gaussian_filter1d

from fricomp.laws import FloatArray

from ..identification.estimation.correlated_fit import solve_correlated
from .joint_samples import RecordedMotion

_Rows = np.ndarray[tuple[int], np.dtype[np.bool_]]

UNKNOWN_LAG = 0.004
"""Standard deviation of the lag before the motion is seen [s]: filters, half a period and the way over a bus make a
measured torque some 3 ms late, and as much makes a commanded one early."""
_UNKNOWN_PERIODS = 0.5
"""The same in periods of a slow recording: its readings come one after the other, and are held until the next."""
NOISE_KNOWN = 0.5
"""Relative standard deviation of the power of a position's noise: an encoder's steps are white on the mean only."""
_LEAST = 1e-5
"""Least standard deviation of the lag [s]: time stamps jitter by more, also where nothing is known of their clock."""
_VAGUE = 0.5
"""Fraction of it above which a motion has told next to nothing."""
_LARGE = 0.01
"""Lag that filters and a bus do not explain [s]."""
_EDGE = 1.25
"""Periods of the low-pass's cutoff that have no say beside samples that do not slide: when friction turned round
between two samples of the recording nobody knows, nor how it built up, and the low-pass rings of it. In a slow motion
that ringing is most of the slope, and a lag of 10 ms came out where there was none."""
_LEAST_EDGE = 2
"""Samples of it that are left out in any case."""
_ENOUGH = 0.2
"""Part of the samples that slide which must be left; strokes that are too short for that reverse quickly, and their
ringing is known."""
_SMOOTH = 0.64
"""Standard deviation of the Gaussian that smooths the instrument, in periods of the low-pass's cutoff: it ends at a
quarter of it. The noise of an acceleration grows with the square of the frequency: a fiftieth of it is in both."""
_LEAST_SMOOTH = 3
"""The same in samples, below which it is not smoothed: the cutoff is then that of a slow recording, which is set by its
rate and not by its encoder's noise, and what is below a quarter of it tells next to nothing."""
_COLLINEAR = 1e-10
"""Share of the slope's power that is rounding."""
_WEAK = 0.02
"""Correlation of both slopes below which the measured one is no instrument: their noise is all that shows."""


@dataclass(frozen=True)
class TorqueLag:
    """How late a torque was recorded.

    Attributes:
        value: Lag behind the motion, negative where the torque is ahead [s].
        deviation: Its standard deviation [s].
        taken_off: Lag that the samples were rid of before [s].
        shift: What a second of it does to the parameters of the fit, up to the sign. Shape (n_parameters,).
        unknown: Its standard deviation before the motion was seen [s].
    """

    value: float
    deviation: float
    taken_off: float
    shift: FloatArray
    unknown: float = UNKNOWN_LAG

    @property
    def settled(self) -> bool:
        """Whether all of it was taken off."""
        return self.step < 1.0

    @property
    def step(self) -> float:
        """What is still to be taken off, in standard deviations."""
        return abs(self.value - self.taken_off) / self.deviation

    @property
    def sentence(self) -> str:
        """For people."""
        size = f"{1e3 * abs(self.value):.3g} ± {1e3 * self.deviation:.2g} ms"
        if self.deviation > _VAGUE * self.unknown:
            size = f"{1e3 * self.value:.2g} ± {1e3 * self.deviation:.2g} ms"
            return f"The motion does not tell how late the torque comes: {size} is taken, also in the deviations."
        comes = f"he torque comes {size} {'before' if self.value < 0.0 else 'after'} the motion"
        if not self.settled:
            return f"Careful: t{comes}, more than can be taken off."
        if abs(self.value) > _LARGE:
            return f"Careful: t{comes}, which is taken off; filters and a bus are quicker: check both time stamps."
        return f"T{comes}, which is taken off."

    def widen(self, covariance: FloatArray) -> FloatArray:
        """Covariance of the fit with what is unknown of the lag. Shape (n_parameters, n_parameters)."""
        return np.asarray(covariance + self.deviation**2 * np.outer(self.shift, self.shift))


def estimate_lag(
    taken_off: float,
    columns: FloatArray,
    targets: tuple[FloatArray, FloatArray, FloatArray],
    rows: _Rows,
    reach: int,
    recorded: RecordedMotion,
) -> TorqueLag:
    """The lag by one Gauss-Newton step, weighed with what is known of it before.

    Noise of the acceleration, the first column, is in both: what is left of the torque goes together with the slope by
    the inertia times that noise, as if the torque came early. It is known, and taken off.

    Args:
        taken_off: Lag that the samples were rid of [s].
        columns: What rigid body and small changes of friction multiply, at the samples that slide. Shape (n, n_fit).
        targets: Slope of the fitted torque and of the measured one [N·m/s] or [N/s], and torque without friction [N·m]
            or [N], at them. Shapes (n,).
        rows: Which samples slide. Shape (n_samples,).
        reach: Samples over which errors go together.
        recorded: What the samples were decimated from.
    """
    before = float(np.hypot(UNKNOWN_LAG, _UNKNOWN_PERIODS * recorded.period))
    shift = solve_correlated(columns, targets[0], np.flatnonzero(rows), 1).solution
    inner = _select_inside_strokes(rows, recorded.count_samples(_EDGE))
    at, chosen = np.flatnonzero(inner), inner[rows]
    unknown = TorqueLag(0.0, before, taken_off, shift, before)
    if len(at) <= columns.shape[1]:
        return unknown
    width = recorded.count_samples(_SMOOTH)
    measured = targets[1][chosen]
    smooth = _smooth_within(inner, measured, width) if width >= _LEAST_SMOOTH else measured
    shown = (targets[0][chosen], smooth, targets[2][chosen])
    fits = [solve_correlated(columns[chosen], target, at, 1) for target in shown]
    slope, instrument, left = (fit.error for fit in fits)
    if slope @ slope <= _COLLINEAR * np.sum(targets[0][chosen] ** 2):
        return unknown
    common = float(instrument @ slope)
    if common <= _WEAK * np.sqrt(float(instrument @ instrument) * float(slope @ slope)):
        return unknown
    found = solve_correlated(instrument[:, None], -left, at, reach)
    size = float(instrument @ instrument) / common
    noise = len(at) * recorded.acceleration_noise**2
    pulled = float(fits[1].solution[0] * fits[2].solution[0]) * noise / common
    variance = size**2 * float(found.covariance[0, 0]) + (NOISE_KNOWN * pulled) ** 2
    weight = before**2 / (before**2 + variance)
    value = weight * (taken_off + size * float(found.solution[0]) + pulled)
    least = max(_LEAST, recorded.clock_error)
    return TorqueLag(value, float(np.hypot(np.sqrt(weight * variance), least)), taken_off, shift, before)


def _smooth_within(rows: _Rows, values: FloatArray, width: float) -> FloatArray:
    """Values at some samples, smoothed over these alone: reversals beside them stay out. Shape (n,)."""
    spread = np.zeros(len(rows))
    spread[rows] = values
    weight = gaussian_filter1d(rows.astype(np.float64), width)
    return np.asarray((gaussian_filter1d(spread, width) / np.maximum(weight, 1e-300))[rows])


def _select_inside_strokes(rows: _Rows, edge: int) -> _Rows:
    """Samples that slide, without so many at the ends of each stroke, fewer where little would be left."""
    for margin in (edge, (edge + _LEAST_EDGE) // 2):
        inner = binary_erosion(rows, iterations=max(margin, _LEAST_EDGE))
        if np.count_nonzero(inner) >= _ENOUGH * np.count_nonzero(rows):
            return np.asarray(inner)
    return np.asarray(binary_erosion(rows, iterations=_LEAST_EDGE))

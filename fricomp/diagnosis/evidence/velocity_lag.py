"""A recorded velocity that lags behind the recorded position: seen from the two channels alone."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from fricomp.recording import Recording

from ..inputs.track import differentiate
from ..record.result import Quantity
from .comparison import Shift
from .settings import VELOCITY


def find_velocity_lag(recordings: Sequence[Recording]) -> Shift | None:
    """The shift `velocity_filter_lag`, where the recorded velocity is late by more than a usual filter."""
    lags = [lag for recording in recordings if (lag := _measure_lag(recording)) is not None]
    period = max(recording.sample_period for recording in recordings)
    if not lags or float(np.median(lags)) < max(VELOCITY.least, VELOCITY.by_differences * period):
        return None
    lag, spread = float(np.median(lags)), max(VELOCITY.spread, VELOCITY.spread_of_period * period)
    return Shift(
        name="velocity_filter_lag",
        kind="measurement",
        parameters={"time_constant": Quantity(lag, "s", (lag - spread, lag + spread))},
        sentence=f"the recorded velocity lags behind the position by {1e3 * lag:.1f} ms",
        equation="v_recorded = v / (1 + T s)",
        citation="hollerbach2016",
    )


def _measure_lag(recording: Recording) -> float | None:
    """Time constant of the first-order lag that makes the position's derivative most like the velocity [s].

    None where the column is no velocity of this position at all, whatever its lag, and 0 where none explains it.
    """
    if recording.velocity is None or recording.sample_period > VELOCITY.slowest:
        return None
    dt = recording.sample_period
    smooth = max(VELOCITY.smooth / dt, VELOCITY.least_smooth)
    truth = gaussian_filter1d(differentiate(np.asarray(recording.position), dt), smooth)
    seen = gaussian_filter1d(np.asarray(recording.velocity), smooth)
    grid = np.arange(0.0, VELOCITY.longest, VELOCITY.step)
    errors, scales = [], []
    for lag in grid:
        keep = lag / (lag + dt)  # so that the filter is late by `lag` at any sample time
        model = lfilter([1.0 - keep], [1.0, -keep], truth, zi=[keep * truth[0]])[0]
        scales.append(float(seen @ model) / max(float(model @ model), 1e-30))
        errors.append(float(np.mean((seen - scales[-1] * model) ** 2)))
    best = int(np.argmin(errors))
    if abs(scales[best] - 1.0) > VELOCITY.scale:
        return None
    return float(grid[best]) if errors[best] < VELOCITY.left * errors[0] else 0.0

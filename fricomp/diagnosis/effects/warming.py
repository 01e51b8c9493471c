"""Temperature of a joint: recorded, or estimated from the power that it dissipates."""

from __future__ import annotations

import numpy as np
from scipy.signal import lfilter

from ..inputs.track import FloatArray
from .context import Context
from .settings import EFFECT


def compute_warming(power: FloatArray, dt: float, time_constant: float) -> FloatArray:
    """First-order response to `power`, as a share of what its mean would give in the long run. Shape (n,)."""
    keep = float(np.exp(-dt / max(time_constant, dt)))
    rise: FloatArray = lfilter([1.0 - keep], [1.0, -keep], power / max(float(np.mean(power)), 1e-12))
    return rise


def compute_unit_rise(time_constant: float) -> float:
    """What the mean losses bring in the time of a unit of heat, as a share of what they give in the long run [1].

    A slow joint shows how fast it warms, and next to nothing of how warm it would get: in the unit of the long run
    the size of an effect would be as open as the time constant.
    """
    return float(-np.expm1(-EFFECT.heating_unit / time_constant))


def compute_losses(context: Context) -> FloatArray:
    """Power that friction dissipates [W]. Shape (n,)."""
    return np.abs(context.friction * context.velocity)


def compute_heat(context: Context, time_constant: float) -> FloatArray:
    """Compute the rise of a joint's temperature. A recorded one is over the mean of all recordings [K]; an estimate
    from friction losses is over the mean of this one, in what their mean brings in a minute [1]. Shape (n,)."""
    recorded = context.channels.get("temperature")
    if recorded is not None:
        return recorded - context.usual_temperature
    rise = compute_warming(compute_losses(context), context.dt, time_constant)
    return (rise - float(np.mean(rise))) / compute_unit_rise(time_constant)

"""Temperature of a joint: recorded, or estimated from the power that it dissipates."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from ..inputs.settings import INPUT
from ..inputs.track import FloatArray
from .context import Context
from .settings import EFFECT


class Warming(NamedTuple):
    """How a joint warms of itself.

    Attributes:
        rise: Share of what the mean power of the recording would give in the long run [1]. Shape (n,).
        usual: Its mean over the recording [1].
        unit: Mean power of the recording, in the unit of the power.
    """

    rise: FloatArray
    usual: float
    unit: float


def compute_warming(
    power: FloatArray, dt: float, time_constant: float, driven: FloatArray | None = None, begin: float = 0.0
) -> Warming:
    """First-order response to `power`, from cold at the beginning of the recording.

    Args:
        power: Along the samples. Shape (n,).
        dt: Time between them [s].
        time_constant: Of the response [s].
        driven: What the power is about proportional to, over the cells of the whole recording that the samples are a
            stretch of; None where they are all of it. Shape (n_cells,).
        begin: When they begin there [s].
    """
    keep, mean = float(np.exp(-dt / max(time_constant, dt))), max(float(np.mean(power)), 1e-12)
    if driven is None:
        rise: FloatArray = lfilter([1.0 - keep], [1.0, -keep], power / mean)
        return Warming(rise, float(np.mean(rise)), mean)
    cell, first = INPUT.past_cell, int(begin / INPUT.past_cell)
    usual = max(float(np.mean(driven)), 1e-12)
    own = max(float(np.mean(driven[first : first + max(1, round(power.size * dt / cell))])), 1e-12)
    slow, unit = float(np.exp(-cell / max(time_constant, cell))), mean * usual / own
    whole = lfilter([1.0 - slow], [1.0, -slow], driven / usual)
    start = whole[first - 1] if first > 0 else 0.0
    rise = lfilter([1.0 - keep], [1.0, -keep], power / unit, zi=[keep * start])[0]
    return Warming(rise, float(np.mean(whole)), unit)


def compute_unit_rise(time_constant: float) -> float:
    """What the mean losses bring in the time of a unit of heat, as a share of what they give in the long run [1].

    A slow joint shows how fast it warms, and next to nothing of how warm it would get: in the unit of the long run
    the size of an effect would be as open as the time constant.
    """
    return float(-np.expm1(-EFFECT.heating_unit / time_constant))


def compute_losses(context: Context) -> FloatArray:
    """Power that friction dissipates [W]. Shape (n,)."""
    return np.abs(context.friction * context.velocity)


def warm_by_losses(context: Context, time_constant: float, steady: float = 0.0) -> Warming:
    """How the joint warms by what its friction dissipates, which is about proportional to its speed.

    Args:
        context: Of the recording.
        time_constant: Of the warming [s].
        steady: Part of the mean losses that is there at any time, as those of the motor that holds the load [1].
    """
    past = context.past
    speed, begin = (None, 0.0) if past is None else (_even(past.speed, steady), past.begin)
    return compute_warming(_even(compute_losses(context), steady), context.dt, time_constant, speed, begin)


def _even(power: FloatArray, steady: float) -> FloatArray:
    """The power, of whose mean this part is there at any time."""
    return (1.0 - steady) * power + steady * float(np.mean(power))


def compute_heat(context: Context, time_constant: float, steady: float = 0.0) -> FloatArray:
    """Compute the rise of a joint's temperature. A recorded one is over the mean of all recordings [K]; an estimate
    from friction losses is over the mean of this one, in what their mean brings in a minute [1]. Shape (n,)."""
    recorded = context.channels.get("temperature")
    if recorded is not None:
        return recorded - context.usual_temperature
    warming = warm_by_losses(context, time_constant, steady)
    return (warming.rise - warming.usual) / compute_unit_rise(time_constant)

"""Which speeds a sweep visits: spaced in the logarithm, evenly, as listed, or dense where the curve bends."""

import numpy as np

from fricomp.errors import ParameterError
from fricomp.laws import FloatArray

__all__ = ["dense_around", "log_spaced", "parse_speeds", "uniform"]

# Speeds where a Stribeck curve tells most about its velocity v_s, as multiples of it: the falling branch.
FALLING_BRANCH = (0.35, 2.6)


def log_spaced(low: float, high: float, count: int) -> FloatArray:
    """`count` speeds from `low` to `high` at equal ratios [rad/s] or [m/s]. Shape (count,)."""
    _check(low, high, count)
    return np.geomspace(low, high, count)


def uniform(low: float, high: float, count: int) -> FloatArray:
    """`count` speeds from `low` to `high` at equal distances [rad/s] or [m/s]. Shape (count,)."""
    _check(low, high, count)
    return np.linspace(low, high, count)


def dense_around(stribeck_velocity: float, count: int) -> FloatArray:
    """`count` speeds over the falling branch of a curve with this v_s [rad/s] or [m/s]. Shape (count,)."""
    low, high = FALLING_BRANCH
    return log_spaced(low * stribeck_velocity, high * stribeck_velocity, count)


def parse_speeds(text: str) -> FloatArray:
    """Speeds from words: `log:LOW:HIGH:COUNT`, `uniform:LOW:HIGH:COUNT`, or `0.01,0.02,0.05`. Rising, shape (n,).

    Raises:
        ParameterError: The words are none of these, or a speed is not positive.
    """
    kind, _, rest = text.partition(":")
    try:
        if kind in ("log", "uniform"):
            low, high, count = rest.split(":")
            return (log_spaced if kind == "log" else uniform)(float(low), float(high), int(count))
        speeds = np.unique([float(entry) for entry in text.split(",")])
    except ValueError as error:
        if isinstance(error, ParameterError):
            raise
        raise ParameterError(
            f"speeds {text!r} are none of log:LOW:HIGH:COUNT, uniform:LOW:HIGH:COUNT or a list such as 0.01,0.02,0.05"
        ) from None
    if not (np.all(np.isfinite(speeds)) and speeds[0] > 0.0):
        raise ParameterError(f"speeds must be positive, got {text!r}: both directions are visited at each")
    return speeds


def _check(low: float, high: float, count: int) -> None:
    if not (0.0 < low < high < np.inf and count >= 2):
        raise ParameterError(f"speeds need 0 < low < high and at least two of them, got {low!r}, {high!r}, {count!r}")

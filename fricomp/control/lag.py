"""The velocity that lagging friction follows."""

from __future__ import annotations

from collections.abc import Callable
from math import exp

__all__ = ["build_lag"]


def build_lag(
    lag: float, period: float, velocity_range: tuple[float, float]
) -> tuple[Callable[[float, float], tuple[float, float]], Callable[[], None]]:
    """Low pass of two velocities, exact over a period of constant velocity, and what sets it back to rest.

    Velocities beyond the range count as its ends, so that no single input lasts.

    Args:
        lag: Time constant [s].
        period: Control period [s].
        velocity_range: Of validity [rad/s] or [m/s].
    """
    keep, (low, high) = exp(-period / lag), velocity_range
    first = second = 0.0

    def follow(velocity: float, other: float) -> tuple[float, float]:
        nonlocal first, second
        velocity, other = min(max(velocity, low), high), min(max(other, low), high)
        first = velocity + (first - velocity) * keep
        second = other + (second - other) * keep
        return first, second

    def reset() -> None:
        nonlocal first, second
        first = second = 0.0

    return follow, reset

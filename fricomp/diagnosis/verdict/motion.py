"""The menu of motions of which the next experiment is one, inside the range where the joint has been."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..inputs.track import FloatArray

__all__ = ["MENU", "Range"]


class Range(NamedTuple):
    """Where the recorded joint has been: the motions stay inside.

    Attributes:
        centre: Middle of its positions [rad] or [m].
        half: Half of their range [rad] or [m].
        speed: Speed that it hardly exceeded [rad/s] or [m/s].
    """

    centre: float
    half: float
    speed: float


def _draw_slow_sine(time: FloatArray, reach: Range) -> FloatArray:
    rate = min(0.2 * reach.speed / reach.half, 2 * np.pi * 0.2)
    return np.asarray(reach.half * np.sin(rate * time), dtype=np.float64)


def _draw_fast_sine(time: FloatArray, reach: Range) -> FloatArray:
    return np.asarray(reach.half * np.sin(0.9 * reach.speed / reach.half * time), dtype=np.float64)


def _draw_chirp(time: FloatArray, reach: Range) -> FloatArray:
    low, high = 0.1, 4.0
    rate = np.log(high / low) / time[-1]
    frequency = low * np.exp(rate * time)
    phase = 2 * np.pi * low * (np.exp(rate * time) - 1.0) / rate
    return np.asarray(np.minimum(0.5 * reach.half, reach.speed / (2 * np.pi * frequency)) * np.sin(phase))


def _draw_small_reversals(time: FloatArray, reach: Range) -> FloatArray:
    return np.asarray(0.06 * reach.half * np.sin(2 * np.pi * 0.4 * time) * (1.0 + 3.0 * time / time[-1]))


def _draw_staircase(time: FloatArray, reach: Range) -> FloatArray:
    speeds = reach.speed * np.geomspace(0.01, 1.0, 8)
    v = np.zeros_like(time)
    position, sign, at = 0.0, 1.0, 0
    dt = float(time[1])
    i = 0
    while at < time.size:
        speed = float(speeds[i % 8])
        length = min(time.size - at, int(min(3.0, (reach.half - sign * position) / speed * 0.95) / dt))
        if length < int(0.2 / dt):
            sign = -sign
            length = min(time.size - at, int(0.3 / dt))
        v[at : at + length] = sign * speed
        position += sign * speed * length * dt
        at, i = at + length, i + 1
        if i % 8 == 0:
            sign = -sign
    window = np.hanning(101)
    return np.clip(np.cumsum(np.convolve(v, window / window.sum(), "same")) * dt, -reach.half, reach.half)


MENU: dict[str, Callable[[FloatArray, Range], FloatArray]] = {
    "slow sine over the whole range": _draw_slow_sine,
    "fast sine over the whole range": _draw_fast_sine,
    "chirp from 0.1 to 4 Hz": _draw_chirp,
    "small reversals that grow": _draw_small_reversals,
    "speed staircase in both directions": _draw_staircase,
}
"""Motions by their titles: position about the centre, from time and range."""

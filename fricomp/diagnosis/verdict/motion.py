"""The menu of motions of which the next experiment is one, inside the range where the joint has been."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ..inputs.track import FloatArray
from .settings import EXPERIMENT


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
    rate = min(EXPERIMENT.slow_speed * reach.speed / reach.half, EXPERIMENT.slow_rate)
    return np.asarray(reach.half * np.sin(rate * time), dtype=np.float64)


def _draw_fast_sine(time: FloatArray, reach: Range) -> FloatArray:
    rate = EXPERIMENT.fast_speed * reach.speed / reach.half
    return np.asarray(reach.half * np.sin(rate * time), dtype=np.float64)


def _draw_chirp(time: FloatArray, reach: Range) -> FloatArray:
    low, high = EXPERIMENT.chirp
    rate = np.log(high / low) / time[-1]
    frequency = low * np.exp(rate * time)
    phase = 2 * np.pi * low * (np.exp(rate * time) - 1.0) / rate
    largest = EXPERIMENT.chirp_range * reach.half
    return np.asarray(np.minimum(largest, reach.speed / (2 * np.pi * frequency)) * np.sin(phase))


def _draw_small_reversals(time: FloatArray, reach: Range) -> FloatArray:
    size = EXPERIMENT.reversal_range * reach.half * (1.0 + EXPERIMENT.reversal_growth * time / time[-1])
    return np.asarray(size * np.sin(2 * np.pi * EXPERIMENT.reversal_rate * time))


def _draw_staircase(time: FloatArray, reach: Range) -> FloatArray:
    count, dt = EXPERIMENT.speeds, float(time[1])
    speeds, v = reach.speed * np.geomspace(EXPERIMENT.slowest, 1.0, count), np.zeros_like(time)
    position, sign, at, step = 0.0, 1.0, 0, 0
    while at < time.size:
        speed = float(speeds[step % count])
        way = (reach.half - sign * position) / speed * EXPERIMENT.step_share
        length = min(time.size - at, int(min(EXPERIMENT.longest_step, way) / dt))
        if length < int(EXPERIMENT.shortest_step / dt):
            sign = -sign
            length = min(time.size - at, int(EXPERIMENT.turned_step / dt))
        v[at : at + length] = sign * speed
        position += sign * speed * length * dt
        at, step = at + length, step + 1
        if step % count == 0:
            sign = -sign
    window = np.hanning(EXPERIMENT.smooth_samples)
    return np.clip(np.cumsum(np.convolve(v, window / window.sum(), "same")) * dt, -reach.half, reach.half)


MENU: dict[str, Callable[[FloatArray, Range], FloatArray]] = {
    "slow sine over the whole range": _draw_slow_sine,
    "fast sine over the whole range": _draw_fast_sine,
    "chirp from 0.1 to 4 Hz": _draw_chirp,
    "small reversals that grow": _draw_small_reversals,
    "speed staircase in both directions": _draw_staircase,
}
"""Motions by their titles: position about the centre, from time and range."""

"""The unit of what a call costs: one bare Stribeck curve in pure `math`, timed beside it."""

import math
import time
import timeit
from collections.abc import Callable

import numpy as np


def call_unit() -> None:
    """Compute a Stribeck curve as one writes it down: no smoothing, no limit."""
    _bare_stribeck(0.03)


def _bare_stribeck(velocity: float) -> float:
    speed = abs(velocity)
    level = 0.15 + 0.45 * math.exp(-((speed / 0.05) ** 2)) + 0.02 * speed
    return math.copysign(level, velocity)


def time_beside_unit(call: Callable[[], object], calls: int, repeats: int = 31) -> tuple[float, float]:
    """Time `call` in bursts beside the unit; an empty call is timed as well and taken off both.

    The clock is the thread's own processor time: other work on the machine slows it, but does not count.

    Args:
        call: What is timed.
        calls: In one burst.
        repeats: Bursts.

    Returns:
        Median over the repeats of the mean time of a call [s], and of its ratio to that of the unit [1].
    """
    bursts = [timeit.Timer(body, timer=time.thread_time) for body in (_nothing, call_unit, call)]
    times = np.array([[burst.timeit(calls) / calls for burst in bursts] for _ in range(repeats)])
    overhead = times[:, 0]
    took, base = times[:, 2] - overhead, times[:, 1] - overhead
    return float(np.median(took)), float(np.median(took / base))


def _nothing() -> None:
    pass

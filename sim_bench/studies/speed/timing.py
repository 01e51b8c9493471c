"""Processor time of a call, in units of a fixed amount of arithmetic timed beside it on the same machine.

Processor time leaves out what other work on the machine takes, and the unit what the machine is: a ratio is the same on
a fast and on a slow one, but for caches and widths of vectors.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricomp.diagnosis.joint.observer import count_joints

_NUMBERS, _PASSES = 1_000_000, 10
"""The unit is so many exponentials, so many times: some hundredths of a second."""


@dataclass(frozen=True)
class Timing:
    """What one call took.

    Attributes:
        group: Timings whose sizes grow, such as `diagnosis: samples`.
        name: What was called.
        size: Of what is given to it, in the group's measure.
        seconds: Processor time of all threads [s].
        wall: Time that passed, which other work on the machine lengthens [s].
        units: Processor time over that of the unit [1].
        joints: Number of joints that were simulated; 0 where none is.
    """

    group: str
    name: str
    size: float
    seconds: float
    wall: float
    units: float
    joints: int = 0


@dataclass(frozen=True)
class Growth:
    """How the timings of a group grow.

    Attributes:
        group: Its name.
        exponent: Power of the size; 1 where it is linear.
        timings: Smallest size first.
    """

    group: str
    exponent: float
    timings: tuple[Timing, ...]


def measure_unit() -> float:
    """Processor time of the unit [s]; the shortest of three, since nothing makes arithmetic shorter."""
    values = np.linspace(-5.0, 5.0, _NUMBERS)
    times = []
    for _ in range(3):
        start = time.process_time()
        for _ in range(_PASSES):
            np.exp(values)
        times.append(time.process_time() - start)
    return min(times)


def time_call(group: str, name: str, size: float, call: Callable[[], object]) -> Timing:
    """Call once, and time it between two units."""
    before = measure_unit()
    with count_joints() as counted:
        start, begin = time.perf_counter(), time.process_time()
        call()
        seconds, wall = time.process_time() - begin, time.perf_counter() - start
    unit = 0.5 * (before + measure_unit())
    return Timing(group, name, size, seconds, wall, seconds / unit, counted.joints)


def fit_growth(timings: list[Timing]) -> list[Growth]:
    """The growth of each group of two timings or more, by least squares over the logarithms."""
    groups: dict[str, list[Timing]] = {}
    for one in timings:
        groups.setdefault(one.group, []).append(one)
    found = []
    for group, members in groups.items():
        ordered = tuple(sorted(members, key=lambda one: one.size))
        sizes = np.log([one.size for one in ordered])
        if len(ordered) > 1 and np.ptp(sizes) > 0.0:
            slope = float(np.polyfit(sizes, np.log([max(one.units, 1e-6) for one in ordered]), 1)[0])
            found.append(Growth(group, slope, ordered))
    return found

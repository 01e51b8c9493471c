"""How much faster several workers are than one, on the same cases."""

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from fricomp.fleet import open_executor

from ...cases import CaseSpec
from ..kit.blind import Diagnose, diagnose_blind
from ..real.injection import InjectedSpec
from .making import prepare
from .plan import PlannedCase

_TURNS = 20_000_000
"""Turns of a plain loop by which the cores themselves are timed: about a second."""


@dataclass(frozen=True)
class SpeedUp:
    """Time of the same work with one worker and with several, case by case.

    Attributes:
        workers: How many at once.
        one: Time of one worker for as many copies of each case as there are workers [s]. Its diagnosis has two threads,
            so that it keeps a second core busy for part of the time.
        one_core: The same while the worker is kept to one core [s]; what a second worker with a core of its own adds is
            measured against this.
        several: Time of the workers for them, each with one copy [s].
        loops: The ratio of both times for plain loops that share neither memory nor files, measured after each case:
            what the cores themselves give.
        load: Load average of the last minute before the first case; other work on the machine lowers the ratio.
        cores: That this process may use.
    """

    workers: int
    one: tuple[float, ...]
    one_core: tuple[float, ...]
    several: tuple[float, ...]
    loops: tuple[float, ...]
    load: float
    cores: int

    @property
    def ratio(self) -> float:
        """Median over the cases of the time of one worker with one core over that of several with as many."""
        return float(np.median(_divide(self.one_core, self.several)))

    @property
    def ratio_free(self) -> float:
        """The same where one worker may use every core."""
        return float(np.median(_divide(self.one, self.several)))

    def __str__(self) -> str:
        low, high = np.quantile(_divide(self.one_core, self.several), (0.25, 0.75))
        return (
            f"{self.workers} workers are {self.ratio:.2f} times as fast as one that has one core (median of "
            f"{len(self.one)} cases, quartiles {low:.2f} to {high:.2f}; {sum(self.one_core):.0f} s and "
            f"{sum(self.several):.0f} s in all), and {self.ratio_free:.2f} times as fast as one that may use all "
            f"{self.cores} ({sum(self.one):.0f} s), with a load average of {self.load:.2f} before; plain loops that "
            f"share nothing are {np.median(self.loops):.2f} times as fast there"
        )


def _divide(one: Sequence[float], several: Sequence[float]) -> NDArray[np.float64]:
    return np.divide(one, several)


def measure_speed_up(
    planned: Sequence[PlannedCase],
    workers: int = 2,
    *,
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[], None] = lambda: None,
) -> SpeedUp:
    """Make and diagnose each case several times, one after the other and side by side.

    The times of a case follow each other, and which is first alternates: on a machine that others share, whole runs
    one after the other have given 1.56 and 2.05 for the same work.

    Args:
        planned: The cases; those that cannot be made are left out.
        workers: At once.
        diagnose: What runs for a case.
        progress: Called after each case.
    """
    load = os.getloadavg()[0]
    times: list[list[float]] = []
    loops: list[float] = []
    with open_executor(f"processes://{workers}") as (pool, _):
        list(pool.map(_count, [1] * workers))  # they have started
        for index, each in enumerate(planned):
            if not prepare(each.spec, "speed").refused:
                case = partial(_do_case, each.spec, diagnose)
                free, confined = (
                    partial(_time_alone, pool, workers, way) for way in (case, partial(_call_on_one_core, case))
                )
                times.append(
                    _call_in_turn((free, confined, partial(_time_together, pool, workers, case)), index % 2 == 1)
                )
                loop = partial(_count, _TURNS)
                ways = partial(_time_alone, pool, workers, loop), partial(_time_together, pool, workers, loop)
                alone, together = _call_in_turn(ways, index % 2 == 1)
                loops.append(alone / together)
            progress()
    cores = len(os.sched_getaffinity(0))
    one, one_core, several = (tuple(each[way] for each in times) for way in range(3))
    return SpeedUp(workers, one, one_core, several, tuple(loops), load, cores)


def _call_in_turn(ways: Sequence[Callable[[], float]], backwards: bool) -> list[float]:
    """What each call gives, called in this order or in the reverse one."""
    if backwards:
        return [way() for way in reversed(ways)][::-1]
    return [way() for way in ways]


def _time_alone(pool: Executor, workers: int, call: Callable[[], object]) -> float:
    """Time of so many calls one after the other [s]."""
    start = time.perf_counter()
    for _ in range(workers):
        pool.submit(call).result()
    return time.perf_counter() - start


def _time_together(pool: Executor, workers: int, call: Callable[[], object]) -> float:
    """Time of so many calls side by side [s]."""
    start = time.perf_counter()
    for future in [pool.submit(call) for _ in range(workers)]:
        future.result()
    return time.perf_counter() - start


def _call_on_one_core(call: Callable[[], object]) -> None:
    """Call with one core for this process and those that it starts."""
    cores = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(cores)})
    try:
        call()
    finally:
        os.sched_setaffinity(0, cores)


def _do_case(spec: CaseSpec | InjectedSpec, diagnose: Diagnose) -> None:
    diagnose(prepare(spec, "speed").files)


def _count(turns: int) -> int:
    total = 0
    for turn in range(turns):
        total += turn
    return total

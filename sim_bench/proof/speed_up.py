"""How much faster several workers are than one, on the same cases."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..concealed import CaseSpec
from ..fleet import open_executor
from ..real.injection import InjectedSpec
from .blind import diagnose_blind, prepare
from .plan import PlannedCase
from .run import Diagnose

__all__ = ["SpeedUp", "measure_speed_up"]

_TURNS = 20_000_000  # of a plain loop by which the cores themselves are timed, about a second


@dataclass(frozen=True)
class SpeedUp:
    """Time of the same work with one worker and with several, case by case.

    Attributes:
        workers: How many at once.
        one: Time of one worker for as many copies of each case as there are workers [s].
        several: Time of the workers for them, each with one copy [s].
        loops: The ratio of both times for plain loops that share neither memory nor files, measured after each case:
            what the cores themselves give.
        load: Load average of the last minute before the first case; other work on the machine lowers the ratio.
        cores: That this process may use.
    """

    workers: int
    one: tuple[float, ...]
    several: tuple[float, ...]
    loops: tuple[float, ...]
    load: float
    cores: int

    @property
    def ratio(self) -> float:
        """Median over the cases of one worker's time over that of several."""
        return float(np.median(self._ratios))

    @property
    def _ratios(self) -> NDArray[np.float64]:
        return np.divide(self.one, self.several)

    def __str__(self) -> str:
        low, high = np.quantile(self._ratios, (0.25, 0.75))
        return (
            f"{self.workers} workers are {self.ratio:.2f} times as fast as one (median of {len(self.one)} cases, "
            f"quartiles {low:.2f} to {high:.2f}; {sum(self.one):.0f} s and {sum(self.several):.0f} s in all) on "
            f"{self.cores} cores, with a load average of {self.load:.2f} before; plain loops that share nothing are "
            f"{np.median(self.loops):.2f} times as fast there"
        )


def measure_speed_up(
    planned: Sequence[PlannedCase],
    workers: int = 2,
    *,
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[], None] = lambda: None,
) -> SpeedUp:
    """Make and diagnose each case several times, one after the other and side by side.

    Both times of a case follow each other, and which is first alternates: on a machine that others share, whole runs
    one after the other have given 1.56 and 2.05 for the same work.

    Args:
        planned: The cases; those that cannot be made are left out.
        workers: At once.
        diagnose: What runs for a case.
        progress: Called after each case.
    """
    load = os.getloadavg()[0]
    one, several, loops = [], [], []
    with open_executor(f"processes://{workers}") as (pool, _):
        list(pool.map(_loop, [1] * workers))  # they have started
        for index, each in enumerate(planned):
            if not prepare(each.spec, "speed").refused:
                alone, together = _times(pool, workers, index % 2 == 1, _whole, each.spec, diagnose)
                one.append(alone)
                several.append(together)
                alone, together = _times(pool, workers, index % 2 == 1, _loop, _TURNS)
                loops.append(alone / together)
            progress()
    return SpeedUp(workers, tuple(one), tuple(several), tuple(loops), load, len(os.sched_getaffinity(0)))


def _times(
    pool: Executor, workers: int, together_first: bool, call: Callable[..., object], *arguments: object
) -> tuple[float, float]:
    """Time of so many calls one after the other, and side by side [s]."""

    def alone() -> float:
        start = time.perf_counter()
        for _ in range(workers):
            pool.submit(call, *arguments).result()
        return time.perf_counter() - start

    def together() -> float:
        start = time.perf_counter()
        for future in [pool.submit(call, *arguments) for _ in range(workers)]:
            future.result()
        return time.perf_counter() - start

    if together_first:
        second, first = together(), alone()
        return first, second
    return alone(), together()


def _whole(spec: CaseSpec | InjectedSpec, diagnose: Diagnose) -> None:
    diagnose(prepare(spec, "speed").files)


def _loop(turns: int) -> int:
    total = 0
    for turn in range(turns):
        total += turn
    return total

"""How much faster two workers are than one, on the same cases, one run after the other."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from ..fleet import open_executor
from .blind import diagnose_blind
from .plan import PlannedCase
from .run import Diagnose, run_proof

__all__ = ["SpeedUp", "measure_speed_up"]

_LOOPS, _TURNS = 4, 10_000_000  # plain loops by which the cores themselves are timed, about half a second each


@dataclass(frozen=True)
class SpeedUp:
    """Time of the same cases with one worker and with several.

    Attributes:
        cases: How many.
        workers: Of the second run.
        seconds: Wall-clock time of either run, start of the workers included [s].
        load: Load average of the last minute before either run; other work on the machine lowers the ratio.
        cores: Of the machine.
        loops: The same ratio for plain loops that share neither memory nor files: what the cores themselves give.
    """

    cases: int
    workers: int
    seconds: tuple[float, float]
    load: tuple[float, float]
    cores: int
    loops: float

    @property
    def ratio(self) -> float:
        """Time of one worker over time of several."""
        return self.seconds[0] / self.seconds[1]

    def __str__(self) -> str:
        return (
            f"{self.workers} workers are {self.ratio:.2f} times as fast as one: {self.seconds[0]:.1f} s and "
            f"{self.seconds[1]:.1f} s for {self.cases} cases on {self.cores} cores; load average "
            f"{self.load[0]:.2f} before the first run, {self.load[1]:.2f} before the second; plain loops that share "
            f"nothing are {self.loops:.2f} times as fast there"
        )


def measure_speed_up(
    planned: Sequence[PlannedCase],
    workers: int = 2,
    *,
    kind: str = "processes",
    diagnose: Diagnose = diagnose_blind,
    progress: Callable[[], None] = lambda: None,
) -> SpeedUp:
    """Run the cases with one worker, then with several, each in a folder that is thrown away.

    Args:
        planned: The cases; an even number of like ones, so that no worker is idle at the end.
        workers: Of the second run.
        kind: `processes` or `dask://local`.
        diagnose: What runs for a case.
        progress: Called after each case.
    """
    seconds, load = [], []
    join = "://" if kind == "processes" else ":"
    for count in (1, workers):
        load.append(os.getloadavg()[0])
        start = time.perf_counter()
        with TemporaryDirectory() as place, open_executor(f"{kind}{join}{count}") as pool:
            run_proof(planned, Path(place), pool, salt="speed", diagnose=diagnose, progress=lambda _: progress())
        seconds.append(time.perf_counter() - start)
    loops = _time_loops(1) / _time_loops(workers)
    cores = len(os.sched_getaffinity(0))
    return SpeedUp(len(planned), workers, (seconds[0], seconds[1]), (load[0], load[1]), cores, loops)


def _time_loops(workers: int) -> float:
    """Time of plain loops on `workers` processes that have started before [s]."""
    with open_executor(f"processes://{workers}") as (pool, _):
        list(pool.map(_loop, [1] * workers))
        start = time.perf_counter()
        list(pool.map(_loop, [_TURNS] * _LOOPS))
        return time.perf_counter() - start


def _loop(turns: int) -> int:
    total = 0
    for turn in range(turns):
        total += turn
    return total

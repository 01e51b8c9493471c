"""Processor time of every method, one after another in one process, so that a shared machine does not count."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from ..identification import IdentificationOptions, identify
from .adam import run_adam
from .comparators import run_cma
from .ledger import Ledger
from .problem import NOISE_READINGS, Draw, PaperProblem, Reading
from .rivals import CMA_EVALUATIONS, PAPER_LENGTH
from .study import random_start

__all__ = ["OURS", "TimeFigures", "run_timing", "summarise_timing"]

OURS = "fricomp, PINN"
_SLICES = 10
"""A search or a training of steps that are all alike is timed over this fraction of its length."""
_REPEATS = 20


@dataclass(frozen=True)
class TimeFigures:
    """Processor time of one method on one kind of data.

    Attributes:
        method: Its name.
        reading: Noise of the data.
        length: Iterations, evaluations or steps; 0 where the method ends by itself.
        seconds: Of one thread [s]; the median where there were several runs.
    """

    method: str
    reading: str
    length: int
    seconds: float


def run_timing(ledger: Ledger, length: int, progress: Callable[[str], None]) -> None:
    """Time every method on draw 0 of each reading, ours on several draws.

    Args:
        ledger: Where figures are kept.
        length: Iterations of PSO, GA and Adam; 50,000 in the paper.
        progress: Told what is under way.
    """
    readings: tuple[Reading, ...] = ("none", *NOISE_READINGS)
    for number, reading in enumerate(readings):
        if not ledger.rows(study="timing", seed=number, size=length):
            progress(f"processor times, {reading} noise")
            figures = [asdict(f) for f in _measure(reading, length)]
            ledger.append({"study": "timing", "seed": number, "size": length, "figures": figures})


def summarise_timing(ledger: Ledger) -> list[TimeFigures]:
    """The figures in the ledger of the greatest length; empty without any."""
    rows = ledger.rows(study="timing")
    length = max((int(row["size"]) for row in rows), default=0)
    return [TimeFigures(**figures) for row in rows if row["size"] == length for figures in row["figures"]]


def _measure(reading: Reading, length: int) -> list[TimeFigures]:
    from .compiled_search import run_compiled

    draw, part = PaperProblem().draw(reading, 0), length // _SLICES
    ours = [_seconds(lambda s=s: _identify(reading, s, "pinn")) for s in range(_REPEATS)]  # type: ignore[misc]
    plain = [_seconds(lambda s=s: _identify(reading, s, "least_squares")) for s in range(_REPEATS)]  # type: ignore[misc]
    run_compiled("PSO", draw, 2, 0), run_compiled("GA", draw, 2, 0)  # compiled before they are timed
    sliced: dict[str, Callable[[], Any]] = {
        "PSO, compiled": lambda: run_compiled("PSO", draw, part, 0),
        "GA, compiled": lambda: run_compiled("GA", draw, part, 0),
        "Adam": lambda: run_adam(draw, "true values", part),
    }
    return [
        TimeFigures(OURS, reading, 0, float(np.median(ours))),
        TimeFigures("fricomp, least squares", reading, 0, float(np.median(plain))),
        *(TimeFigures(name, reading, length, _SLICES * _seconds(work)) for name, work in sliced.items()),
        *_cma(draw, CMA_EVALUATIONS * length // PAPER_LENGTH),
    ]


def _cma(draw: Draw, evaluations: int) -> list[TimeFigures]:
    """None without noise: there it ends when it meets the data, long before its length."""
    if draw.reading == "none":
        return []
    return [TimeFigures("CMA-ES", draw.reading, evaluations, _seconds(lambda: run_cma(draw, evaluations, 0)))]


def _identify(reading: Reading, seed: int, method: Any) -> None:
    draw = PaperProblem().draw(reading, seed)
    options = random_start(seed) if reading == "none" else IdentificationOptions()
    noise = "absolute" if reading == "none" else reading
    identify(draw.velocity, draw.torque, method=method, noise=noise, seed=seed, options=options)


def _seconds(work: Callable[[], Any]) -> float:
    begun = time.process_time()
    work()
    return time.process_time() - begun

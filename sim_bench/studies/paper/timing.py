"""Processor time of every method, one after another in one process, so that a shared machine does not count."""

import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from fricomp.calibration.identification import IdentificationOptions, identify

from ..kit.store import RowStore
from .adam import run_adam
from .comparators import Comparison, run_cma
from .oracle import find_optimum
from .problem import NOISE_READINGS, Draw, PaperProblem, Reading
from .rivals import CMA_EVALUATIONS, PAPER_LENGTH
from .study import SPREADS, draw_random_start, draw_random_values

OURS = "fricomp, PINN"
_SLICES = 10
"""A search or a training of steps that are all alike is timed over this fraction of its length."""
_REPEATS = 20
_SEARCHES = 5
"""Draws on which a search is timed."""
_GAP = 0.01
_FREE_ERROR = 1e-3
"""At the optimum within this likelihood [nats], or without noise with this mean error [%]."""


@dataclass(frozen=True)
class TimeFigures:
    """Processor time of one method on one kind of data.

    Attributes:
        method: Its name.
        reading: Noise of the data.
        length: Iterations, evaluations or steps; 0 where the method ends by itself.
        seconds: Of one thread [s]; the median where there were several runs.
        seconds_to_optimum: The same until its best is within 0.01 nats of the oracle's optimum, without noise until
            the mean error is below 1e-3 %; None where half of the runs or more did not get there, or none was asked.
    """

    method: str
    reading: str
    length: int
    seconds: float
    seconds_to_optimum: float | None = None


def run_timing(ledger: RowStore, length: int, progress: Callable[[str], None]) -> None:
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


def summarise_timing(ledger: RowStore) -> list[TimeFigures]:
    """The figures in the ledger of the greatest length; empty without any."""
    rows = ledger.rows(study="timing")
    length = max((int(row["size"]) for row in rows), default=0)
    return [TimeFigures(**figures) for row in rows if row["size"] == length for figures in row["figures"]]


def _measure(reading: Reading, length: int) -> list[TimeFigures]:
    from .compiled_search import run_compiled

    draw, part = PaperProblem().draw(reading, 0), length // _SLICES
    ours = [_compute_seconds(lambda s=s: _identify(reading, s, "pinn")) for s in range(_REPEATS)]  # type: ignore[misc]
    plain = [_compute_seconds(lambda s=s: _identify(reading, s, "least_squares")) for s in range(_REPEATS)]  # type: ignore[misc]
    run_compiled("PSO", draw, 2, 0), run_compiled("GA", draw, 2, 0)  # compiled before they are timed
    start, evaluations = draw_random_values(0, SPREADS[1])[None], CMA_EVALUATIONS * length // PAPER_LENGTH
    searches = [
        _search(f"{name}, compiled", reading, length, part, lambda d, n, s, name=name: run_compiled(name, d, n, s))  # type: ignore[misc]
        for name in ("PSO", "GA")
    ]
    if reading != "none":  # without noise it ends when it meets the data, long before its length
        searches.append(_search("CMA-ES", reading, evaluations, evaluations, run_cma))
    return [
        TimeFigures(OURS, reading, 0, float(np.median(ours))),
        TimeFigures("fricomp, least squares", reading, 0, float(np.median(plain))),
        *searches,
        TimeFigures("Adam", reading, length, _SLICES * _compute_seconds(lambda: run_adam(draw, start, part))),
    ]


def _search(
    name: str, reading: Reading, length: int, part: int, run: Callable[[Draw, int, int], Comparison]
) -> TimeFigures:
    """Of `length`, timed over `part` of it on a few draws, and seen there when it gets to the optimum."""
    seconds, reached = [], []
    for seed in range(_SEARCHES):
        draw, begun = PaperProblem().draw(reading, seed), time.process_time()
        found = run(draw, part, seed)
        seconds.append(time.process_time() - begun)
        there = np.flatnonzero(_find_at_optimum(found, draw))
        reached.append(seconds[-1] * (found.fitness[there[0], 0] + 1.0) / part if len(there) else np.inf)
    middle = float(np.median(reached))
    whole = float(np.median(seconds)) * length / part
    return TimeFigures(name, reading, length, whole, middle if np.isfinite(middle) else None)


def _find_at_optimum(found: Comparison, draw: Draw) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Of each recorded iteration."""
    if draw.reading == "none":
        return np.array([PaperProblem().compute_mean_error(values) <= _FREE_ERROR for values in found.course])
    return np.asarray(found.fitness[:, 1] <= find_optimum(draw).negative_log_likelihood + _GAP)


def _identify(reading: Reading, seed: int, method: Any) -> None:
    draw = PaperProblem().draw(reading, seed)
    options = draw_random_start(seed) if reading == "none" else IdentificationOptions()
    noise = "absolute" if reading == "none" else reading
    identify(draw.velocity, draw.torque, method=method, noise=noise, seed=seed, options=options)


def _compute_seconds(work: Callable[[], Any]) -> float:
    begun = time.process_time()
    work()
    return time.process_time() - begun

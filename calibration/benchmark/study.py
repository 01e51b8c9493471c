"""Our own figures over many seeds, kept in the ledger draw by draw."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from fricomp.laws import FloatArray

from ..identification import identify
from .ledger import Ledger
from .oracle import find_optimum
from .problem import NOISE_READINGS, Draw, PaperProblem, Reading

__all__ = [
    "contaminate",
    "random_start",
    "run_departure",
    "run_extras",
    "run_loads",
    "run_noise_free",
    "run_outliers",
    "run_statistics",
]

Progress = Callable[[str], None]


def run_statistics(ledger: Ledger, draws: int, progress: Progress) -> None:
    """Our PINN and the oracle on `draws` draws of each noise reading."""
    problem = PaperProblem()
    for reading in NOISE_READINGS:
        for seed in ledger.missing(range(draws), study="statistics", reading=reading):
            ledger.append({"study": "statistics"} | _one_draw(problem.draw(reading, seed), reading))
            progress(f"statistics, {reading} noise, draw {seed + 1} of {draws}")


def _one_draw(draw: Draw, reading: Reading) -> dict[str, Any]:
    begun = time.perf_counter()
    result = identify(draw.velocity, draw.torque, noise=reading, seed=draw.seed)
    seconds = time.perf_counter() - begun
    best = find_optimum(draw)
    return {
        "reading": reading,
        "seed": draw.seed,
        "status": result.status,
        "values": list(result.parameters.values()),
        "deviations": list(result.standard_deviations.values()),
        "nll": result.negative_log_likelihood,
        "oracle": best.values,
        "oracle_nll": best.negative_log_likelihood,
        "seconds": seconds,
    }


def run_noise_free(ledger: Ledger, starts: int, progress: Progress) -> None:
    """The paper's 41 points without noise from random parameters and random network weights."""
    problem = PaperProblem()
    draw = problem.draw("none", 0)
    for seed in ledger.missing(range(starts), study="noise_free"):
        begun = time.perf_counter()
        result = identify(draw.velocity, draw.torque, noise="absolute", seed=seed, options=random_start(seed))
        ledger.append(
            {
                "study": "noise_free",
                "seed": seed,
                "status": result.status,
                "values": list(result.parameters.values()),
                "seconds": time.perf_counter() - begun,
            }
        )
        progress(f"noise-free, start {seed + 1} of {starts}")


def random_start(seed: int) -> Any:
    """Parameters anywhere within a factor of thirty of the search box's middle, as options of `identify`."""
    from ..identification import IdentificationOptions
    from .problem import UPPER_BOUNDS

    rng = np.random.default_rng([seed, 41])
    values = UPPER_BOUNDS / 2.0 * np.exp(rng.uniform(-np.log(30.0), np.log(30.0), 8))
    names = PaperProblem().form.names
    return IdentificationOptions(start=dict(zip(names, values.tolist(), strict=True)))


def run_outliers(ledger: Ledger, draws: int, progress: Progress) -> None:
    """One point in ten off by ten standard deviations, robust loss."""
    problem = PaperProblem()
    for reading in NOISE_READINGS:
        for seed in ledger.missing(range(draws), study="outliers", reading=reading):
            draw, clean = contaminate(problem.draw(reading, seed), problem)
            begun = time.perf_counter()
            result = identify(draw.velocity, draw.torque, noise=reading, seed=seed, loss="robust")
            limit = problem.cramer_rao(reading, kept=clean[draw.velocity != 0.0].astype(np.float64))
            ledger.append(
                {
                    "study": "outliers",
                    "reading": reading,
                    "seed": seed,
                    "status": result.status,
                    "values": list(result.parameters.values()),
                    "limit": limit,
                    "seconds": time.perf_counter() - begun,
                }
            )
            progress(f"outliers, {reading} noise, draw {seed + 1} of {draws}")


def run_departure(ledger: Ledger, seeds: int, progress: Progress) -> None:
    """Where the joint is no Stribeck joint."""
    from .departure import CASES, measure_departure

    for number, (case, points) in enumerate(CASES):
        if not ledger.rows(study="departure", seed=number, size=seeds):
            progress(f"departure from the law: {case}, {points} points")
            figures = asdict(measure_departure(case, points, seeds))
            ledger.append({"study": "departure", "seed": number, "size": seeds, "figures": figures})


def run_loads(ledger: Ledger, seeds: int, progress: Progress) -> None:
    """The same at several normal loads."""
    from .load_departure import LOAD_CASES, measure_loads

    for number, (case, points) in enumerate(LOAD_CASES):
        if not ledger.rows(study="loads", seed=number, size=seeds):
            progress(f"several loads: {case}, {points} points each")
            figures = asdict(measure_loads(case, points, seeds))
            ledger.append({"study": "loads", "seed": number, "size": seeds, "figures": figures})


def run_extras(ledger: Ledger, draws: int, lugre_seeds: int, progress: Progress) -> None:
    """Speeds chosen for information, and LuGre."""
    from .extras import measure_extras

    if not ledger.rows(study="further", size=draws):
        progress("speeds chosen for information, LuGre")
        figures = asdict(measure_extras(draws, lugre_seeds))
        ledger.append({"study": "further", "seed": 0, "size": draws, "figures": figures})


def contaminate(draw: Draw, problem: PaperProblem) -> tuple[Draw, FloatArray]:
    """`draw` with a tenth of its moving points off by ten standard deviations, and which points are clean."""
    rng = np.random.default_rng([draw.seed, 10])
    torque = draw.torque.copy()
    exact = np.asarray(problem.law.torque(draw.velocity))
    moving = np.flatnonzero(draw.velocity)
    hit = rng.choice(moving, len(moving) // 10, replace=False)
    torque[hit] += 10.0 * problem.deviation(draw.reading, exact)[hit] * rng.choice([-1.0, 1.0], len(hit))
    clean = np.ones(len(torque), dtype=bool)
    clean[hit] = False
    return Draw(draw.velocity, torque, draw.reading, draw.seed), np.asarray(clean)

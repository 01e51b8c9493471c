"""Our own figures over many seeds, kept in the ledger draw by draw."""

import time
from collections.abc import Callable, Mapping
from dataclasses import asdict
from functools import partial
from typing import Any

import numpy as np

from fricomp.calibration.identification import IdentificationOptions, IdentificationResult, identify
from fricomp.calibration.identification.estimation.likelihood import Noise
from fricomp.calibration.identification.estimation.optimum import optimum_at
from fricomp.calibration.identification.estimation.pinn import train_pinn
from fricomp.laws import FloatArray

from ..kit.store import RowStore
from .oracle import find_optimum
from .problem import NOISE_READINGS, UPPER_BOUNDS, Draw, PaperProblem, Reading

Progress = Callable[[str], None]
SPREADS = (30.0, 3.0)
"""Factors within which random starts lie."""


def run_statistics(ledger: RowStore, draws: int, progress: Progress) -> None:
    """Our PINN and the oracle on `draws` draws of each noise reading."""
    problem = PaperProblem()
    for reading in NOISE_READINGS:
        for seed in ledger.find_missing(range(draws), study="statistics", reading=reading):
            ledger.append({"study": "statistics"} | _run_one_draw(problem.draw(reading, seed), reading))
            progress(f"statistics, {reading} noise, draw {seed + 1} of {draws}")


def _run_one_draw(draw: Draw, reading: Reading) -> dict[str, Any]:
    begun = time.perf_counter()
    result = identify(draw.velocity, draw.torque, noise=reading, seed=draw.seed)
    seconds = time.perf_counter() - begun
    best = find_optimum(draw)
    return {
        "reading": reading,
        "seed": draw.seed,
        "status": result.status,
        "start": _start_of(result),
        "values": list(result.parameters.values()),
        "deviations": list(result.standard_deviations.values()),
        "nll": result.negative_log_likelihood,
        "oracle": best.values,
        "oracle_nll": best.negative_log_likelihood,
        "seconds": seconds,
    }


def run_noise_free(ledger: RowStore, starts: int, progress: Progress) -> None:
    """The paper's 41 points without noise from random parameters and random network weights."""
    draw = PaperProblem().draw("none", 0)
    for seed in ledger.find_missing(range(starts), study="noise_free"):
        begun = time.perf_counter()
        result = identify(draw.velocity, draw.torque, noise="absolute", seed=seed, options=draw_random_start(seed))
        ledger.append(
            {
                "study": "noise_free",
                "seed": seed,
                "status": result.status,
                "start": _start_of(result),
                "values": list(result.parameters.values()),
                "seconds": time.perf_counter() - begun,
            }
        )
        progress(f"noise-free, start {seed + 1} of {starts}")


def run_as_given(ledger: RowStore, starts: int, progress: Progress) -> None:
    """The same training alone, all eight parameters starting as they are drawn: no projection, nothing to fall back on.

    From the starts that the paper's Adam has too, of both spreads.
    """
    problem = PaperProblem()
    draw, noise = problem.draw("none", 0), Noise("absolute")
    for spread in SPREADS:
        for seed in ledger.find_missing(range(starts), study="as_given", spread=spread):
            start = optimum_at(np.log(draw_random_values(seed, spread)), problem.form, draw.points, noise)
            trained = train_pinn(problem.form, draw.points, start, seed=seed)
            values = np.exp(trained.optimum.logs)
            ledger.append({"study": "as_given", "spread": spread, "seed": seed, "values": values})
            progress(f"noise-free, as given within a factor of {spread:g}, start {seed + 1} of {starts}")


def _start_of(result: IdentificationResult) -> str:
    """From where the training began that gave the result."""
    assert result.traces is not None
    return result.traces.start


def draw_random_start(seed: int) -> IdentificationOptions:
    """`draw_random_values` of the wider spread as options of `identify`."""
    names = PaperProblem().form.names
    return IdentificationOptions(start=dict(zip(names, draw_random_values(seed, SPREADS[0]).tolist(), strict=True)))


def draw_random_values(seed: int, spread: float) -> FloatArray:
    """Parameters anywhere within a factor of `spread` of the search box's middle, F_s above F_c. Shape (8,).

    Where both are equal no loss has a slope in the Stribeck velocity.
    """
    rng = np.random.default_rng([seed, 41])
    values = UPPER_BOUNDS / 2.0 * np.exp(rng.uniform(-np.log(spread), np.log(spread), 8))
    for dry in (slice(0, 2), slice(4, 6)):
        values[dry] = np.sort(values[dry])
    return np.asarray(values)


def run_outliers(ledger: RowStore, draws: int, progress: Progress) -> None:
    """One point in ten off by ten standard deviations, robust loss."""
    problem = PaperProblem()
    for reading in NOISE_READINGS:
        for seed in ledger.find_missing(range(draws), study="outliers", reading=reading):
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
                    "deviations": list(result.standard_deviations.values()),
                    "limit": limit,
                    "seconds": time.perf_counter() - begun,
                }
            )
            progress(f"outliers, {reading} noise, draw {seed + 1} of {draws}")


def run_departure(ledger: RowStore, seeds: int, progress: Progress) -> None:
    """Where the joint is no Stribeck joint."""
    from .departure import CASES, measure_departure

    calls = {f"departure from the law: {case}, {n} points": partial(measure_departure, case, n) for case, n in CASES}
    _measure_once(ledger, "departure", seeds, calls, progress)


def run_loads(ledger: RowStore, seeds: int, progress: Progress) -> None:
    """The same at several normal loads."""
    from .load_departure import LOAD_CASES, measure_loads

    calls = {f"several loads: {case}, {n} points each": partial(measure_loads, case, n) for case, n in LOAD_CASES}
    _measure_once(ledger, "loads", seeds, calls, progress)


def run_extras(ledger: RowStore, draws: int, lugre_seeds: int, progress: Progress) -> None:
    """Speeds chosen for information, and LuGre."""
    from .extras import measure_extras

    calls = {"speeds chosen for information, LuGre": partial(measure_extras, lugre_seeds=lugre_seeds)}
    _measure_once(ledger, "further", draws, calls, progress)


def _measure_once(
    ledger: RowStore, study: str, size: int, calls: Mapping[str, Callable[[int], Any]], progress: Progress
) -> None:
    """Keep what each call gives for this size, unless the ledger has it; they are known by their order."""
    for number, (what, call) in enumerate(calls.items()):
        if not ledger.rows(study=study, seed=number, size=size):
            progress(what)
            ledger.append({"study": study, "seed": number, "size": size, "figures": asdict(call(size))})


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

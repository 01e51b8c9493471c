"""Our own figures over many seeds, kept on disk draw by draw so that a long run can go on where it stopped."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.laws import FloatArray

from ..identification import identify
from .comparators import Comparison, run_cma, run_robust_nls
from .oracle import find_optimum
from .problem import NOISE_READINGS, Draw, PaperProblem, Reading

__all__ = [
    "Ledger",
    "contaminate",
    "random_start",
    "run_adam_study",
    "run_departure",
    "run_extras",
    "run_noise_free",
    "run_optima",
    "run_outliers",
    "run_searches",
    "run_statistics",
]

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Ledger:
    """A file of JSON lines, one a finished draw.

    Attributes:
        path: The file.
    """

    path: Path

    def rows(self, **wanted: object) -> list[dict[str, Any]]:
        """The lines whose fields equal `wanted`, ordered by seed."""
        if not self.path.exists():
            return []
        lines = [json.loads(line) for line in self.path.read_text().splitlines() if line.endswith("}")]
        rows = [line for line in lines if all(line.get(k) == v for k, v in wanted.items())]
        return sorted(rows, key=lambda row: int(row["seed"]))

    def missing(self, seeds: range, **wanted: object) -> Iterator[int]:
        """The seeds without a line."""
        done = {row["seed"] for row in self.rows(**wanted)}
        return iter(seed for seed in seeds if seed not in done)

    def append(self, row: dict[str, Any]) -> None:
        """Add a finished draw."""
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a") as file:
            file.write(json.dumps(row, default=lambda a: np.asarray(a).tolist()) + "\n")


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


def run_searches(ledger: Ledger, full: int, tenth: int, progress: Progress) -> None:
    """PSO and GA at the paper's 50,000 iterations on `full` draws and at 5,000 on `tenth`, and what else there is.

    Order: one draw at full length, then ten at a tenth, so that a run that is cut short has some of both.
    """
    lengths = [(seed, 50_000) for seed in range(full)]
    short = [(seed, 5_000) for seed in range(tenth)]
    plan: list[tuple[int, int]] = []
    while lengths or short:
        plan += lengths[:1] + short[:10]
        lengths, short = lengths[1:], short[10:]
    problem = PaperProblem()
    for seed, iterations in plan:
        for reading in NOISE_READINGS:
            draw = problem.draw(reading, seed)
            for method in ("PSO", "GA"):
                _compare(ledger, draw, (method, iterations), progress)
            if iterations == 5_000:
                _compare(ledger, draw, ("robust NLS", 0), progress)
                if seed < full:
                    _compare(ledger, draw, ("CMA-ES", _CMA_EVALUATIONS), progress)


_CMA_EVALUATIONS = 40_000


def _compare(ledger: Ledger, draw: Draw, what: tuple[str, int], progress: Progress) -> None:
    method, iterations = what
    key = {"study": "search", "method": method, "iterations": iterations, "reading": draw.reading}
    if not list(ledger.missing(range(draw.seed, draw.seed + 1), **key)):
        return
    if method in ("PSO", "GA"):
        from .compiled_search import run_compiled

        found = run_compiled(method, draw, iterations, draw.seed)
    elif method == "CMA-ES":
        found = run_cma(draw, iterations, draw.seed)
    else:
        found = run_robust_nls(draw, draw.seed)
    ledger.append(_row(found, draw, key))
    progress(f"{method}, {draw.reading} noise, {iterations} iterations, draw {draw.seed + 1}")


def _row(found: Comparison, draw: Draw, key: dict[str, Any]) -> dict[str, Any]:
    row = key | {
        "seed": draw.seed,
        "values": found.values,
        "nll": found.negative_log_likelihood,
        "seconds": found.seconds,
    }
    return row | ({"fitness": found.fitness, "course": found.course} if draw.seed == 0 else {})


def run_adam_study(ledger: Ledger, steps: int, progress: Progress) -> None:
    """The paper's own training on the noise-free data and on one draw of each noise reading."""
    from .adam import run_adam

    problem = PaperProblem()
    readings: tuple[Reading, ...] = ("none", *NOISE_READINGS)
    for reading in readings:
        key = {"study": "adam", "method": "Adam", "iterations": steps, "reading": reading}
        for seed in ledger.missing(range(1), **key):
            draw = problem.draw(reading, seed)
            ledger.append(_row(run_adam(draw, seed, steps), draw, key))
            progress(f"Adam, {reading} noise")


def run_optima(ledger: Ledger, draws: int, progress: Progress) -> None:
    """Statistics of the likelihood optimum over many draws at once."""
    from .summary import summarise_batch

    for reading in NOISE_READINGS:
        if not ledger.rows(study="optima", reading=reading, draws=draws):
            progress(f"likelihood optima of {draws} draws, {reading} noise")
            figures = asdict(summarise_batch(reading, draws))
            ledger.append({"study": "optima", "reading": reading, "draws": draws, "seed": draws, "figures": figures})


def run_departure(ledger: Ledger, seeds: int, progress: Progress) -> None:
    """Where the joint is no Stribeck joint."""
    from .departure import CASES, measure_departure

    for number, (case, points) in enumerate(CASES):
        if not ledger.rows(study="departure", seed=number):
            progress(f"departure from the law: {case}, {points} points")
            figures = asdict(measure_departure(case, points, seeds))
            ledger.append({"study": "departure", "seed": number, "figures": figures})


def run_extras(ledger: Ledger, draws: int, lugre_seeds: int, progress: Progress) -> None:
    """Speeds chosen for information, and LuGre."""
    from .extras import measure_extras

    if not ledger.rows(study="extras"):
        progress("speeds chosen for information, LuGre")
        ledger.append({"study": "extras", "seed": 0, "figures": asdict(measure_extras(draws, lugre_seeds))})


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

"""The methods beside ours, on the same likelihood and within the paper's bounds. For the benchmark only."""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fricomp.calibration.identification.estimation.observation import Observations
from fricomp.laws import FloatArray

from .problem import UPPER_BOUNDS, Draw


@dataclass(frozen=True)
class Comparison:
    """What one method gave on one draw.

    Attributes:
        values: Parameters in the paper's order. Shape (8,).
        negative_log_likelihood: Under the draw's own noise reading.
        seconds: Wall-clock time.
        fitness: Best objective over the iterations, at 200 of them or fewer. Shape (n, 2): iteration, value.
        course: Best parameters at those iterations. Shape (n, 8).
    """

    values: FloatArray
    negative_log_likelihood: float
    seconds: float
    fitness: FloatArray
    course: FloatArray


Likelihood = Callable[[FloatArray], FloatArray]


def build_population_likelihood(draw: Draw) -> Likelihood:
    """Negative log-likelihood of many parameter vectors at once, shape (n, 8) to (n,)."""
    points, relative = draw.points, draw.reading == "relative"
    n = points.size

    def negative(population: FloatArray) -> FloatArray:
        model = _compute_curves(population, points)
        error = points.magnitude - model
        if not relative:
            return np.asarray(0.5 * n * (np.log(2.0 * np.pi * np.mean(error**2, axis=1) + 1e-300) + 1.0))
        safe = np.maximum(np.abs(model), 1e-12)
        spread = np.mean((error / safe) ** 2, axis=1)
        return np.asarray(0.5 * n * (np.log(2.0 * np.pi * spread + 1e-300) + 1.0) + np.sum(np.log(safe), axis=1))

    return negative


def _compute_curves(population: FloatArray, points: Observations) -> FloatArray:
    """Closed forms of many parameter vectors. Shape (n_population, n_points)."""
    curves = np.empty((len(population), points.size))
    for rows, at in ((points.forward, 0), (~points.forward, 4)):
        coulomb, static, stribeck, viscous = (population[:, at + k, None] for k in range(4))
        speed = points.speed[rows]
        falling = np.exp(-((speed / np.maximum(stribeck, 1e-9)) ** 2))
        curves[:, rows] = coulomb + (static - coulomb) * falling + viscous * speed
    return curves


def run_cma(draw: Draw, evaluations: int, seed: int) -> Comparison:
    """CMA-ES of the package cma in the scaled box, restarted with a doubled population (IPOP) within the budget."""
    import cma

    likelihood = build_population_likelihood(draw)
    begun = time.perf_counter()
    best, best_value, used, population = UPPER_BOUNDS / 2.0, np.inf, 0, 16
    fitness: list[tuple[int, float]] = []
    course: list[FloatArray] = []
    rng = np.random.default_rng(seed)
    while used < evaluations:
        options = {"bounds": [0.0, 1.0], "popsize": population, "seed": int(rng.integers(1, 2**31)), "verbose": -9}
        strategy = cma.CMAEvolutionStrategy(rng.uniform(0.0, 1.0, 8), 0.3, options)
        while not strategy.stop() and used < evaluations:
            asked = strategy.ask()
            values = likelihood(np.array(asked) * UPPER_BOUNDS)
            strategy.tell(asked, values.tolist())
            used += len(asked)
            if values.min() < best_value:
                best, best_value = np.array(asked[int(values.argmin())]) * UPPER_BOUNDS, float(values.min())
                fitness.append((used, best_value))
                course.append(best)
        population *= 2
    return _build_comparison(draw, best, begun, (fitness, course))


def run_robust_nls(draw: Draw, seed: int) -> Comparison:
    """Robust nonlinear least squares of scipy (soft L1) within the bounds from a random start, as users call it."""
    from scipy.optimize import least_squares

    points = draw.points
    begun = time.perf_counter()
    scale = 0.05 * (points.magnitude if draw.reading == "relative" else np.full(points.size, np.std(draw.torque)))
    start = np.random.default_rng(seed).uniform(0.05, 0.95, 8) * UPPER_BOUNDS

    def residual(values: FloatArray) -> FloatArray:
        return np.asarray((points.magnitude - _compute_curves(values[None], points)[0]) / np.abs(scale))

    fit = least_squares(
        residual, start, bounds=(np.full(8, 1e-9), UPPER_BOUNDS), loss="soft_l1", x_scale=UPPER_BOUNDS.tolist()
    )
    return _build_comparison(draw, fit.x, begun, ([], []))


def _build_comparison(
    draw: Draw, values: FloatArray, begun: float, course: tuple[list[tuple[int, float]], list[FloatArray]]
) -> Comparison:
    seconds = time.perf_counter() - begun
    likelihood = float(build_population_likelihood(draw)(values[None])[0])
    return Comparison(
        values, likelihood, seconds, np.array(course[0]).reshape(-1, 2), np.array(course[1]).reshape(-1, 8)
    )

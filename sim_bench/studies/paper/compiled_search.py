"""PSO and GA compiled, so that the paper's 100 x 50,000 evaluations can be repeated on many draws.

Both follow the textbook rules: PSO with inertia falling from 0.9 to 0.4 [shi1998inertia],
learning factors 1 as in the paper, velocity within a fifth of the range; GA with binary tournament, simulated binary
crossover and polynomial mutation [deb1995sbx] and survival of the best of parents and children.
"""

import time
from typing import Any

import numpy as np
from numba import njit

from fricomp.laws import FloatArray

from .comparators import Comparison, build_population_likelihood
from .problem import UPPER_BOUNDS, Draw

_POPULATION = 100
_SNAPSHOTS = 200
_CROSSOVER_INDEX, _MUTATION_INDEX = 15.0, 20.0
_PRODUCT_LENGTH = 16
"""Model values multiplied before one logarithm is taken of them."""


def run_compiled(method: str, draw: Draw, iterations: int, seed: int) -> Comparison:
    """Run `PSO` or `GA` at the paper's population and bounds.

    Args:
        method: `PSO` or `GA`.
        draw: The data.
        iterations: 50,000 in the paper.
        seed: Seed of the search.
    """
    points, relative = draw.points, draw.reading == "relative"
    order = np.argsort(~points.forward, kind="stable")
    data = (points.speed[order], points.magnitude[order], int(np.count_nonzero(points.forward)), relative)
    search = _run_swarm if method == "PSO" else _run_genetic
    search(*data, UPPER_BOUNDS, 2, seed)  # compile first, so that the time is the search's
    begun = time.perf_counter()
    best, fitness, course = search(*data, UPPER_BOUNDS, iterations, seed)
    seconds = time.perf_counter() - begun
    likelihood = float(build_population_likelihood(draw)(best[None])[0])
    return Comparison(best, likelihood, seconds, fitness, course)


@njit(cache=True)
def _compute_likelihood(x: FloatArray, speed: FloatArray, torque: FloatArray, n_forward: int, relative: bool) -> float:
    total, logs, product = 0.0, 0.0, 1.0
    n = len(speed)
    for i in range(n):
        at = 0 if i < n_forward else 4
        ratio = speed[i] / max(x[at + 2], 1e-9)
        model = x[at] + x[at + 3] * speed[i]
        if ratio < 6.1:
            model += (x[at + 1] - x[at]) * np.exp(-ratio * ratio)
        error = torque[i] - model
        if relative:
            model = max(abs(model), 1e-12)
            error /= model
            product *= model
            if i % _PRODUCT_LENGTH == 0:
                logs += np.log(product)
                product = 1.0
        total += error * error
    return float(0.5 * n * (np.log(2.0 * np.pi * total / n + 1e-300) + 1.0) + logs + np.log(product))


@njit(cache=True)
def _run_swarm(
    speed: FloatArray, torque: FloatArray, n_forward: int, relative: bool, upper: FloatArray, iterations: int, seed: int
) -> Any:
    np.random.seed(seed)
    position = np.random.random((_POPULATION, 8)) * upper
    velocity = (np.random.random((_POPULATION, 8)) - 0.5) * 0.2 * upper
    own = position.copy()
    own_value = np.full(_POPULATION, np.inf)
    leader, leader_value = position[0].copy(), np.inf
    every = max(1, iterations // _SNAPSHOTS)
    fitness, course = np.zeros((_SNAPSHOTS + 1, 2)), np.zeros((_SNAPSHOTS + 1, 8))
    taken = 0
    for k in range(iterations):
        for p in range(_POPULATION):
            value = _compute_likelihood(position[p], speed, torque, n_forward, relative)
            if value < own_value[p]:
                own_value[p], own[p] = value, position[p]
                if value < leader_value:
                    leader_value, leader = value, position[p].copy()
        inertia = 0.9 - 0.5 * k / iterations
        for p in range(_POPULATION):
            for j in range(8):
                pull = np.random.random() * (own[p, j] - position[p, j])
                pull += np.random.random() * (leader[j] - position[p, j])
                moved = inertia * velocity[p, j] + pull
                velocity[p, j] = min(max(moved, -0.2 * upper[j]), 0.2 * upper[j])
                position[p, j] = min(max(position[p, j] + velocity[p, j], 0.0), upper[j])
        if k % every == 0 and taken <= _SNAPSHOTS:
            fitness[taken, 0], fitness[taken, 1] = k, leader_value
            course[taken] = leader
            taken += 1
    return leader, fitness[:taken], course[:taken]


@njit(cache=True)
def _run_genetic(
    speed: FloatArray, torque: FloatArray, n_forward: int, relative: bool, upper: FloatArray, iterations: int, seed: int
) -> Any:
    np.random.seed(seed)
    both = np.random.random((2 * _POPULATION, 8)) * upper
    value = np.full(2 * _POPULATION, np.inf)
    for p in range(_POPULATION):
        value[p] = _compute_likelihood(both[p], speed, torque, n_forward, relative)
    every = max(1, iterations // _SNAPSHOTS)
    fitness, course = np.zeros((_SNAPSHOTS + 1, 2)), np.zeros((_SNAPSHOTS + 1, 8))
    taken = 0
    for k in range(iterations):
        for c in range(_POPULATION, 2 * _POPULATION):
            mother, father = _select_by_tournament(value), _select_by_tournament(value)
            for j in range(8):
                both[c, j] = _breed_child(both[mother, j], both[father, j], upper[j])
            value[c] = _compute_likelihood(both[c], speed, torque, n_forward, relative)
        order = np.argsort(value)
        both, value = both[order].copy(), value[order].copy()
        if k % every == 0 and taken <= _SNAPSHOTS:
            fitness[taken, 0], fitness[taken, 1] = k, value[0]
            course[taken] = both[0]
            taken += 1
    return both[0].copy(), fitness[:taken], course[:taken]


@njit(cache=True)
def _select_by_tournament(value: FloatArray) -> int:
    a, b = np.random.randint(0, _POPULATION), np.random.randint(0, _POPULATION)
    return a if value[a] < value[b] else b


@njit(cache=True)
def _breed_child(mother: float, father: float, upper: float) -> float:
    """One gene by simulated binary crossover, then polynomial mutation."""
    gene = mother
    if np.random.random() < 0.5:
        u = np.random.random()
        power = 1.0 / (_CROSSOVER_INDEX + 1.0)
        spread = (2.0 * u) ** power if u < 0.5 else (0.5 / (1.0 - u)) ** power
        side = 1.0 if np.random.random() < 0.5 else -1.0
        gene = 0.5 * (mother + father + side * spread * (mother - father))
    if np.random.random() < 0.125:
        u = np.random.random()
        power = 1.0 / (_MUTATION_INDEX + 1.0)
        gene += upper * ((2.0 * u) ** power - 1.0 if u < 0.5 else 1.0 - (2.0 * (1.0 - u)) ** power)
    return min(max(gene, 0.0), upper)

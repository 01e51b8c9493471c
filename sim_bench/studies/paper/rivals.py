"""The other methods on the draws that ours had: PSO, GA, CMA-ES, robust least squares, the paper's own training."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..kit.store import RowStore
from .comparators import Comparison, run_cma, run_robust_nls
from .problem import NOISE_READINGS, Draw, PaperProblem
from .study import SPREADS, Progress, draw_random_values

PAPER_LENGTH = 50_000
"""Iterations of every method in [luo2024pinn]."""
_TENTH = PAPER_LENGTH // 10
CMA_EVALUATIONS = 40_000


@dataclass(frozen=True)
class SearchSizes:
    """How many draws.

    Attributes:
        full: At the paper's length.
        tenth: At a tenth of it.
    """

    full: int
    tenth: int


FULL_SIZES = SearchSizes(full=20, tenth=200)
"""Of a run that is not cut short."""


def run_searches(ledger: RowStore, sizes: SearchSizes, progress: Progress) -> None:
    """PSO and GA on `full` draws at the paper's length and on `tenth` at a tenth, and what else there is.

    Without noise there is one data set, and the seed is the search's. Lengths alternate, so that a run that is cut
    short has some of both.
    """
    problem = PaperProblem()
    for seed, iterations in _interleave_seeds(sizes):
        draws = [problem.draw(reading, seed) for reading in NOISE_READINGS]
        if iterations == PAPER_LENGTH:
            draws.append(problem.draw("none", seed))
        for draw in draws:
            for method in ("PSO", "GA"):
                _compare(ledger, draw, (method, iterations), progress)
        for draw in draws[:2]:
            what = ("CMA-ES", CMA_EVALUATIONS) if iterations == PAPER_LENGTH else ("robust NLS", 0)
            _compare(ledger, draw, what, progress)


def _interleave_seeds(sizes: SearchSizes) -> list[tuple[int, int]]:
    """Seed and iterations of each run: one draw at full length, then ten at a tenth."""
    full = [(seed, PAPER_LENGTH) for seed in range(sizes.full)]
    short = [(seed, _TENTH) for seed in range(sizes.tenth)]
    plan: list[tuple[int, int]] = []
    while full or short:
        plan += full[:1] + short[:10]
        full, short = full[1:], short[10:]
    return plan


def run_adam_study(ledger: RowStore, starts: int, steps: int, progress: Progress) -> None:
    """The paper's own training: without noise from random starts, on a draw of each reading from the best of them."""
    from .adam import run_adam

    problem = PaperProblem()

    def train(draw: Draw, spread: float, seeds: Sequence[int]) -> list[dict[str, Any]]:
        """Rows of the trainings from these starts; without noise, where there is one draw, the seed is the start's."""
        key = {"study": "adam", "method": "Adam", "iterations": steps, "reading": draw.reading, "spread": spread}
        progress(f"Adam, {draw.reading} noise, {len(seeds)} starts within a factor of {spread:g}")
        found = run_adam(draw, np.array([draw_random_values(seed, spread) for seed in seeds]), steps)
        return [_build_row(one, draw, key) | {"fitness": one.fitness, "course": one.course} for one in found]

    known = {"study": "adam", "iterations": steps}
    for spread in SPREADS:
        missing = list(ledger.find_missing(range(starts), **known, reading="none", spread=spread))
        for seed, row in zip(missing, train(problem.draw("none", 0), spread, missing) if missing else [], strict=True):
            ledger.append(row | {"seed": seed})
    rows = ledger.rows(**known, reading="none")
    best = min(rows, key=lambda row: problem.compute_mean_error(row["values"]))
    for reading in NOISE_READINGS:
        if not ledger.rows(**known, reading=reading):
            ledger.append(*train(problem.draw(reading, 0), best["spread"], [best["seed"]]))


def _compare(ledger: RowStore, draw: Draw, what: tuple[str, int], progress: Progress) -> None:
    method, iterations = what
    key = {"study": "search", "method": method, "iterations": iterations, "reading": draw.reading}
    if ledger.rows(**key, seed=draw.seed):
        return
    progress(f"{method}, {draw.reading} noise, {iterations} iterations, draw {draw.seed + 1}")
    ledger.append(_build_row(_search(method, draw, iterations), draw, key))


def _search(method: str, draw: Draw, iterations: int) -> Comparison:
    from .compiled_search import run_compiled

    if method == "CMA-ES":
        return run_cma(draw, iterations, draw.seed)
    if method == "robust NLS":
        return run_robust_nls(draw, draw.seed)
    return run_compiled(method, draw, iterations, draw.seed)


def _build_row(found: Comparison, draw: Draw, key: dict[str, Any]) -> dict[str, Any]:
    row = key | {
        "seed": draw.seed,
        "values": found.values,
        "nll": found.negative_log_likelihood,
        "seconds": found.seconds,
    }
    return row | ({"fitness": found.fitness, "course": found.course} if draw.seed == 0 else {})

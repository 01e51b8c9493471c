"""The paper's problem, for the tests of the identification."""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray
from fricomp.sim_bench.studies.paper.problem import Draw, PaperProblem

PROBLEM = PaperProblem()
TRUE = np.array(PROBLEM.true_values)


def values_of(result: object) -> FloatArray:
    """The eight parameters in the paper's order."""
    return np.array(list(result.parameters.values()))  # type: ignore[attr-defined]


def noisy(reading: str, seed: int) -> Draw:
    """201 points with 5 % noise."""
    return PROBLEM.draw(reading, seed)  # type: ignore[arg-type]

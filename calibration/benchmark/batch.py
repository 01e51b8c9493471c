"""The likelihood optimum of thousands of draws at once, for the statistics.

By `identify_batch`, which starts from the data alone; on draws that both have, it is compared with `identify`.
"""

from __future__ import annotations

from typing import Literal, NamedTuple

from fricomp.laws import FloatArray

from ..batch import identify_batch
from .problem import PaperProblem, Reading

__all__ = ["BatchOptima", "batch_optima"]


class BatchOptima(NamedTuple):
    """Optima of many draws.

    Attributes:
        values: Shape (n_draws, 8).
        deviations: Standard deviations from the Fisher information at the optimum. Shape (n_draws, 8).
    """

    values: FloatArray
    deviations: FloatArray


def batch_optima(reading: Reading, draws: int) -> BatchOptima:
    """Optima of the draws with the seeds 0 to `draws` - 1."""
    data = [PaperProblem().draw(reading, seed) for seed in range(draws)]
    noise: Literal["relative", "absolute"] = "relative" if reading == "relative" else "absolute"
    found = identify_batch([draw.velocity for draw in data], [draw.torque for draw in data], noise)
    return BatchOptima(found.values, found.standard_deviations)

"""Least squares with a covariance that holds where errors are correlated over time."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

__all__ = ["CorrelatedFit", "solve_correlated"]

_RANK = 1e-8
"""Singular values below this fraction of the largest are rounding, columns scaled to the same norm."""


class CorrelatedFit(NamedTuple):
    """A linear fit.

    Attributes:
        solution: Shape (n_columns,).
        covariance: Of the solution. Shape (n_columns, n_columns).
        error: What is left. Shape (n_rows,).
        rank: Of the columns, those of the same norm.
    """

    solution: FloatArray
    covariance: FloatArray
    error: FloatArray
    rank: int


def solve_correlated(
    columns: FloatArray, target: FloatArray, at: np.ndarray[tuple[int], np.dtype[np.intp]], reach: int
) -> CorrelatedFit:
    """Least squares, with the covariance of [newey1987]: errors up to `reach` samples apart may go together.

    Args:
        columns: Regressors. Shape (n_rows, n_columns).
        target: What they explain. Shape (n_rows,).
        at: Position of each row in time [samples], ascending. Shape (n_rows,).
        reach: Distance from which errors are independent [samples].
    """
    norms = np.linalg.norm(columns, axis=0)
    scale = np.where(norms > 1e-100, norms, 1.0)  # a column without entries takes no part
    scaled = columns / scale
    solution, _, found, _ = np.linalg.lstsq(scaled, target, rcond=_RANK)
    rank = int(found)
    error = target - scaled @ solution
    inverse = np.linalg.pinv(scaled, rcond=_RANK)
    scores = np.zeros((int(at[-1] - at[0]) + 1, columns.shape[1]))
    scores[at - at[0]] = scaled * error[:, None]
    spread = scores.T @ scores
    for lag in range(1, min(reach, len(scores))):
        product = scores[lag:].T @ scores[:-lag]
        spread += (1.0 - lag / reach) * (product + product.T)
    bread = inverse @ inverse.T
    freedom = len(target) / max(len(target) - rank, 1)
    covariance = freedom * bread @ spread @ bread / np.outer(scale, scale)
    return CorrelatedFit(solution / scale, covariance, error, rank)

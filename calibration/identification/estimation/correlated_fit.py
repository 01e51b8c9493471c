"""Least squares with a covariance that holds where errors are correlated over time."""

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .information import with_least_variance

_Index = np.ndarray[tuple[int], np.dtype[np.intp]]

_RANK = 1e-8
"""Singular values below this fraction of the largest are rounding, columns scaled to the same norm."""
_BLOCK = 4
"""Length of the blocks that are left out, in times the reach: neighbours then share little."""
_FEWEST_BLOCKS = 30
"""Blocks below which they are made shorter, down to the reach."""


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


def solve_correlated(columns: FloatArray, target: FloatArray, at: _Index, reach: int) -> CorrelatedFit:
    """Least squares with a covariance for errors that go together up to `reach` samples apart [newey1987].

    That covariance takes what is left for the errors. Where a few rows decide on a column, such as the slowest ones on
    a static torque, the fit has bent to them and little is left: no variance is below that of leaving out each block
    of rows in turn [kunsch1989bootstrap], [mackinnon2023leverage].

    Args:
        columns: Regressors. Shape (n_rows, n_columns).
        target: What they explain. Shape (n_rows,).
        at: Position of each row in time [samples], ascending. Shape (n_rows,).
        reach: Distance from which errors are independent [samples].
    """
    norms = np.linalg.norm(columns, axis=0)
    scale = np.where(norms > 1e-100, norms, 1.0)  # a column without entries takes no part
    basis, sizes, directions = np.linalg.svd(columns / scale, full_matrices=False)
    kept = sizes > _RANK * sizes[0]
    basis, back = basis[:, kept], directions[kept].T / sizes[kept] / scale[:, None]
    coordinates = basis.T @ target
    error = target - basis @ coordinates
    freedom = len(target) / max(len(target) - basis.shape[1], 1)
    covariance = freedom * back @ _spread(basis * error[:, None], at, reach) @ back.T
    if reach > 1:
        covariance = with_least_variance(
            _leave_out_blocks(basis, error, back, _split_into_blocks(at, reach)), covariance
        )
    return CorrelatedFit(back @ coordinates, covariance, error, basis.shape[1])


def _spread(scores: FloatArray, at: _Index, reach: int) -> FloatArray:
    """Covariance of the sum of scores that go together over `reach` samples [newey1987]. Shape (n_fit, n_fit)."""
    placed = np.zeros((int(at[-1] - at[0]) + 1, scores.shape[1]))
    placed[at - at[0]] = scores
    spread = placed.T @ placed
    for lag in range(1, min(reach, len(placed))):
        product = placed[lag:].T @ placed[:-lag]
        spread += (1.0 - lag / reach) * (product + product.T)
    return np.asarray(spread)


def _split_into_blocks(at: _Index, reach: int) -> list[_Index]:
    """Positions of the rows of each block; it ends where the rows do, since what follows is another stroke."""
    length = int(np.clip(len(at) // _FEWEST_BLOCKS, reach, _BLOCK * reach))
    strokes = np.split(np.arange(len(at)), np.flatnonzero(np.diff(at) > 1) + 1)
    return [block for rows in strokes for block in np.array_split(rows, max(1, len(rows) // length))]


def _leave_out_blocks(basis: FloatArray, error: FloatArray, back: FloatArray, blocks: list[_Index]) -> FloatArray:
    """Covariance by how much the solution moves without each block. Shape (n_columns, n_columns).

    Of what one block alone decides on, nothing is left to compare it with: it says nothing there.

    Args:
        basis: Orthonormal columns. Shape (n_rows, n_fit).
        error: What is left. Shape (n_rows,).
        back: The solution for each coordinate in the basis. Shape (n_columns, n_fit).
        blocks: Rows of each.
    """
    others = np.stack([np.eye(basis.shape[1]) - basis[rows].T @ basis[rows] for rows in blocks])
    scores = np.stack([basis[rows].T @ error[rows] for rows in blocks])
    moves = (np.linalg.pinv(others, rcond=_RANK, hermitian=True) @ scores[:, :, None])[:, :, 0] @ back.T
    return np.asarray((1.0 - 1.0 / len(blocks)) * (moves.T @ moves))

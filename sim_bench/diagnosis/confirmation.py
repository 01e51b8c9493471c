"""Confirmation on data that took no part: blocks in time with gaps, and whole recordings left out."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from .preparation import Prepared
from .solver import Box, at_least
from .structure import Structure
from .track import FloatArray

__all__ = ["Confirmation", "confirm"]

_BLOCKS = 6
_GAP_ROWS = 15  # 0.3 s, five correlation times of the rows
_BOOTSTRAPS = 400
_PARTS = (1.0, 0.25)  # of a step that are simulated


@dataclass(frozen=True)
class Confirmation:
    """Held-out errors.

    Attributes:
        rmse_before: Of the base [N·m].
        rmse_after: With the effects [N·m].
        noise_floor: Of nulls [N·m].
        ci95_reduction: Interval of 1 - after / before.
        explained: Part of the weighted energy above the floor that is removed.
    """

    rmse_before: float
    rmse_after: float
    noise_floor: float
    ci95_reduction: tuple[float, float]
    explained: float


def confirm(
    prepared: Prepared, structure: Structure, theta: FloatArray, jacobian: FloatArray, seed: int
) -> Confirmation:
    """Refit base and effects on all blocks but one, about their joint minimum, and judge them on that one."""
    sizes = [grid.centres.size for grid in prepared.problem.grids]
    spread = np.concatenate(prepared.nulls.weights.spread)
    after_fit = structure.residuals(prepared.problem, [theta])[0]
    box = prepared.box.joined(structure.box())
    folds = _folds(sizes)
    before = _held_out(prepared.fit.residual, prepared.fit.jacobian, prepared.box, folds)
    if any(not parameter.linear for _, parameter in structure.parameters()):
        moves = [_move(after_fit, jacobian, box, train) for train, _ in folds]
        after = _held_out_by_simulation(prepared, structure, theta, after_fit, list(zip(folds, moves, strict=True)))
    else:
        after = _held_out(after_fit, jacobian, box, folds)
    raw = [
        np.concatenate(
            [
                np.mean((r - m) ** 2, axis=0)
                for r, m in zip(prepared.nulls.rows, prepared.nulls.weights.mean, strict=True)
            ]
        )
    ]
    energy_before, energy_after = (before * spread) ** 2, (after * spread) ** 2
    unit = float(np.sqrt(np.mean(raw[0]) / np.mean(spread**2)))
    # Nulls are fitted to all of their rows; on rows that took no part they would leave this much more.
    rows, freedom = before.size, prepared.fit.theta.size
    left = np.mean([np.mean((null * spread) ** 2) for null in prepared.null_residuals()])
    floor = unit * float(np.sqrt(left * (rows + freedom) / (rows - freedom)))
    blocks = np.array_split(np.arange(before.size), max(10, before.size // 50))
    b = np.array([energy_before[k].sum() for k in blocks])
    a = np.array([energy_after[k].sum() for k in blocks])
    draws = np.random.default_rng(seed).integers(0, len(blocks), (_BOOTSTRAPS, len(blocks)))
    reduction = 1.0 - np.sqrt(a[draws].sum(axis=1) / b[draws].sum(axis=1))
    low, high = np.quantile(reduction, [0.025, 0.975])
    above = float(np.sum(before**2) - before.size)
    explained = float(np.sum(before**2) - np.sum(after**2)) / above if above > 0.0 else 0.0
    return Confirmation(
        rmse_before=unit * float(np.sqrt(np.mean(energy_before))),
        rmse_after=unit * float(np.sqrt(np.mean(energy_after))),
        noise_floor=floor,
        ci95_reduction=(float(low), float(high)),
        explained=float(np.clip(explained, 0.0, 1.0)),
    )


def _folds(sizes: list[int]) -> list[tuple[FloatArray, FloatArray]]:
    """Masks of training and test rows: whole recordings where there are several, else blocks with gaps."""
    total, ends = sum(sizes), np.cumsum([0, *sizes])
    if len(sizes) > 2:
        cuts = [(int(a), int(b), 0) for a, b in pairwise(ends)]
    else:
        edges = np.linspace(0, total, _BLOCKS + 1).astype(int)
        cuts = [(int(a), int(b), _GAP_ROWS) for a, b in pairwise(edges)]
    folds = []
    for a, b, gap in cuts:
        test, train = np.zeros(total, dtype=bool), np.ones(total, dtype=bool)
        test[a:b], train[max(a - gap, 0) : b + gap] = True, False
        folds.append((train, test))
    return folds


def _held_out(
    residual: FloatArray, jacobian: FloatArray, box: Box, folds: list[tuple[FloatArray, FloatArray]]
) -> FloatArray:
    """Residual of each row by parameters that its own block did not help to fit."""
    result = residual.copy()
    for train, test in folds:
        result[test] = residual[test] + jacobian[test] @ _move(residual, jacobian, box, train)
    return result


def _held_out_by_simulation(
    prepared: Prepared,
    structure: Structure,
    theta: FloatArray,
    residual: FloatArray,
    folds: list[tuple[tuple[FloatArray, FloatArray], FloatArray]],
) -> FloatArray:
    """The same where lines are no guide: each fold's step is simulated, and taken if its own rows gain by it."""
    box = prepared.box.joined(structure.box())
    points = [box.clip(theta + part * move) for _, move in folds for part in _PARTS]
    values = structure.residuals(prepared.problem, points)
    result = residual.copy()
    for i, ((train, test), _) in enumerate(folds):
        options = values[i * len(_PARTS) : (i + 1) * len(_PARTS)]
        best = min(options, key=lambda option: float(option[train] @ option[train]))
        fall = float(residual[train] @ residual[train]) - float(best[train] @ best[train])
        result[test] = (best if fall > theta.size else residual)[test]
    return result


def _move(residual: FloatArray, jacobian: FloatArray, box: Box, train: FloatArray) -> FloatArray:
    """Gauss-Newton step on the rows of `train`, at most one scale long in each parameter. Shape (p,)."""
    A = jacobian[train] * box.scale
    prior = at_least(box.scaled_precision, 0.1)
    step = np.linalg.solve(A.T @ A + prior, -A.T @ residual[train])
    result: FloatArray = box.scale * np.clip(step, -1.0, 1.0)
    return result


def covariance(fit_jacobian: FloatArray, box: Box) -> FloatArray:
    """Covariance of base and effect parameters in the solver's coordinates. Shape (p, p)."""
    A = fit_jacobian * box.scale
    H = A.T @ A + at_least(box.scaled_precision, 1e-9)
    result: FloatArray = np.linalg.pinv(H, hermitian=True) * np.outer(box.scale, box.scale)
    return result

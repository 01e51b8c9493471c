"""Confirmation on held-out data: blocks in time with gaps between them, or whole recordings."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from fricomp.root_mean_square import compute_rms

from ..effects.structure import Structure
from ..inputs.track import FloatArray
from ..joint.solver import Box, Fit, raise_diagonal
from ..search.preparation import Baseline
from .settings import CONFIRMATION

__all__ = ["Confirmation", "compute_covariance", "compute_move", "confirm"]


@dataclass(frozen=True)
class PlainErrors:
    """Held-out root mean squares of rows in which every row counts alike, as a user would compute them [N·m].

    Attributes:
        before: Of the base.
        after: With the effects.
        floor: Of nulls.
        acting: Of what the effects change in the rows in which they act: each row counts by the square of that.
    """

    before: float
    after: float
    floor: float
    acting: float = 0.0

    @property
    def reduction(self) -> float:
        """Part of the error that goes."""
        return 1.0 - self.after / max(self.before, 1e-30)

    @property
    def size(self) -> float:
        """Root mean square of what goes [N·m]; nothing where the error grows."""
        return float(np.sqrt(max(self.before**2 - self.after**2, 0.0)))

    @property
    def explained(self) -> float:
        """Part of the energy above the floor that goes."""
        above = self.before**2 - min(self.floor, self.after) ** 2
        return (self.before**2 - self.after**2) / above if above > 0.0 else 0.0


@dataclass(frozen=True)
class Confirmation:
    """Held-out errors: root mean squares of rows over their own noise, in that of a typical row.

    Rows about reversals are known as badly as the bristle is; among equals they would decide everything.

    Attributes:
        rmse_before: Of the base [N·m].
        rmse_after: With the effects [N·m].
        noise_floor: Of nulls [N·m].
        ci95_reduction: Interval of 1 - after / before.
        explained: Part of the weighted energy above the floor that is removed.
        plain: The same errors without any weights.
    """

    rmse_before: float
    rmse_after: float
    noise_floor: float
    ci95_reduction: tuple[float, float]
    explained: float
    plain: PlainErrors = PlainErrors(0.0, 0.0, 0.0)


def confirm(baseline: Baseline, structure: Structure, fit: Fit, seed: int, *, given: Fit | None = None) -> Confirmation:
    """Refit base and effects on all blocks but one, about their joint minimum, and judge them on that one.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        structure: Base with effects, or without.
        fit: Its joint minimum.
        seed: Of the bootstrap.
        given: The base with parameters as given, where the error is to be counted from there.
    """
    folds = _split_folds([grid.centres.size for grid in baseline.problem.grids])
    base = baseline.fit if given is None else given
    before = _predict_held_out(baseline, baseline.structure, base, folds)
    after = before if fit is base else _predict_held_out(baseline, structure, fit, folds)
    energy_before, energy_after = before**2, after**2
    unit = _measure_typical_noise(baseline)
    # Nulls are fitted to all of their rows; on rows that the fit did not use they would leave this much more.
    rows, freedom = before.size, baseline.fit.theta.size
    left = np.mean([np.mean(null**2) for null in baseline.null_residuals])
    floor = unit * float(np.sqrt(left * (rows + freedom) / (rows - freedom)))
    blocks = _split_blocks(before.size)
    b = np.array([energy_before[k].sum() for k in blocks])
    a = np.array([energy_after[k].sum() for k in blocks])
    draws = np.random.default_rng(seed).integers(0, len(blocks), (CONFIRMATION.bootstraps, len(blocks)))
    reduction = 1.0 - np.sqrt(a[draws].sum(axis=1) / b[draws].sum(axis=1))
    low, high = np.quantile(reduction, [0.025, 0.975])
    # A ripple too fine for the generic basis was taken for noise: what is left without it is the better floor.
    floor = min(floor, unit * float(np.sqrt(np.mean(energy_after))))
    fall = float(np.sum(energy_before) - np.sum(energy_after))
    noise = left * (rows + freedom) / (rows - freedom) * rows
    above = float(np.sum(energy_before) - min(np.sum(energy_after), noise))
    explained = fall / above if above > 0.0 else 0.0
    return Confirmation(
        rmse_before=unit * float(np.sqrt(np.mean(energy_before))),
        rmse_after=unit * float(np.sqrt(np.mean(energy_after))),
        noise_floor=floor,
        ci95_reduction=(float(low), float(high)),
        explained=float(np.clip(explained, 0.0, 1.0)),
        plain=_measure_plain(baseline, structure, before, after),
    )


def _measure_plain(baseline: Baseline, structure: Structure, before: FloatArray, after: FloatArray) -> PlainErrors:
    """Errors of rows without weights: of those that slide, or of all where an effect shows at rest and these say more.

    What the law of the bristle leaves about rest is as large in both errors, and hides an effect that acts everywhere.
    """
    nulls = [np.concatenate(baseline.nulls.weights.unweigh(null)) for null in baseline.null_residuals]
    sides = [np.concatenate(baseline.problem.unweigh(side)) for side in (before, after)]
    at_rest = any(candidate.effect.shown_at_rest for candidate in structure.candidates)
    chosen = [baseline.sliding, np.ones_like(baseline.sliding)] if at_rest else [baseline.sliding]
    return max((_compare_plain(rows, sides, nulls) for rows in chosen), key=lambda one: one.explained)


def _compare_plain(rows: NDArray[np.bool_], sides: list[FloatArray], nulls: list[FloatArray]) -> PlainErrors:
    """Errors of some rows, before and after, and of nulls there."""
    before, after = (side[rows] for side in sides)
    floor = float(np.sqrt(np.mean([np.mean(null[rows] ** 2) for null in nulls])))
    changed = (before - after) ** 2  # the same noise is in both, and none in this
    acting = float(np.sqrt(np.sum(changed**2) / max(float(np.sum(changed)), 1e-300)))
    return PlainErrors(compute_rms(before), compute_rms(after), floor, acting)


def _measure_typical_noise(baseline: Baseline) -> float:
    """Median over all rows of the standard deviation between nulls [N·m]."""
    nulls = baseline.nulls
    squares = [np.mean((r - m) ** 2, axis=0) for r, m in zip(nulls.rows, nulls.weights.mean, strict=True)]
    return float(np.sqrt(np.median(np.concatenate(squares))))


def _split_folds(sizes: list[int]) -> list[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Masks of training and test rows: whole recordings where there are three or more, else blocks with gaps."""
    total, ends, number = sum(sizes), np.cumsum([0, *sizes]), len(sizes)
    cuts = [(int(a), int(b), 0) for a, b in pairwise(ends)]
    if number < CONFIRMATION.fewest_recordings:
        number = CONFIRMATION.folds
        blocks = CONFIRMATION.folds * int(
            np.clip(total // (CONFIRMATION.folds * CONFIRMATION.shortest_block), 1, CONFIRMATION.blocks)
        )
        edges = np.linspace(0, total, blocks + 1).astype(int)
        cuts = [(int(a), int(b), CONFIRMATION.gap) for a, b in pairwise(edges)]
    folds = [(np.ones(total, dtype=bool), np.zeros(total, dtype=bool)) for _ in range(number)]
    for i, (a, b, gap) in enumerate(cuts):
        train, test = folds[i % number]
        test[a:b], train[max(a - gap, 0) : b + gap] = True, False
    return folds


def _predict_held_out(
    baseline: Baseline,
    structure: Structure,
    fit: Fit,
    folds: list[tuple[NDArray[np.bool_], NDArray[np.bool_]]],
) -> FloatArray:
    """Residual of each row by parameters that its own block did not help to fit. Shape (m,).

    About the joint minimum each fold takes a step on its own rows. It is simulated, and taken where those gain by it:
    a bristle or a gap is no line, and what a line promises may be far from what comes.
    """
    theta, residual = fit.theta, structure.compute_residuals(baseline.problem, [fit.theta])[0]
    box = baseline.box.join(structure.build_box()) if structure.candidates else baseline.box
    moves = [compute_move(replace(fit, residual=residual), box, train) for train, _ in folds]
    values = structure.compute_residuals(
        baseline.problem, [box.clip(theta + part * move) for move in moves for part in CONFIRMATION.step_parts]
    )
    result = residual.copy()
    for i, (train, test) in enumerate(folds):
        options = values[i * len(CONFIRMATION.step_parts) : (i + 1) * len(CONFIRMATION.step_parts)]
        best = min(options, key=lambda option: float(option[train] @ option[train]))
        fall = float(residual[train] @ residual[train]) - float(best[train] @ best[train])
        result[test] = (best if fall > 0.0 else residual)[test]
    return result


def compute_move(fit: Fit, box: Box, train: NDArray[np.bool_]) -> FloatArray:
    """Step that fits the rows of `train` best as a line, in the domain and at most one scale long in each parameter.
    Shape (p,).

    The bounds are part of the fit: parameters that trade against each other leave their valley where a step is cut
    afterwards, and then it gains nothing. A parameter that moves no row is held: so are those that stay as given.
    """
    lower, upper = (np.clip((end - fit.theta) / box.scale, -1.0, 1.0) for end in (box.lower, box.upper))
    free = np.flatnonzero(np.any(fit.jacobian, axis=0) & (lower < upper))
    prior = raise_diagonal(box.scaled_precision[np.ix_(free, free)], CONFIRMATION.least_diagonal)
    size, axes = np.linalg.eigh(prior)
    pulls = np.sqrt(np.maximum(size, 0.0))[:, None] * axes.T
    A = np.vstack([(fit.jacobian[train] * box.scale)[:, free], pulls])
    table = np.column_stack([A, np.append(-fit.residual[train], np.zeros(free.size))])
    whole = np.asarray(np.linalg.qr(table, mode="r"), dtype=np.float64)
    step = np.zeros(box.scale.size)
    step[free] = lsq_linear(whole[:, :-1], whole[:, -1], (lower[free], upper[free])).x
    result: FloatArray = box.scale * step
    return result


def compute_covariance(fit: Fit, box: Box) -> FloatArray:
    """Covariance of base and effect parameters in the solver's coordinates. Shape (p, p).

    What a structure does not quite explain counts as noise; where it leans the same way for a second and more, the
    sums over blocks of rows show by how much parameters follow it [white1980].
    """
    A, inverse = invert_curvature(fit, box)
    loud = max(1.0, float(fit.residual @ fit.residual) / fit.residual.size)
    leaning = np.array(
        [_sum_leaning(A[rows], inverse, fit.residual[rows]) for rows in _split_blocks(fit.residual.size)]
    )
    spread = inverse @ (leaning.T @ leaning) @ inverse
    plain = loud * inverse
    wider = np.sqrt(np.maximum(np.diag(spread) / np.maximum(np.diag(plain), 1e-300), 1.0))
    result: FloatArray = plain * np.outer(wider * box.scale, wider * box.scale)
    return result


def invert_curvature(fit: Fit, box: Box) -> tuple[FloatArray, FloatArray]:
    """Jacobian in units of the box, shape (m, p), and the inverse of the curvature with the priors, shape (p, p)."""
    A = fit.jacobian * box.scale
    H = A.T @ A + raise_diagonal(box.scaled_precision, 1e-9)
    return A, np.asarray(np.linalg.pinv(H, hermitian=True), dtype=np.float64)


def _sum_leaning(A: FloatArray, inverse: FloatArray, residual: FloatArray) -> FloatArray:
    """Sum over a block of rows, as far as the fit has bent towards them put back: with two dozen blocks and as many
    parameters sums of what is left are a fifth too small. Shape (p,).
    """
    size, V = np.linalg.eigh(np.eye(A.shape[0]) - A @ inverse @ A.T)
    result: FloatArray = A.T @ (V @ ((V.T @ residual) / np.sqrt(np.maximum(size, CONFIRMATION.straightest))))
    return result


def _split_blocks(rows: int) -> list[NDArray[np.int64]]:
    """Rows of blocks of a second, at least ten of them."""
    return np.array_split(np.arange(rows), max(CONFIRMATION.fewest_blocks, rows // CONFIRMATION.bootstrap_block))

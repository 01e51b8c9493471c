"""How much the rows of an arm's equations count: by what a fit leaves of them, and by how much they err together."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from .rows import ArmRows

BoolArray = NDArray[np.bool_]

_HUBER = 3.0
"""Standard deviations beyond which a row counts less: a push, or a reversal that the friction model does not hold."""

_NEAR = 6
"""Rows from a reversal over which the filters spread what happens there: one and a half periods of the cutoff."""

_FEWEST = 20
"""Rows from which a spread is measured."""

BLOCK_TIME = 1.0
"""[s] of rows that may be wrong together: structure rings and friction creeps for less."""

_MOST_INFLATION = 2.0
"""Highest inflation of a joint, in the median of all. Links are shared: a joint that they fit badly errs for long at a
time, would count for less, and be fitted still worse."""


@dataclass(frozen=True)
class Weights:
    """How much rows count.

    Attributes:
        rows: Of each joint's rows, 0 to 1. Shape (n, n_joints).
        noise: Standard deviation of a row of each joint [N·m]. Shape (n_joints,).
        inflation: By how much rows that err together widen the variances of each joint; at least 1. Shape (n_joints,).
    """

    rows: FloatArray
    noise: FloatArray
    inflation: FloatArray


def weigh_rows(residuals: FloatArray, used: BoolArray, rows: ArmRows, *, robust: bool, settled: bool) -> Weights:
    """Weights that hold outliers down [huber1964], and how much rows err together.

    Args:
        residuals: What a fit leaves [N·m] or [N]. Shape (n, n_joints).
        used: Rows that are compared. Shape (n, n_joints).
        rows: Their times.
        robust: Hold outliers down; otherwise all rows count alike.
        settled: Rows near a reversal of their joint count by what is left of such rows.
    """
    most = _HUBER if robust else np.inf
    near = count_from_reversal(used, rows.part) if settled else np.full(used.shape, _NEAR + 1)
    far = used & (near > _NEAR)
    far = np.where(np.sum(far, axis=0) >= _FEWEST, far, used)
    noise = np.array([_measure_spread(r[u], most) for r, u in zip(residuals.T, far.T, strict=True)])
    spread = np.tile(noise, (len(residuals), 1))
    for distance in range(1, _NEAR + 1):
        for j, here in enumerate((used & (near == distance)).T):
            if np.sum(here) >= _FEWEST:
                spread[here, j] = max(noise[j], _measure_spread(residuals[here, j], most))
    outliers = np.minimum(1.0, most * spread / np.maximum(np.abs(residuals), 1e-300))
    weights = np.where(used, outliers * (noise / spread) ** 2, 0.0)
    inflation = np.array([_measure_inflation(score, rows) for score in (weights * residuals / noise).T])
    return Weights(weights, noise, np.minimum(inflation, _MOST_INFLATION * float(np.median(inflation))))


def count_from_reversal(moving: BoolArray, part: NDArray[np.intp]) -> NDArray[np.intp]:
    """Rows to the nearest one in which the joint does not move, at most one more than count as near. Shape as given."""
    near = np.where(moving, _NEAR + 1, 0)
    for distance in range(1, _NEAR + 1):
        before, after = np.zeros_like(moving), np.zeros_like(moving)
        same = (part[1:] == part[:-1])[:, None]
        before[1:], after[:-1] = (near[:-1] == distance - 1) & same, (near[1:] == distance - 1) & same
        near = np.where((near > distance) & (before | after), distance, near)
    return near


def _measure_spread(values: FloatArray, most: float) -> float:
    """Standard deviation of most rows, whatever the others are."""
    if values.size == 0:
        return 1.0
    robust = max(float(np.median(np.abs(values))) / 0.6745, 1e-300)
    return max(compute_rms(np.minimum(np.abs(values), most * robust)), 1e-12)


def _measure_inflation(score: FloatArray, rows: ArmRows) -> float:
    """How much more the sums of blocks stray than those of independent rows would; 1 where they do not."""
    duration = sum(float(np.ptp(rows.time[rows.part == k])) for k in np.unique(rows.part))
    length = max(1, round(BLOCK_TIME * len(rows) / max(duration, 1e-9)))
    sums = np.add.reduceat(score, np.arange(0, len(score), length))
    total = float(score @ score)
    return max(1.0, float(sums @ sums) / total) if total > 0.0 else 1.0

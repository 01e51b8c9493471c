"""The equations of an arm as sums over rows: all that any model of it needs to be fitted, however long the recording.

    G_j = Σ_rows w Zᵀ Z,  Z = [links | rotor | friction | rate of torque | torque]  of joint j

A fit is then a matter of small matrices, so that a hundred models cost what one pass over the rows does.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .friction import Filled, column_names, find_columns, friction_columns, load_columns, ripple_columns
from .rows import ArmRows
from .simulated_arm import SimulatedArm

BoolArray = NDArray[np.bool_]

__all__ = ["ArmEquations", "BoolArray", "EquationSums", "Weights", "build_equations"]

_SLOW = 0.02
"""Speeds below this part of a joint's top speed leave its sign to noise; such rows of that joint are not compared."""

_HUBER = 3.0
"""Standard deviations beyond which a row counts less: a push, or a reversal that the friction model does not hold."""

_BLOCK_TIME = 1.0
"""[s] of rows that may be wrong together: structure rings and friction creeps for less."""


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


@dataclass(frozen=True)
class ArmEquations:
    """Sums over rows.

    Attributes:
        columns: Columns of each joint; torque comes last, its rate before it. Shape (n_joints, n, n_columns).
        weights: Of the rows.
        top_speed: Of each joint [rad/s] or [m/s]. Shape (n_joints,).
        ripple: Waves a radian times 2 pi in the columns of each joint's ripple; 0 for none. Shape (n_joints,).
    """

    columns: FloatArray
    weights: Weights
    top_speed: FloatArray
    ripple: FloatArray

    @cached_property
    def sums(self) -> FloatArray:
        """G of each joint. Shape (n_joints, n_columns, n_columns)."""
        return np.stack([Z.T @ (Z * w[:, None]) for Z, w in zip(self.columns, self.weights.rows.T, strict=True)])

    @cached_property
    def counts(self) -> FloatArray:
        """Rows that count, of each joint. Shape (n_joints,)."""
        return np.asarray(np.sum(self.weights.rows > 0.0, axis=0), dtype=np.float64)

    def split(self, block: NDArray[np.intp]) -> list[EquationSums]:
        """Sums over the rows of each block, so that any choice of blocks is a sum of them.

        Args:
            block: Number of the block of each row. Shape (n,).
        """
        chosen = [np.flatnonzero(block == k) for k in range(int(block.max()) + 1)]
        rows = self.weights.rows
        return [
            EquationSums(
                sums=np.stack([Z[at].T @ (Z[at] * w[at, None]) for Z, w in zip(self.columns, rows.T, strict=True)]),
                counts=np.sum(rows[at] > 0.0, axis=0).astype(np.float64),
                weights=self.weights,
                top_speed=self.top_speed,
            )
            for at in chosen
        ]

    def with_rows(self, kept: BoolArray) -> ArmEquations:
        """The same over some of the rows. Shape (n,), bool."""
        return replace(self, weights=replace(self.weights, rows=self.weights.rows * kept[:, None]))

    def with_load(self, load: FloatArray) -> ArmEquations:
        """The same with friction that follows this load [N·m] or [N]. Shape (n, n_joints)."""
        signs = self.columns[:, :, self._friction + column_names().index("coulomb")]
        return self._fill("load", [load_columns(*pair) for pair in zip(load.T, signs, strict=True)])

    def with_torque(self, rows: ArmRows) -> ArmEquations:
        """The same motion with the torques of these rows."""
        changed = self._fill("delay", [-rate[:, None] for rate in rows.torque_rate.T])
        changed.columns[:, :, -2], changed.columns[:, :, -1] = rows.torque_rate.T, rows.torque.T
        return changed

    def with_ripple(self, rows: ArmRows, orders: FloatArray) -> ArmEquations:
        """The same with waves of these orders over the positions of the joints. Shape (n_joints,)."""
        waves = [ripple_columns(rows, j, order) * (order > 0.0) for j, order in enumerate(orders.tolist())]
        return replace(self._fill("ripple", waves), ripple=orders)

    def _fill(self, filled: Filled, values: Sequence[FloatArray]) -> ArmEquations:
        columns, place = self.columns.copy(), find_columns(filled)
        for one, value in zip(columns, values, strict=True):
            one[:, self._friction + place.start : self._friction + place.stop] = value
        return replace(self, columns=columns)

    def with_residuals(self, residuals: FloatArray, rows: ArmRows, *, robust: bool = True) -> ArmEquations:
        """The same with weights and noise as the residuals of a fit have them.

        Args:
            residuals: [N·m] or [N]. Shape (n, n_joints).
            rows: Their times.
            robust: Hold outliers down; otherwise all rows count alike, and what few of them leave counts as noise.
        """
        most = _HUBER if robust else np.inf
        return replace(self, weights=_weigh(residuals, self.moving, rows, most))

    @property
    def moving(self) -> BoolArray:
        """Rows that are compared. Shape (n, n_joints)."""
        return np.asarray(self.weights.rows > 0.0)

    @property
    def _friction(self) -> int:
        """Number of the first column of friction."""
        return int(self.columns.shape[2]) - 2 - len(column_names())


@dataclass(frozen=True)
class EquationSums:
    """All that a fit needs of some of the rows.

    Attributes:
        sums: G of each joint. Shape (n_joints, n_columns, n_columns).
        counts: Rows that count, of each joint. Shape (n_joints,).
        weights: Noise and inflation of all rows.
        top_speed: Of each joint [rad/s] or [m/s]. Shape (n_joints,).
    """

    sums: FloatArray
    counts: FloatArray
    weights: Weights
    top_speed: FloatArray

    @staticmethod
    def join(blocks: Sequence[EquationSums]) -> EquationSums:
        """Of several blocks together."""
        return replace(
            blocks[0],
            sums=np.sum([one.sums for one in blocks], axis=0),
            counts=np.sum([one.counts for one in blocks], axis=0),
        )


def build_equations(arm: SimulatedArm, rows: ArmRows, load: FloatArray) -> ArmEquations:
    """Set up all columns of all joints.

    Args:
        arm: The simulation.
        rows: Motion and torques.
        load: Torque that each joint transmits, for friction that follows it [N·m]. Shape (n, n_joints).
    """
    acceleration = rows.compare(lambda _, __, a: a)
    speed = np.abs(rows.compare(lambda _, v, __: v))
    top = np.maximum(np.quantile(speed, 0.99, axis=0), 1e-9)
    n = len(arm.joints)
    size = rows.links.shape[2] + 1 + len(column_names()) + 2
    columns = np.zeros((n, len(rows), size))
    place = find_columns("motion")
    first = rows.links.shape[2] + 1
    for j, one in enumerate(columns):
        one[:, : first - 1], one[:, first - 1] = rows.links[:, j], acceleration[:, j]
        one[:, first + place.start : first + place.stop] = friction_columns(rows, j, float(top[j]))
    moving = (speed > _SLOW * top).astype(np.float64)
    noise = np.maximum(np.std(rows.torque, axis=0), 1e-9)
    bare = ArmEquations(columns, Weights(moving, noise, np.ones(n)), top, np.zeros(n))
    return bare.with_load(load).with_torque(rows)


def _weigh(residuals: FloatArray, used: BoolArray, rows: ArmRows, most: float) -> Weights:
    """Weights that hold outliers down [huber1964], and how much rows err together."""
    noise = np.array([_measure_spread(r[u], most) for r, u in zip(residuals.T, used.T, strict=True)])
    weights = np.where(used, np.minimum(1.0, most * noise / np.maximum(np.abs(residuals), 1e-300)), 0.0)
    scores = weights * residuals / noise
    return Weights(weights, noise, np.array([_measure_inflation(score, rows) for score in scores.T]))


def _measure_spread(values: FloatArray, most: float) -> float:
    """Standard deviation of most rows, whatever the others are."""
    if values.size == 0:
        return 1.0
    robust = max(float(np.median(np.abs(values))) / 0.6745, 1e-300)
    return max(float(np.sqrt(np.mean(np.minimum(np.abs(values), most * robust) ** 2))), 1e-12)


def _measure_inflation(score: FloatArray, rows: ArmRows) -> float:
    """How much more the sums of blocks stray than those of independent rows would; 1 where they do not."""
    duration = sum(float(np.ptp(rows.time[rows.part == k])) for k in np.unique(rows.part))
    length = max(1, round(_BLOCK_TIME * len(rows) / max(duration, 1e-9)))
    sums = np.add.reduceat(score, np.arange(0, len(score), length))
    total = float(score @ score)
    return max(1.0, float(sums @ sums) / total) if total > 0.0 else 1.0

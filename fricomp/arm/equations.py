"""The equations of an arm as sums over rows: all that any model of it needs to be fitted, however long the recording.

    G_j = Σ_rows w Zᵀ Z,  Z = [links | rotor | friction | rate of torque | torque]  of joint j

A fit is then a matter of small matrices, so that a hundred models cost what one pass over the rows does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from .friction import column_names, friction_columns, load_columns
from .rows import ArmRows
from .simulated_arm import SimulatedArm

BoolArray = NDArray[np.bool_]

__all__ = ["ArmEquations", "BoolArray", "Weights", "build_equations"]

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
        sums: G of each joint. Shape (n_joints, n_columns, n_columns).
        counts: Rows that count, of each joint. Shape (n_joints,).
        weights: Of the rows.
        top_speed: Of each joint [rad/s] or [m/s]. Shape (n_joints,).
    """

    columns: FloatArray
    sums: FloatArray
    counts: FloatArray
    weights: Weights
    top_speed: FloatArray

    def with_rows(self, kept: BoolArray) -> ArmEquations:
        """The same over some of the rows. Shape (n,), bool."""
        weights = Weights(self.weights.rows * kept[:, None], self.weights.noise, self.weights.inflation)
        return _sum_up(self.columns, weights, self.top_speed)

    def with_load(self, load: FloatArray) -> ArmEquations:
        """The same with friction that follows this load [N·m] or [N]. Shape (n, n_joints)."""
        columns = self.columns.copy()
        for j, one in enumerate(columns):
            one[:, -4:-2] = load_columns(load[:, j], one[:, self._sign_place])
        return _sum_up(columns, self.weights, self.top_speed)

    def with_residuals(self, residuals: FloatArray, rows: ArmRows, *, robust: bool = True) -> ArmEquations:
        """The same with weights and noise as the residuals of a fit have them.

        Args:
            residuals: [N·m] or [N]. Shape (n, n_joints).
            rows: Their times.
            robust: Hold outliers down; otherwise all rows count alike, and what few of them leave counts as noise.
        """
        most = _HUBER if robust else np.inf
        return _sum_up(self.columns, _weigh(residuals, self.moving, rows, most), self.top_speed)

    @property
    def moving(self) -> BoolArray:
        """Rows that are compared. Shape (n, n_joints)."""
        return np.asarray(self.weights.rows > 0.0)

    @property
    def _sign_place(self) -> int:
        """Number of the column of the sign of the velocity: the first of friction's."""
        return int(self.columns.shape[2]) - 2 - len(column_names())


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
    signs = rows.compare(lambda _, v, __: np.sign(v))
    columns = np.stack(
        [
            np.column_stack(
                [
                    rows.links[:, j],
                    acceleration[:, j],
                    friction_columns(rows, j, float(top[j])),
                    load_columns(load[:, j], signs[:, j]),
                    rows.torque_rate[:, j],
                    rows.torque[:, j],
                ]
            )
            for j in range(len(arm.joints))
        ]
    )
    moving = (speed > _SLOW * top).astype(np.float64)
    noise = np.maximum(np.std(rows.torque, axis=0), 1e-9)
    return _sum_up(columns, Weights(moving, noise, np.ones(len(arm.joints))), top)


def _sum_up(columns: FloatArray, weights: Weights, top_speed: FloatArray) -> ArmEquations:
    sums = np.stack([Z.T @ (Z * w[:, None]) for Z, w in zip(columns, weights.rows.T, strict=True)])
    return ArmEquations(columns, sums, np.sum(weights.rows > 0.0, axis=0), weights, top_speed)


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

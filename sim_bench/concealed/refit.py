"""Strength of a concealed effect: what is left of its torque after the simulation's own terms are refitted.

The equation of motion is multiplied by Hann windows phi of 42 ms, one every 21 ms (weak form), so that the
noise of the position enters through phi'' instead of through a second difference of samples. Rows where the joint
sticks are known only as well as the bristle is, which is as well as the encoder resolves it.

    ENR = RMS over rows of (what is left / noise of the row)
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, NamedTuple

import numpy as np

from .dynamics import SAMPLE_PERIOD

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .dynamics import Motion
    from .joint import Joint
    from .sensing import Sensed

__all__ = ["Rows", "build_rows", "compute_enr", "find_intervals", "left_after_refit", "weak_form"]

_WIDTH, _STEP = 42, 21  # [samples] of a window, between windows
_REST = 2e-3  # [rad/s] below it a joint counts as sticking
_SHARE = 0.8  # of the energy that a location must carry


class Rows(NamedTuple):
    """The weak form of one recording.

    Attributes:
        friction: Columns of a Stribeck curve for each direction, divided by the noise; shape (n_rows, 8).
        body: Inertia, two gravity and an offset column, divided by the noise; shape (n_rows, 4).
        deviation: Noise of each row [N·m], shape (n_rows,).
    """

    friction: NDArray[np.float64]
    body: NDArray[np.float64]
    deviation: NDArray[np.float64]


def _window() -> NDArray[np.float64]:
    values = np.sin(np.pi * (np.arange(_WIDTH) + 0.5) / _WIDTH) ** 2
    return np.asarray(values / values.sum())


def weak_form(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Means of columns under the windows; shape (n_samples,) or (n_samples, k) to (n_rows,) or (n_rows, k)."""
    count = (values.shape[0] - _WIDTH) // _STEP + 1
    starts = _STEP * np.arange(count)
    windows = values[starts[:, None] + np.arange(_WIDTH)]
    return np.asarray(np.einsum("rw...,w->r...", windows, _window()))


def _second_form(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """phi'' * values: the weak form of their second derivative."""
    curvature = np.gradient(np.gradient(_window(), SAMPLE_PERIOD), SAMPLE_PERIOD)
    count = (values.size - _WIDTH) // _STEP + 1
    starts = _STEP * np.arange(count)
    return np.asarray(values[starts[:, None] + np.arange(_WIDTH)] @ curvature)


def _friction_columns(motion: Motion, joint: Joint) -> NDArray[np.float64]:
    """Level, static surplus, its derivative by Stribeck velocity, and slope, for each direction."""
    columns = []
    for direction, sign in (("forward", 1.0), ("reverse", -1.0)):
        v = np.where(sign * motion.velocity > 0.0, motion.velocity, 0.0)
        sense = np.where(sign * motion.sense > 0.0, motion.sense, 0.0)
        x = v / joint.fields[f"stribeck_{direction}"]
        fall = np.exp(-x * x)
        columns += [sense, sense * fall, sense * fall * x * x, v]
    return np.stack(columns, axis=1)


def _row_noise(motion: Motion, sensed: Sensed, joint: Joint) -> NDArray[np.float64]:
    noise = weak_form(sensed.torque_error) - joint.fields["inertia"] * _second_form(sensed.position_error)
    sticking = weak_form((np.abs(motion.velocity) < _REST).astype(np.float64))
    moving = sticking == 0.0
    level = np.std(noise[moving]) if moving.sum() > 50 else np.std(noise)
    bristle = joint.fields["base_sigma_0"] * joint.fields["resolution"] / np.sqrt(12.0)
    return np.asarray(np.sqrt(level**2 + sticking * bristle**2))


def build_rows(motion: Motion, sensed: Sensed, joint: Joint) -> Rows:
    """Regressors of the rigid joint along the true motion, each row over its noise."""
    q = motion.position
    body = np.stack([motion.acceleration, np.sin(q), np.cos(q), np.ones_like(q)], axis=1)
    deviation = _row_noise(motion, sensed, joint)
    friction = weak_form(_friction_columns(motion, joint)) / deviation[:, None]
    return Rows(friction, weak_form(body) / deviation[:, None], deviation)


def left_after_refit(
    torque: NDArray[np.float64],
    rows: Rows,
    against: Literal["refit", "friction", "nothing"],
    also: NDArray[np.float64] | None = None,
) -> NDArray[np.float64]:
    """What the simulation's own terms cannot take up of a torque [N·m], over the noise; shape (n_rows,).

    Args:
        torque: Shape (n_samples,).
        rows: Of the recording.
        against: Which terms are refitted.
        also: A further torque whose amplitude is refitted with them.
    """
    wanted = weak_form(torque) / rows.deviation
    parts = {"refit": [rows.friction, rows.body], "friction": [rows.friction], "nothing": []}[against]
    if also is not None:
        parts = [*parts, (weak_form(also) / rows.deviation)[:, None]]
    if not parts:
        return np.asarray(wanted)
    columns = np.concatenate(parts, axis=1)
    scale = np.linalg.norm(columns, axis=0)
    columns = columns[:, scale > 0.0] / scale[scale > 0.0]
    solution = np.linalg.lstsq(columns, wanted, rcond=1e-9)[0]
    return np.asarray(wanted - columns @ solution)


def compute_enr(left: NDArray[np.float64]) -> float:
    """Effect-to-noise ratio of what is left."""
    return float(np.sqrt(np.mean(left**2)))


def find_intervals(left: NDArray[np.float64], start_time: float) -> list[tuple[float, float]]:
    """The fewest rows that carry 80 % of the energy, as intervals of time [s]."""
    energy = left**2
    order = np.argsort(energy)[::-1]
    needed = int(np.searchsorted(np.cumsum(energy[order]), _SHARE * energy.sum())) + 1
    inside = np.zeros(energy.size + 2, dtype=bool)
    inside[1:-1][order[:needed]] = True
    edges = np.flatnonzero(np.diff(inside.astype(np.int8)))
    centre = 0.5 * (_WIDTH - _STEP) * SAMPLE_PERIOD
    return [
        (start_time + centre + a * _STEP * SAMPLE_PERIOD, start_time + centre + b * _STEP * SAMPLE_PERIOD)
        for a, b in zip(edges[::2], edges[1::2], strict=True)
    ]

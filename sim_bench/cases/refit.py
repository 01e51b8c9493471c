"""Strength of a concealed effect: what is left of its torque after the simulation's own terms are refitted.

The equation of motion is multiplied by Hann windows phi of 42 ms, one every 21 ms (weak form), so that the
noise of the position enters through phi'' instead of through a second difference of samples. Rows where the joint
sticks are known only as well as the bristle is, which is as well as the encoder resolves it.

    ENR = RMS over rows of (what is left / noise of the row)

Where an effect acts is asked of every sample, with a window about each: what it leaves at a reversal or an impact is
shorter than the way from one row to the next, and two grids of such rows agree on half of it.
"""

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .dynamics import SAMPLE_PERIOD, Motion
from .joint import Joint
from .sensing import Sensed

_WIDTH, _STEP = 42, 21  # [samples] of a window, between windows
_REST = 2e-3  # [rad/s] below it a joint counts as sticking
_SHARE = 0.8  # of the energy that a location must carry
_BLOCK = 2**15  # rows


class Rows(NamedTuple):
    """The weak form of one recording.

    Attributes:
        friction: Columns of a Stribeck curve for each direction, divided by the noise; shape (n_rows, 8).
        body: Inertia, two gravity and an offset column, divided by the noise; shape (n_rows, 4).
        deviation: Noise of each row [N·m], shape (n_rows,).
        step: Samples between windows.
    """

    friction: NDArray[np.float64]
    body: NDArray[np.float64]
    deviation: NDArray[np.float64]
    step: int = _STEP


def _compute_window() -> NDArray[np.float64]:
    values = np.sin(np.pi * (np.arange(_WIDTH) + 0.5) / _WIDTH) ** 2
    return np.asarray(values / values.sum())


def compute_weak_form(values: NDArray[np.float64], step: int = _STEP) -> NDArray[np.float64]:
    """Means of columns under windows `step` samples apart; shape (n_samples, ...) to (n_rows, ...)."""
    blocks = _list_windows(values, step)
    return np.concatenate([np.einsum("rw...,w->r...", block, _compute_window()) for block in blocks])


def _compute_second_form(values: NDArray[np.float64], step: int) -> NDArray[np.float64]:
    """phi'' * values: the weak form of their second derivative."""
    curvature = np.gradient(np.gradient(_compute_window(), SAMPLE_PERIOD), SAMPLE_PERIOD)
    return np.concatenate([block @ curvature for block in _list_windows(values, step)])


def _list_windows(values: NDArray[np.float64], step: int) -> Iterator[NDArray[np.float64]]:
    """The samples under each window; a window about each sample of a recording is more than memory should hold."""
    starts = step * np.arange((values.shape[0] - _WIDTH) // step + 1)
    for first in range(0, starts.size, _BLOCK):
        yield values[starts[first : first + _BLOCK, None] + np.arange(_WIDTH)]


def _compute_friction_columns(motion: Motion, joint: Joint) -> NDArray[np.float64]:
    """Level, static surplus, its derivative by Stribeck velocity, and slope, for each direction."""
    columns = []
    for direction, sign in (("forward", 1.0), ("reverse", -1.0)):
        v = np.where(sign * motion.velocity > 0.0, motion.velocity, 0.0)
        sense = np.where(sign * motion.sense > 0.0, motion.sense, 0.0)
        x = v / joint.fields[f"stribeck_{direction}"]
        fall = np.exp(-x * x)
        columns += [sense, sense * fall, sense * fall * x * x, v]
    return np.stack(columns, axis=1)


def _compute_row_noise(motion: Motion, sensed: Sensed, joint: Joint, step: int) -> NDArray[np.float64]:
    noise = compute_weak_form(sensed.torque_error, step) - joint.fields["inertia"] * _compute_second_form(
        sensed.position_error, step
    )
    sticking = compute_weak_form((np.abs(motion.velocity) < _REST).astype(np.float64), step)
    moving = sticking == 0.0
    level = np.std(noise[moving]) if moving.sum() > 50 else np.std(noise)
    bristle = joint.fields["base_sigma_0"] * joint.fields["resolution"] / np.sqrt(12.0)
    return np.asarray(np.sqrt(level**2 + sticking * bristle**2))


def build_rows(motion: Motion, sensed: Sensed, joint: Joint, step: int = _STEP) -> Rows:
    """Regressors of the rigid joint along the true motion, each row over its noise.

    Args:
        motion: The true one.
        sensed: What was recorded of it.
        joint: Without effects.
        step: Samples between windows; 1 for one about each sample.
    """
    q = motion.position
    body = np.stack([motion.acceleration, np.sin(q), np.cos(q), np.ones_like(q)], axis=1)
    deviation = _compute_row_noise(motion, sensed, joint, step)
    friction = compute_weak_form(_compute_friction_columns(motion, joint), step) / deviation[:, None]
    return Rows(friction, compute_weak_form(body, step) / deviation[:, None], deviation, step)


def compute_left_after_refit(
    torque: NDArray[np.float64],
    rows: Rows,
    against: Literal["refit", "friction", "nothing"],
    also: Sequence[NDArray[np.float64]] = (),
) -> NDArray[np.float64]:
    """What the simulation's own terms cannot take up of a torque [N·m], over the noise; shape (n_rows,).

    Args:
        torque: Shape (n_samples,).
        rows: Of the recording.
        against: Which terms are refitted.
        also: Further torques whose amplitudes are refitted with them.
    """
    wanted = compute_weak_form(torque, rows.step) / rows.deviation
    parts = {"refit": [rows.friction, rows.body], "friction": [rows.friction], "nothing": []}[against]
    parts += [(compute_weak_form(one, rows.step) / rows.deviation)[:, None] for one in also]
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


def find_intervals(left: NDArray[np.float64], step: int) -> list[tuple[float, float]]:
    """The fewest rows that carry 80 % of the energy, as intervals of time since the first sample [s].

    Args:
        left: What a refit leaves, over the noise; shape (n_rows,).
        step: Samples between the rows.
    """
    energy = left**2
    order = np.argsort(energy)[::-1]
    needed = int(np.searchsorted(np.cumsum(energy[order]), _SHARE * energy.sum())) + 1
    inside = np.zeros(energy.size + 2, dtype=bool)
    inside[1:-1][order[:needed]] = True
    edges = np.flatnonzero(np.diff(inside.astype(np.int8)))
    first = 0.5 * (_WIDTH - 1 - step)  # [samples] half a step before the middle of the first window
    times = SAMPLE_PERIOD * (first + step * edges)
    return [(float(a), float(b)) for a, b in zip(times[::2], times[1::2], strict=True)]

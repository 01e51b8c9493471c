"""Friction that grows with a load that was measured: from torque, direction of motion and load alone.

tau = offset + a N + (F_c + c N) sgn(v) + F_v v + J dv/dt, with the load N of the column `normal_load`. A pressure or a
weight that a bench holds for a whole recording moves offset and friction together from one to the next, and a model of
the motion that knows of no load has one of each.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from ..effects import EFFECTS
from ..record.result import NamedEffect, Quantity
from .settings import CHANNELS

_VISCOUS, _SLOPE = 3, 4  # positions of F_v and c among the columns


class _Rows(NamedTuple):
    """Means over windows in which a joint slides one way, of all recordings. Shapes (n,).

    Attributes:
        load: In the unit of the column.
        torque: [N·m] or [N].
        velocity: [rad/s] or [m/s].
        acceleration: [rad/s²] or [m/s²].
        block: Stretch of time that the window is of; those of a recording have numbers in order.
    """

    load: FloatArray
    torque: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    block: FloatArray


def has_several_loads(recordings: Sequence[Recording]) -> bool:
    """Whether a load was measured, and is not the same all the time."""
    loads = [one.normal_load for one in recordings]
    known = [np.asarray(load) for load in loads if load is not None]
    if len(known) < len(loads) or not known:
        return False
    low, high = np.quantile(np.concatenate(known), [0.05, 0.95])
    return bool(high - low > CHANNELS.loads * abs(high + low) / 2.0)


def read_measured_load(recordings: Sequence[Recording]) -> NamedEffect | None:
    """Coulomb friction that grows with the measured load; None where it does not, or where the load is always one."""
    if not has_several_loads(recordings):
        return None
    rows = _join([_average(one, CHANNELS.load_blocks * k) for k, one in enumerate(recordings)])
    if rows is None:
        return None
    columns = _build_columns(rows)
    slopes = _leave_each_out(columns, rows)
    whole = float(_solve(columns, rows.torque)[_SLOPE])
    count = len(slopes)
    scatter = float(np.sqrt((count - 1) * np.mean((slopes - slopes.mean()) ** 2)))  # the jackknife's
    # A bench that is pressed harder is slower: viscous friction may take some of what the load does.
    apart = float(_solve(np.delete(columns, _VISCOUS, axis=1), rows.torque)[_SLOPE - 1]) - whole
    deviation = float(np.hypot(scatter, apart))
    without = np.delete(columns, _SLOPE, axis=1)
    before, after = (_measure_held_out(one, rows) for one in (without, columns))
    if whole < CHANNELS.load_sure * deviation or before - after < CHANNELS.load_matters * before:
        return None
    unit, half = recordings[0].metadata.torque_unit, 1.96 * deviation
    effect = EFFECTS["load_coulomb"]
    return NamedEffect(
        name=effect.name,
        kind=effect.kind,
        parameters={"coefficient": Quantity(whole, f"{unit} a unit of normal_load", (whole - half, whole + half))},
        equation="tau_f = (F_c + c N) sgn(v), with the measured load N",
        sentence=(
            f"{effect.says}, as normal_load shows; on data left out {after:.3g} {unit} are missed with it, and "
            f"{before:.3g} {unit} without"
        ),
        citation=effect.citation,
    )


def _average(recording: Recording, first: int) -> _Rows | None:
    """Means over windows in which the joint slides one way; None where there are too few.

    Args:
        recording: With a load.
        first: Number of its first block.
    """
    size = max(3, round(CHANNELS.load_window / recording.sample_period))
    count = len(recording) // size
    if count < CHANNELS.load_blocks or recording.normal_load is None:
        return None
    time, position, torque, load = (
        np.asarray(one)[: count * size].reshape(count, size)
        for one in (recording.time, recording.position, recording.torque, recording.normal_load)
    )
    span = time[:, -1] - time[:, 0]
    velocity = (position[:, -1] - position[:, 0]) / span
    middle = time.mean(axis=1)
    around = np.sign(velocity)
    whole = span < CHANNELS.whole * size * recording.sample_period
    keep = whole & (np.abs(velocity) > CHANNELS.load_speed * np.quantile(np.abs(velocity), 0.95))
    keep[1:-1] &= (around[1:-1] == around[:-2]) & (around[1:-1] == around[2:])
    keep[[0, -1]] = False
    block = first + np.floor(CHANNELS.load_blocks * np.arange(count) / count)
    acceleration = np.gradient(velocity, middle)
    values = (load.mean(axis=1), torque.mean(axis=1), velocity, acceleration, block)
    return _Rows(*(one[keep] for one in values))


def _join(parts: Sequence[_Rows | None]) -> _Rows | None:
    found = [one for one in parts if one is not None]
    if len(found) < len(parts):
        return None
    rows = _Rows(*(np.concatenate(column) for column in zip(*found, strict=True)))
    both = min(np.count_nonzero(rows.velocity > 0.0), np.count_nonzero(rows.velocity < 0.0))
    return rows if both >= CHANNELS.load_rows else None


def _build_columns(rows: _Rows) -> FloatArray:
    """What offset, load, Coulomb and viscous friction, friction a load and inertia multiply. Shape (n, 6)."""
    sign = np.sign(rows.velocity)
    one = np.ones_like(sign)
    return np.stack([one, rows.load, sign, rows.velocity, sign * rows.load, rows.acceleration], axis=1)


def _solve(columns: FloatArray, torque: FloatArray) -> FloatArray:
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    return np.asarray(np.linalg.lstsq(columns / size, torque, rcond=1e-10)[0] / size)


def _leave_each_out(columns: FloatArray, rows: _Rows) -> FloatArray:
    """The slope without each block. Shape (n_blocks,)."""
    kept = [rows.block != one for one in np.unique(rows.block)]
    return np.array([_solve(columns[keep], rows.torque[keep])[_SLOPE] for keep in kept])


def _measure_held_out(columns: FloatArray, rows: _Rows) -> float:
    """Root mean square of what every other block's fit leaves of the others [N·m] or [N]."""
    odd = rows.block % 2 == 1
    left = np.zeros_like(rows.torque)
    for rest in (odd, ~odd):
        left[rest] = rows.torque[rest] - columns[rest] @ _solve(columns[~rest], rows.torque[~rest])
    return compute_rms(left)

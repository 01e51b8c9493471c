"""Errors of a model over a recorded motion: pooled over parts, with intervals from blocks of time."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray

from .motion import MotionPart, RecordedMotion, low_pass
from .result import PositionError, TorqueError
from .settings import EVALUATION, HORIZONS

__all__ = ["Simulate", "Spans", "choose_starts", "measure_positions", "measure_torque", "select_rows"]

Index = NDArray[np.intp]
Rows = NDArray[np.bool_]
Spans = Sequence[tuple[float, float]]
Simulate = Callable[[int, Index, Sequence[int]], FloatArray]
"""Position of the model in a part, from starts, after numbers of samples. Shape (n_lengths, n_starts)."""


def select_rows(part: MotionPart, spans: Spans | None) -> Rows:
    """Samples in motion within the spans of time; all in motion where none are given. Shape (n,)."""
    if spans is None:
        return part.moves
    inside = np.zeros(part.time.size, dtype=bool)
    for start, stop in spans:
        inside |= (part.time >= start) & (part.time < stop)
    return part.moves & inside


def measure_torque(
    motion: RecordedMotion, recorded: Sequence[FloatArray], model: Sequence[FloatArray], spans: Spans | None = None
) -> TorqueError:
    """Compare torques along the motion, in its band, where the joint moves.

    Args:
        motion: The recorded motion.
        recorded: Torque that acted at the samples of each part.
        model: Torque of the model there.
        spans: Times that count; all of them if None.

    Raises:
        RecordingError: The joint does not move in these times.
    """
    error, size = [], []
    for part, torque, predicted in zip(motion.parts, recorded, model, strict=True):
        rows = select_rows(part, spans)
        error.append(low_pass(torque - predicted, motion.band, part.dt)[rows])
        size.append(low_pass(torque, motion.band, part.dt)[rows])
    left, whole = np.concatenate(error), np.concatenate(size)
    if left.size < EVALUATION.blocks:
        raise RecordingError("the joint hardly moves in the time that is evaluated: give a longer one")
    blocks = np.array([float(np.mean(one**2)) for one in np.array_split(left, EVALUATION.blocks)])
    return TorqueError(
        rms=float(np.sqrt(np.mean(left**2))),
        ci95_rms=_bootstrap(blocks, lambda drawn: np.sqrt(np.mean(drawn, axis=1))),
        median=float(np.median(np.abs(left))),
        recorded=float(np.std(whole)),
        unit=motion.torque_unit,
        band=motion.band,
        duration=left.size * motion.dt,
    )


def measure_positions(
    motion: RecordedMotion, simulate: Simulate, spans: Spans | None = None
) -> tuple[PositionError, ...]:
    """Simulate from many measured states, and compare where the model comes to with where the joint came to."""
    found: dict[float, list[tuple[FloatArray, FloatArray]]] = {}
    for number, (part, starts) in enumerate(zip(motion.parts, choose_starts(motion, spans), strict=True)):
        horizons = _list_horizons(part)
        if starts.size == 0 or not horizons:
            continue
        lengths = [round(one / part.dt) for one in horizons]
        for horizon, length, reached in zip(horizons, lengths, simulate(number, starts, lengths), strict=True):
            true = part.position[starts + length]
            most = EVALUATION.runaway * motion.range
            error = np.clip(np.nan_to_num(np.abs(reached - true), nan=most, posinf=most), 0.0, most)
            found.setdefault(horizon, []).append((error, np.abs(true - part.position[starts])))
    return tuple(_summarise(motion, horizon, pairs) for horizon, pairs in sorted(found.items()))


def choose_starts(motion: RecordedMotion, spans: Spans | None = None) -> list[Index]:
    """Starts in each part: evenly over the samples in motion that leave room for its longest simulation."""
    options = []
    for part in motion.parts:
        horizons, rows = _list_horizons(part), select_rows(part, spans)
        length = round(horizons[-1] / part.dt) if horizons else part.time.size
        inside = rows.copy()
        if spans is not None:  # a simulation stays within the time that counts
            inside = rows & select_rows_at(part, spans, length)
        inside[max(part.time.size - length, 0) :] = False
        options.append(np.flatnonzero(inside))
    total = sum(one.size for one in options)
    if total == 0:
        return options
    chosen = np.unique(np.linspace(0, total - 1, min(EVALUATION.starts, total)).round().astype(np.intp))
    ends = np.cumsum([0, *(one.size for one in options)])
    return [
        one[chosen[(chosen >= a) & (chosen < b)] - a] for one, a, b in zip(options, ends[:-1], ends[1:], strict=True)
    ]


def select_rows_at(part: MotionPart, spans: Spans, length: int) -> Rows:
    """Samples that are in one of the spans together with the one `length` samples later. Shape (n,)."""
    inside = np.zeros(part.time.size, dtype=bool)
    for start, stop in spans:
        inside |= (part.time >= start) & (part.time + length * part.dt < stop)
    return inside


def _list_horizons(part: MotionPart) -> list[float]:
    """Horizons that leave half of the part for starts, in whole samples."""
    length = part.time[-1] - part.time[0]
    return [one for one in HORIZONS if one <= 0.5 * length and round(one / part.dt) >= 1]


def _summarise(motion: RecordedMotion, horizon: float, pairs: Sequence[tuple[FloatArray, FloatArray]]) -> PositionError:
    error, travel = (np.concatenate([pair[k] for pair in pairs]) for k in (0, 1))
    blocks = np.array_split(error, min(EVALUATION.blocks, error.size))
    rng = np.random.default_rng(0)
    drawn = [
        float(np.median(np.concatenate([blocks[k] for k in rng.integers(0, len(blocks), len(blocks))])))
        for _ in range(EVALUATION.draws)
    ]
    low, high = np.quantile(drawn, [0.025, 0.975])
    return PositionError(
        after=horizon,
        median=float(np.median(error)),
        ci95_median=(float(low), float(high)),
        rms=float(np.sqrt(np.mean(error**2))),
        travel=float(np.median(travel)),
        starts=int(error.size),
        unit=motion.position_unit,
    )


def _bootstrap(values: FloatArray, summarise: Callable[[FloatArray], FloatArray]) -> tuple[float, float]:
    """95 % interval of a figure over blocks drawn with replacement."""
    draws = np.random.default_rng(0).integers(0, values.size, (EVALUATION.draws, values.size))
    low, high = np.quantile(summarise(values[draws]), [0.025, 0.975])
    return float(low), float(high)

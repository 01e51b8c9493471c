"""Errors of a model over a recorded motion: pooled over parts, with intervals from blocks of time."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from .motion import Index, MotionPart, RecordedMotion, Rows, low_pass
from .result import PositionError, TorqueError
from .settings import EVALUATION, HORIZONS

Spans = Sequence[tuple[float, float]]
Pairs = dict[float, list[tuple[FloatArray, FloatArray]]]
"""Error of each start, and the way that the joint went, by the time after the start [s]."""
Simulate = Callable[[int, Index, Sequence[int]], FloatArray]
"""Position of the model in a part, from starts, after numbers of samples. Shape (n_lengths, n_starts)."""


def mark_spans(time: FloatArray, spans: Spans) -> Rows:
    """Samples within the spans of time [s]. Shape (n,)."""
    inside = np.zeros(time.size, dtype=bool)
    for start, stop in spans:
        inside |= (time >= start) & (time < stop)
    return inside


def select_rows(part: MotionPart, spans: Spans | None) -> Rows:
    """Samples in motion within the spans of time; all in motion where none are given. Shape (n,)."""
    return part.moves if spans is None else part.moves & mark_spans(part.time, spans)


class TorqueLeft(NamedTuple):
    """What a model leaves of the torque, at the samples that count.

    Attributes:
        error: Recorded torque less that of the model, in the band. Shape (n,).
        recorded: The recorded torque, in the band. Shape (n,).
    """

    error: FloatArray
    recorded: FloatArray


def measure_torque(
    motion: RecordedMotion, recorded: Sequence[FloatArray], model: Sequence[FloatArray], spans: Spans | None
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
    return summarise_torque(motion, [compare_torque(motion, recorded, model, spans)])


def compare_torque(
    motion: RecordedMotion, recorded: Sequence[FloatArray], model: Sequence[FloatArray], spans: Spans | None = None
) -> TorqueLeft:
    """What a model leaves; see `measure_torque`."""
    error, size = [], []
    for part, torque, predicted in zip(motion.parts, recorded, model, strict=True):
        rows = select_rows(part, spans)
        error.append(low_pass(torque - predicted, motion.band, part.dt)[rows])
        size.append(low_pass(torque, motion.band, part.dt)[rows])
    return TorqueLeft(np.concatenate(error), np.concatenate(size))


def summarise_torque(motion: RecordedMotion, found: Sequence[TorqueLeft]) -> TorqueError:
    """The figures of what models leave, pooled over the times of each.

    Raises:
        RecordingError: The joint does not move in these times.
    """
    left, whole = (np.concatenate([getattr(one, name) for one in found]) for name in ("error", "recorded"))
    if left.size < EVALUATION.blocks:
        raise RecordingError("the joint hardly moves in the time that is evaluated: give a longer one")
    blocks = np.array([float(np.mean(one**2)) for one in np.array_split(left, EVALUATION.blocks)])
    return TorqueError(
        rms=compute_rms(left),
        ci95_rms=_bootstrap(blocks, lambda drawn: np.sqrt(np.mean(drawn, axis=1))),
        median=float(np.median(np.abs(left))),
        recorded=float(np.std(whole)),
        unit=motion.torque_unit,
        band=motion.band,
        duration=left.size * motion.dt,
    )


class Starts(NamedTuple):
    """Where simulations start, a part a row.

    Attributes:
        horizons: Times after which their errors are measured [s], rising; empty where a part is too short.
        chosen: Samples.
    """

    horizons: list[list[float]]
    chosen: list[Index]


def measure_positions(motion: RecordedMotion, simulate: Simulate, spans: Spans | None) -> tuple[PositionError, ...]:
    """Simulate from many measured states, and compare where the model comes to with where the joint came to."""
    return summarise_positions(motion, compare_positions(motion, simulate, spans))


def compare_positions(
    motion: RecordedMotion, simulate: Simulate, spans: Spans | None, count: int = EVALUATION.starts
) -> Pairs:
    """Simulate from many measured states; see `measure_positions`."""
    starts = select_starts([one.time for one in motion.parts], [one.moves for one in motion.parts], spans, count)
    return compare_joints([motion], starts, lambda *of: simulate(*of)[:, :, None])[0]


def compare_joints(motions: Sequence[RecordedMotion], starts: Starts, simulate: Simulate) -> list[Pairs]:
    """The same of joints that move together: `simulate` gives the positions of all, in an axis behind the starts."""
    found: list[Pairs] = [{} for _ in motions]
    for number, (horizons, chosen) in enumerate(zip(starts.horizons, starts.chosen, strict=True)):
        if chosen.size == 0 or not horizons:
            continue
        lengths = [round(one / motions[0].parts[number].dt) for one in horizons]
        ends = simulate(number, chosen, lengths)
        for j, motion in enumerate(motions):
            true = motion.parts[number].position
            for horizon, length, reached in zip(horizons, lengths, ends[:, :, j], strict=True):
                there = true[chosen + length]
                found[j].setdefault(horizon, []).append((reached - there, np.abs(there - true[chosen])))
    return found


def select_starts(
    times: Sequence[FloatArray],
    moves: Sequence[Rows],
    spans: Spans | None,
    count: int,
    longest: float = HORIZONS[-1],
) -> Starts:
    """Choose starts evenly over the samples in motion that leave room for the longest simulation of their part.

    Args:
        times: Of the samples of each part, evenly spaced [s].
        moves: Whether the joint moves there.
        spans: Times that a simulation stays within [s]; all if None.
        count: How many at most.
        longest: Of the simulations [s].
    """
    horizons = [[one for one in _list_horizons(time) if one <= longest] for time in times]
    options = []
    for time, moving, each in zip(times, moves, horizons, strict=True):
        dt = time[1] - time[0]
        length = round(each[-1] / dt) if each else time.size
        inside = moving.copy()
        inside[max(time.size - length, 0) :] = False
        if spans is not None:
            inside &= np.any([(time >= a) & (time + length * dt < b) for a, b in spans], axis=0)
        options.append(np.flatnonzero(inside))
    ends = np.cumsum([0, *(one.size for one in options)])
    if ends[-1] == 0:
        return Starts(horizons, options)
    even = np.linspace(0, ends[-1] - 1, min(count, int(ends[-1]))).round().astype(np.intp)
    chosen = np.unique(even)
    pairs = zip(options, ends[:-1], ends[1:], strict=True)
    return Starts(horizons, [one[chosen[(chosen >= a) & (chosen < b)] - a] for one, a, b in pairs])


def _list_horizons(time: FloatArray) -> list[float]:
    """Horizons that leave half of the part for starts, in whole samples."""
    dt = time[1] - time[0]
    return [one for one in HORIZONS if one <= 0.5 * (time[-1] - time[0]) and round(one / dt) >= 1]


def summarise_positions(
    motion: RecordedMotion, found: Mapping[float, Sequence[tuple[FloatArray, FloatArray]]]
) -> tuple[PositionError, ...]:
    """Errors and travels of simulations as figures, by their length.

    Args:
        motion: The recorded motion.
        found: Error of each start and the way that the joint went, from each part, by the time after the start.
    """
    return tuple(_summarise(motion, horizon, pairs) for horizon, pairs in sorted(found.items()))


def _summarise(motion: RecordedMotion, horizon: float, pairs: Sequence[tuple[FloatArray, FloatArray]]) -> PositionError:
    error, travel = (np.concatenate([pair[k] for pair in pairs]) for k in (0, 1))
    most = EVALUATION.runaway * motion.range
    error = np.clip(np.nan_to_num(np.abs(error), nan=most, posinf=most), 0.0, most)
    low, high = np.quantile(_draw_medians(error), [0.025, 0.975])
    return PositionError(
        after=horizon,
        median=float(np.median(error)),
        ci95_median=(float(low), float(high)),
        rms=compute_rms(error),
        travel=float(np.median(travel)),
        starts=int(error.size),
        unit=motion.position_unit,
    )


def _draw_medians(error: FloatArray) -> FloatArray:
    """Medians over blocks of neighbours that are drawn with replacement. Shape (n_draws,)."""
    blocks = np.array_split(error, min(EVALUATION.blocks, error.size))
    filled = np.full((len(blocks), max(map(len, blocks))), np.nan)  # blocks differ in length by one
    for row, block in zip(filled, blocks, strict=True):
        row[: len(block)] = block
    picked = np.random.default_rng(0).integers(0, len(blocks), (EVALUATION.draws, len(blocks)))
    drawn = np.sort(filled[picked].reshape(EVALUATION.draws, -1), axis=1)  # what is no number comes last
    counts, rows = np.sum(np.isfinite(drawn), axis=1), np.arange(EVALUATION.draws)
    return np.asarray(0.5 * (drawn[rows, (counts - 1) // 2] + drawn[rows, counts // 2]))


def _bootstrap(values: FloatArray, summarise: Callable[[FloatArray], FloatArray]) -> tuple[float, float]:
    """95 % interval of a figure over blocks drawn with replacement."""
    draws = np.random.default_rng(0).integers(0, values.size, (EVALUATION.draws, values.size))
    low, high = np.quantile(summarise(values[draws]), [0.025, 0.975])
    return float(low), float(high)

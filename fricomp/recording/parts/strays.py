"""Rows that leave the motion around them: wrapped counters, others' rows, torn stretches, outliers."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.checks.quantum import measure_quantum, snap_period
from fricomp.recording.checks.timing_checks import find_gap_length
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

from .kicks import find_answered_kicks

Rows = NDArray[np.bool_]

_JUMP = 30.0
"""Step over the steps around it, above which no motion makes it."""
_WRAP = 10.0
"""The same of a wrap, which also has a known size."""
_FAR = 4.0
"""Steps of a fast motion from which on one that is a tenth as fast before and after makes none."""
_LEAST_JUMP = 0.01
"""Part of the travel below which a jump does no harm."""
_HELD = 20
"""Rows of one position from which on they are a stretch of their own beside a jump."""
_TAIL = 0.01
"""Part of the rows at either end of the range that does not count as travel: outliers would make it."""
_MOST_STRAYS = 0.3
"""Part of the rows above which it is not clear which of them are the joint's."""
_SPEED = 2.0
"""Times the usual top speed that a joint may reach while others' rows are in between."""
_SAME_RANGE = 0.05
"""Relative error of the jumps of a counter, within which they are of one range."""
_FASTEST = 0.98
"""Part of the steps that are no longer than those of a fast motion."""
_ALIKE = 0.5
"""Part of the ends of equal rows that leap, from which on these rows interrupt the motion."""
_LEAP = 5.0
"""Usual large steps that make a leap."""
_FEWEST_REPEATS, _MOST_REPEATS = 5, 0.75
"""Rows of equal values: at least so many, and at most this part of all, as of two others that publish as often."""
_CANDIDATES = 6
"""Most frequent rows that are looked at: a log has a few long rests, each of which repeats its own values."""
_SHORT_RUN = 50.0
"""Mean rows of a stretch of equal values up to which it interrupts; a joint at rest holds its values for longer."""
_TORQUE_REACH = 3
"""Rows before and after that a torque is compared with."""
_FEWEST_TORQUES = 50
"""Rows below which a torque has no outliers that could be told."""
_USUAL_TORQUES = 0.9
"""Part of the rows whose distance from their median is usual."""
_WILD = 8.0
"""Usual distances that make an outlier."""
_LEAST_WILD = 0.03
"""Part of the torque's range below which an outlier does no harm."""
_MOST_WILD = 0.1
"""Part of the rows above which the torque is what was recorded."""

_LONGEST_FAILURE = 5
"""Rows in which readings fail in turn."""
_MOST_FAILED = 0.2
"""Part of the rows above which a torque of 0 is what was recorded."""


class Wrap(NamedTuple):
    """A counter that was unwrapped.

    Attributes:
        period: Its range [rad] or [m].
        times: How often it wrapped.
    """

    period: float
    times: int


class Continuity(NamedTuple):
    """Which rows follow the motion.

    Attributes:
        keep: Rows of the motion. Shape (n_samples,).
        cuts: Rows at which the motion jumps and goes on elsewhere.
    """

    keep: Rows
    cuts: NDArray[np.intp]


class WildTorque(NamedTuple):
    """Rows whose torque is none of the joint's.

    Attributes:
        failed: Those in which a reading failed, and 0 was logged. Shape (n_samples,).
        outliers: Those whose torque is far from the ones before and after it, which hold together. Shape (n_samples,).
    """

    failed: Rows
    outliers: Rows

    @property
    def rows(self) -> Rows:
        """Both."""
        return self.failed | self.outliers


def find_period(recording: Recording) -> Wrap | None:
    """The range of a position that wraps round; None where it does not, or jumps by all sorts of distances."""
    step = np.diff(recording.position)
    size, around, travel = np.abs(step), _around(recording), float(np.ptp(recording.position))
    leaps = (size > _WRAP * around) & (size > 0.5 * travel)
    seen = leaps & (np.diff(recording.time) <= find_gap_length(recording))  # over a gap the joint itself has moved on
    wraps = np.flatnonzero(seen if seen.any() else leaps)
    if not wraps.size:
        return None
    passed = np.abs(np.median(_neighbours(step), axis=0))[wraps]  # the way of the joint itself within the step
    sizes = size[wraps] + passed
    period = float(np.median(sizes))
    tolerance = np.minimum(_SAME_RANGE * period, _measure_reach(recording, wraps)) + 3.0 * float(np.median(around))
    if np.any(np.abs(sizes - period) > tolerance) or travel > 1.1 * period:
        return None
    return Wrap(snap_period(period, measure_quantum(np.asarray(recording.position))), int(wraps.size))


def _measure_reach(recording: Recording, steps: NDArray[np.intp]) -> Samples:
    """How far the joint may have come in some steps [rad] or [m]: outliers differ by more from each other."""
    usual = np.delete(np.abs(np.diff(recording.position)), steps)
    top = float(np.quantile(usual[usual > 0.0], _FASTEST, method="lower")) if usual.any() else 0.0
    return _SPEED * top * np.maximum(np.diff(recording.time)[steps] / recording.sample_period, 1.0)


def unwrap_position(recording: Recording) -> tuple[Recording, Wrap | None]:
    """The recording with a position that does not wrap; as it was where it did not, or where that leaves jumps."""
    wrap = find_period(recording)
    if wrap is None or _alternates(recording, wrap.period):
        return recording, None
    position = np.unwrap(recording.position, period=wrap.period)
    left = np.abs(np.diff(position)) > 0.5 * wrap.period - 1e-9
    if left.any():
        return recording, None
    changed = {"position": position}
    if recording.position_reference is not None:  # counted in the same turns
        turns = np.round((position - recording.position_reference) / wrap.period)
        changed["position_reference"] = recording.position_reference + wrap.period * turns
    return recording.with_channels(**changed).with_metadata(continuous=True), wrap


def follow_motion(recording: Recording) -> Continuity:
    """Tell the rows that follow the motion from those that leave it and come back.

    The rows between two jumps belong to the motion where they go on from those before them.
    """
    same = _repeated_values(recording) | _find_lone_rows(np.asarray(recording.position))
    if same.any():
        rest = np.flatnonzero(~same)
        followed = follow_motion(recording.rows(rest))
        keep = np.zeros(len(recording), dtype=bool)
        keep[rest[followed.keep]] = True
        return Continuity(keep, rest[followed.cuts])
    n = len(recording)
    nothing = Continuity(np.ones(n, dtype=bool), np.zeros(0, dtype=np.intp))
    step = np.abs(np.diff(recording.position))
    periods = np.maximum(np.diff(recording.time) / recording.sample_period, 1.0)
    travel = float(np.ptp(np.quantile(recording.position, [_TAIL, 1.0 - _TAIL])))
    around = _around(recording)
    top = float(np.quantile(step[step > 0.0] / periods[step > 0.0], _FASTEST)) if step.any() else 0.0
    factor = np.where(step > _FAR * top * periods, _WRAP, _JUMP)  # no joint is slow, faster than ever, and slow again
    jumps = np.flatnonzero((step / periods > factor * around) & (step > _LEAST_JUMP * travel))
    if not jumps.size:
        return nothing
    keep = _chain(recording, _with_held_ends(np.asarray(recording.position), jumps), around)
    if n - np.count_nonzero(keep) > _MOST_STRAYS * n:
        return Continuity(nothing.keep, jumps + 1)
    rows = np.flatnonzero(keep)
    moved = np.abs(np.diff(recording.position[rows]))
    between = np.maximum(np.diff(recording.time[rows]) / recording.sample_period, 1.0)
    limit = np.maximum(_JUMP * around[rows[:-1]], _SPEED * _top(step, jumps, periods))
    cuts = np.flatnonzero((moved > limit * between) & (moved > _LEAST_JUMP * travel))
    return Continuity(keep, rows[cuts + 1])


def find_wild_torque(recording: Recording) -> WildTorque:
    """Rows in which a reading of torque failed, and those whose torque is far from others that hold together."""
    failed = _find_failed_readings(np.asarray(recording.torque))
    found = WildTorque(failed, np.zeros_like(failed) if failed.any() else _find_outliers(recording))
    if not found.rows.any():
        return found
    rest = np.flatnonzero(~found.rows)  # others may have stood beside them
    beside = find_wild_torque(recording.rows(rest))
    found.failed[rest], found.outliers[rest] = beside
    return found


def _find_outliers(recording: Recording) -> Rows:
    """Rows whose torque is far from those around it. Shape (n_samples,).

    A torque that jumps often, such as one that a loop commands against a coarse encoder, has no outliers. One that the
    joint answers was there.
    """
    torque = np.asarray(recording.torque)
    if torque.size < _FEWEST_TORQUES:
        return np.zeros(torque.size, dtype=bool)
    padded = np.pad(torque, _TORQUE_REACH, mode="edge")
    around = np.lib.stride_tricks.sliding_window_view(padded, 2 * _TORQUE_REACH + 1)
    middle = np.median(around, axis=1)
    off = np.abs(torque - middle)
    spread = np.median(np.abs(around - middle[:, None]), axis=1)  # of the stretch itself: a jolt is no outlier
    usual = float(np.quantile(off, _USUAL_TORQUES))
    least = max(usual, measure_quantum(torque))
    wild = np.asarray((off > _WILD * np.maximum(spread, least)) & (off > _LEAST_WILD * float(np.ptp(middle))))
    if not wild.any() or np.mean(wild) > _MOST_WILD:
        return np.zeros(torque.size, dtype=bool)
    return wild & ~find_answered_kicks(torque, wild, np.asarray(recording.position), recording.sample_period)


def _find_failed_readings(torque: Samples) -> Rows:
    """Rows in which a reading failed and 0 was logged: a few at a time, to and from which the torque leaps.

    A torque that passes zero, or rests there, does so in small steps. Shape (n_samples,).
    """
    zero = np.asarray(torque == 0.0)
    nothing = np.zeros(torque.size, dtype=bool)
    if not _FEWEST_REPEATS <= np.count_nonzero(zero) <= _MOST_FAILED * torque.size:
        return nothing
    edges = np.flatnonzero(np.diff(zero, prepend=False, append=False))
    runs = [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if b - a <= _LONGEST_FAILURE]
    usual = max(float(np.quantile(np.abs(np.diff(torque[~zero])), _USUAL_TORQUES)), measure_quantum(torque))
    sizes = np.pad(np.abs(torque), 1, constant_values=np.inf)
    leaps = [min(sizes[a], sizes[b + 1]) > _LEAP * usual for a, b in runs]
    if np.sum(leaps) < max(_FEWEST_REPEATS, _ALIKE * len(runs)):
        return nothing
    for a, b in runs:
        nothing[a:b] = True
    return nothing


def _chain(recording: Recording, jumps: NDArray[np.intp], around: Samples) -> Rows:
    """Rows of the stretches between jumps that go on from one another, from the longest stretch outwards."""
    position, time, period = recording.position, recording.time, recording.sample_period
    step = np.abs(np.diff(position))
    top = _top(step, jumps, np.maximum(np.diff(time) / period, 1.0))
    starts, stops = np.concatenate([[0], jumps + 1]), np.concatenate([jumps + 1, [len(recording)]])
    middle = int(np.argmax(stops - starts))
    keep = np.zeros(len(recording), dtype=bool)
    keep[starts[middle] : stops[middle]] = True

    def reaches(row: int, other: int) -> bool:
        between = max(abs(float(time[row] - time[other])) / period, 1.0)
        allowed = max(_SPEED * top, float(around[min(row, around.size - 1)])) * between
        return bool(abs(position[row] - position[other]) <= allowed)

    last = int(stops[middle]) - 1
    for a, b in zip(starts[middle + 1 :], stops[middle + 1 :], strict=True):
        if reaches(int(a), last):
            keep[a:b], last = True, int(b) - 1
    first = int(starts[middle])
    for a, b in zip(starts[:middle][::-1], stops[:middle][::-1], strict=True):
        if reaches(int(b) - 1, first):
            keep[a:b], first = True, int(a)
    return keep


def _with_held_ends(position: Samples, jumps: NDArray[np.intp]) -> NDArray[np.intp]:
    """The jumps, and the other ends of stretches of one value that a jump begins or ends.

    A stretch of zeros may begin where the joint passes zero, without a jump.
    """
    changes = np.flatnonzero(np.diff(position) != 0.0)
    before = np.concatenate([[-1], changes[:-1]])
    long = changes - before >= _HELD
    ends = {(int(a), int(b)) for a, b in zip(before[long], changes[long], strict=True)}
    at = set(jumps.tolist())
    more = {end for pair in ends if at & set(pair) for end in pair if end >= 0}
    return np.array(sorted(at | more), dtype=np.intp)


def _top(step: Samples, jumps: NDArray[np.intp], periods: Samples) -> float:
    """Largest way in a period that is no jump [rad] or [m]."""
    usual = np.ones(step.size, dtype=bool)
    usual[jumps] = False
    return float(np.max((step / periods)[usual], initial=0.0))


def _repeated_values(recording: Recording) -> Rows:
    """Rows that all hold the same position, or position and torque, and interrupt the motion: a second publisher's.

    They are strays also where the joint happens to pass there. A long rest repeats its values more often than they do,
    so that the most frequent ones are looked at in turn. Shape (n_samples,).
    """
    position = np.asarray(recording.position)
    for table in (position + 1j * np.asarray(recording.torque), position):
        values, counts = np.unique(table, return_counts=True)
        for most in np.argsort(counts)[::-1][:_CANDIDATES]:
            same = np.asarray(table == values[most])
            enough = _FEWEST_REPEATS <= counts[most] < _MOST_REPEATS * len(recording)
            if enough and _interrupts(recording, same):
                return same
    return np.zeros(len(recording), dtype=bool)


def _find_lone_rows(position: Samples) -> Rows:
    """Single rows to which the position leaps and from which it comes straight back: no joint turns round so fast.

    Where rows are far apart, such a leap is no more than a dozen of the motion's own steps. Shape (n_samples,).
    """
    lone = np.zeros(position.size, dtype=bool)
    step = np.diff(position)
    if step.size < _HELD or not step.any():
        return lone
    size = np.abs(step)
    beside = np.sort(_neighbours(size), axis=0)[-3]  # another lone row may stand there, with two leaps
    limit = _SPEED * np.maximum(beside, float(np.quantile(size[size > 0.0], _FASTEST)))
    leaps = size > limit
    lone[1:-1] = leaps[:-1] & leaps[1:] & (step[:-1] * step[1:] < 0.0)
    return lone


def _interrupts(recording: Recording, same: Rows) -> bool:
    """Whether rows of one value come in short stretches, to which and from which the position leaps."""
    other = np.abs(np.diff(recording.position[~same]))
    usual = float(np.quantile(other[other > 0.0], 0.9)) if other.any() else np.inf
    before, after = np.flatnonzero(same[1:] & ~same[:-1]), np.flatnonzero(same[:-1] & ~same[1:])
    moved = np.abs(np.diff(recording.position))
    leaps = np.concatenate([moved[before], moved[after]])
    short = same.sum() < _SHORT_RUN * max(before.size, 1)
    return bool(short and leaps.size and np.mean(leaps > _LEAP * usual) > _ALIKE)


def _alternates(recording: Recording, period: float) -> bool:
    """Whether the position mostly comes straight back after a step of a period, as rows of another publisher do."""
    step = np.diff(recording.position)
    wraps = np.flatnonzero(np.abs(step) > 0.5 * period)
    back = np.sum((np.diff(wraps) <= 3) & (step[wraps[:-1]] * step[wraps[1:]] < 0.0))
    return bool(back >= 0.4 * wraps.size)  # each stray makes two such steps


def _around(recording: Recording) -> Samples:
    """Usual step next to each step: the third smallest of eight, and no less than a step of the slower half.

    A motion is as fast beside a step as in it; strays close together leave three steps of the motion among eight.
    """
    size = np.abs(np.diff(recording.position))
    floor = float(np.percentile(size[size > 0.0], 60)) if size.any() else 0.0
    return np.asarray(np.maximum(np.sort(_neighbours(size), axis=0)[2], floor), dtype=np.float64)


def _neighbours(size: Samples) -> Samples:
    """The four steps before and the four after each step. Shape (8, n)."""
    padded = np.pad(size, 4, mode="edge")
    return np.stack([padded[k : k + size.size] for k in (0, 1, 2, 3, 5, 6, 7, 8)])

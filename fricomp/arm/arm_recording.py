"""A recording of an arm: all joints on one clock, in parts between gaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata
from fricomp.recording.parts.holds import thin_held_rows

from .log.instants import place_rows
from .record import JointFrame

_GAP_SAMPLES, _GAP_TIME = 5.0, 0.05
"""A pause of more samples than this, and longer than this [s], ends a part: a spline across it would be a guess."""

_SHORTEST = 2.0
"""[s] of a part: below, the filters see more of its ends than of the motion."""

_GOES_BACK = 0.1
"""Of the longer way of a joint, that the way back is at least: less is an overshoot at the end of a stroke."""


@dataclass(frozen=True)
class ArmPart:
    """A stretch without gaps, at equal steps.

    Attributes:
        time: [s]. Shape (n,).
        position: [rad] or [m]. Shape (n, n_joints).
        torque: [N·m] or [N]. Shape (n, n_joints).
        warmth: Temperature over that of the joint's start [K]; 0 where none was recorded. Shape (n, n_joints).
    """

    time: FloatArray
    position: FloatArray
    torque: FloatArray
    warmth: FloatArray

    @property
    def period(self) -> float:
        """Time between samples [s]."""
        return float(self.time[1] - self.time[0])


@dataclass(frozen=True)
class ArmRecording:
    """All joints of an arm.

    Attributes:
        joints: Names, in the order of the columns.
        parts: Stretches without gaps.
        left_out: Share of the time that lies in no part.
        recordings: What each joint was read from, in the same order.
        still: Joints that were recorded and stood still.
        strangers: Joints that were recorded and moved, and that the simulation does not have.
        held: Joints whose rows mostly repeat the one before, at which those rows were left out.
        frames_instead: Frames of joints that would explain as much as the mounting that was taken instead.
        turned: Joints whose torques were recorded the other way round; here they are turned.
        degrees: Whether positions were degrees that had been taken for rad; here they are rad.
        guided: Times [s] in which something else than the drives moved or held the arm, which are in no part.
        unwrapped: Joints whose positions wrapped round at a turn; here they go on.
        placed: Whether positions and velocities said when rows were sampled, since stamps did not.
    """

    joints: tuple[str, ...]
    parts: tuple[ArmPart, ...]
    left_out: float
    recordings: tuple[Recording, ...]
    still: tuple[str, ...] = ()
    strangers: tuple[str, ...] = ()
    held: tuple[str, ...] = ()
    frames_instead: tuple[JointFrame, ...] = ()
    turned: tuple[str, ...] = ()
    degrees: bool = False
    guided: tuple[tuple[float, float], ...] = ()
    unwrapped: tuple[str, ...] = ()
    placed: bool = False

    @property
    def metadata(self) -> tuple[RecordingMetadata, ...]:
        """Of each joint."""
        return tuple(one.metadata for one in self.recordings)

    @property
    def one_way(self) -> tuple[str, ...]:
        """Joints that hardly go back: their friction is not told from a constant torque, nor from gravity."""
        found = []
        for j, name in enumerate(self.joints):
            rises, falls = zip(*(_measure_ways(part.position[:, j]) for part in self.parts), strict=True)
            if min(max(rises), max(falls)) < _GOES_BACK * max(*rises, *falls):
                found.append(name)
        return tuple(found)

    @property
    def guided_from_start(self) -> tuple[tuple[float, float], ...]:
        """The same as `guided`, from the first row of the recordings [s]."""
        start = min(float(one.time[0]) for one in self.recordings)
        return tuple((max(first - start, 0.0), last - start) for first, last in self.guided)

    @property
    def duration(self) -> float:
        """Time in all parts [s]."""
        return float(sum(part.time[-1] - part.time[0] for part in self.parts))

    @property
    def period(self) -> float:
        """Time between samples [s]."""
        return self.parts[0].period


def join_joints(recordings: Sequence[Recording]) -> ArmRecording:
    """Bring the recordings of all joints of an arm onto one clock.

    Args:
        recordings: One of each joint, from the same time, with torques of the joints [N·m] or [N].

    Raises:
        RecordingError: A joint comes twice, the recordings share no time, or no stretch of them is long enough.
    """
    placed = place_rows(recordings)
    thinned = [thin_held_rows(one) for one in placed]
    series = [one for one, _ in thinned]
    names = [one.metadata.joint for one in series]
    require_single(names)
    period = float(np.median([one.sample_period for one in series]))
    first, last = max(one.time[0] for one in series), min(one.time[-1] for one in series)
    if last - first < _SHORTEST:
        raise RecordingError(
            f"the recordings of {', '.join(names)} share {max(last - first, 0.0):.3g} s: too little for what links "
            "weigh and for friction in both directions; record half a minute with all joints moving to and fro"
        )
    edges = _find_edges(series, first, last, max(_GAP_SAMPLES * period, _GAP_TIME))
    parts = tuple(_sample(series, *edge, period) for edge in edges if edge[1] - edge[0] >= _SHORTEST)
    if not parts:
        raise RecordingError(f"no stretch without a gap is as long as {_SHORTEST:g} s: record at an even rate")
    kept = sum(part.time[-1] - part.time[0] for part in parts)
    left_out = max(0.0, 1.0 - float(kept) / float(last - first))
    held = tuple(name for name, (_, hold) in zip(names, thinned, strict=True) if hold is not None)
    return ArmRecording(tuple(names), parts, left_out, tuple(series), held=held, placed=placed is not recordings)


def _measure_ways(position: FloatArray) -> tuple[float, float]:
    """The longest way up, and down [rad] or [m]: from the lowest place so far, and from the highest."""
    up = position - np.minimum.accumulate(position)
    down = np.maximum.accumulate(position) - position
    return float(np.max(up)), float(np.max(down))


def require_single(names: Sequence[str]) -> None:
    """Refuse a joint that was recorded twice.

    Raises:
        RecordingError: One was.
    """
    twice = sorted({name for name in names if list(names).count(name) > 1})
    if twice:
        raise RecordingError(f"joint {twice[0]!r} comes twice: an arm is made of one recording of each joint")


def _find_edges(series: Sequence[Recording], first: float, last: float, gap: float) -> list[tuple[float, float]]:
    """Stretches of time in which no joint has a gap [s]."""
    breaks: list[tuple[float, float]] = []
    for one in series:
        time = np.asarray(one.time)
        at = np.flatnonzero(np.diff(time) > gap)
        breaks += [(float(time[i]), float(time[i + 1])) for i in at]
    edges, start = [], first
    for begin, end in sorted(breaks):
        if begin > start:
            edges.append((start, min(begin, last)))
        start = max(start, end)
    return [*edges, (start, last)] if start < last else edges


def _sample(series: Sequence[Recording], first: float, last: float, period: float) -> ArmPart:
    grid = np.arange(first, last, period)
    columns = {
        name: np.stack([np.interp(grid, one.time, getattr(one, name)) for one in series], axis=1)
        for name in ("position", "torque")
    }
    warmth = np.stack([_measure_warmth(one, grid) for one in series], axis=1)
    return ArmPart(grid, columns["position"], columns["torque"], warmth)


def find_start_temperature(recording: Recording) -> float:
    """Temperature at which a joint starts: the mean of its first second [°C]; 0 where none was recorded."""
    if recording.temperature is None:
        return 0.0
    first = np.asarray(recording.time) <= recording.time[0] + 1.0
    return float(np.mean(np.asarray(recording.temperature)[first]))


def _measure_warmth(recording: Recording, grid: FloatArray) -> FloatArray:
    if recording.temperature is None:
        return np.zeros_like(grid)
    return np.interp(grid, recording.time, recording.temperature) - find_start_temperature(recording)

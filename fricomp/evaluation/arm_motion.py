"""Recordings of all joints of an arm on one grid."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .equation import align_torque
from .motion import MotionPart, RecordedMotion, Rows, read_motion
from .settings import EVALUATION

_GAP = 5.0  # periods; a longer step of time in one joint is a gap of all


@dataclass(frozen=True)
class ArmMotion:
    """All joints between common gaps, in one band.

    Attributes:
        names: Of the joints, in the recordings.
        joints: The motion of each.
    """

    names: tuple[str, ...]
    joints: tuple[RecordedMotion, ...]

    @property
    def n_parts(self) -> int:
        """Number of parts between gaps."""
        return len(self.joints[0].parts)

    @property
    def dt(self) -> float:
        """Time between samples [s]."""
        return self.joints[0].dt

    @property
    def times(self) -> list[FloatArray]:
        """Times of the samples of each part [s]."""
        return [part.time for part in self.joints[0].parts]

    def moves(self, part: int) -> Rows:
        """Whether any joint moves. Shape (n,)."""
        return np.asarray(np.any([one.parts[part].moves for one in self.joints], axis=0))

    def stack(self, part: int, name: str) -> FloatArray:
        """A signal of all joints. Shape (n, n_joints)."""
        return np.stack([getattr(one.parts[part], name) for one in self.joints], axis=1)


def read_arm_motion(
    recordings: Sequence[Recording], *, band: float | None, torque_delay: float | Mapping[str, float]
) -> ArmMotion:
    """Bring the recordings of all joints onto the slowest one's grid, and into the narrowest band.

    Args:
        recordings: One of each joint, their torques on the side of the joint.
        band: Upper end of the band [Hz]; chosen if None.
        torque_delay: Time by which all recorded torques are late, or that of each joint by its name; they are moved to
            where they acted [s].

    Raises:
        RecordingError: A joint comes twice, a torque is neither in N·m nor in N, or they share too little time.
    """
    names = tuple(one.metadata.joint for one in recordings)
    if len(set(names)) < len(names) or not names:
        raise RecordingError(f"an arm is made of one recording of each joint, got {', '.join(names) or 'none'}")
    for one in recordings:
        if one.metadata.torque_unit not in ("N·m", "N"):
            raise RecordingError(
                f"the torque of {one.metadata.joint!r} is in {one.metadata.torque_unit}, and an arm's simulation needs "
                "N·m: state the torque constant and the gear ratio (fricomp convert)"
            )
    even = _share_grid(recordings)
    band = band or min(read_motion(one).band for one in even)
    motions = [read_motion(one, band=band) for one in even]
    own = torque_delay if isinstance(torque_delay, Mapping) else dict.fromkeys(names, torque_delay)
    delays = [own.get(name, 0.0) for name in names]
    motions = [
        replace(one, parts=tuple(_align(part, delay) for part in one.parts)) if delay else one
        for one, delay in zip(motions, delays, strict=True)
    ]
    return ArmMotion(names, tuple(motions))


def _align(part: MotionPart, delay: float) -> MotionPart:
    return replace(part, torque=align_torque(part, delay))


def _share_grid(recordings: Sequence[Recording]) -> list[Recording]:
    """The recordings at common times, without what lies in a gap of any."""
    first = recordings[0]
    if all(len(one) == len(first) and np.array_equal(one.time, first.time) for one in recordings):
        return list(recordings)
    period = max(one.sample_period for one in recordings)
    begin, end = max(one.time[0] for one in recordings), min(one.time[-1] for one in recordings)
    if end - begin < EVALUATION.shortest_part:
        raise RecordingError("the recordings of the joints share no second of time: give recordings of one motion")
    grid = np.arange(begin, end, period)
    kept = np.ones(grid.size, dtype=bool)
    for one in recordings:
        time = np.asarray(one.time)
        for row in np.flatnonzero(np.diff(time) > _GAP * period):
            kept &= (grid <= time[row]) | (grid >= time[row + 1])
    return [_sample(one, grid[kept]) for one in recordings]


def _sample(recording: Recording, grid: FloatArray) -> Recording:
    channels = {
        name: grid if name == "time" else np.interp(grid, recording.time, values)
        for name, values in recording.channels.items()
    }
    return Recording.from_channels(channels, recording.metadata)

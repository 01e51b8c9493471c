"""A rigid joint with friction fitted to a recording, by means over blocks of samples."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples
from fricomp.root_mean_square import compute_rms

_BLOCK = 0.02
"""Samples are averaged over so long, or over three of them [s]: encoder steps of an acceleration are then small."""
_SLOW = 0.1
"""Part of the top speed below which the direction of friction is not sure."""
_SURE = 3.0
"""Standard deviations beyond which a negative inertia is one."""
_ALIKE = 5.0
"""Blocks that err alike: their variance counts so often."""
_APART = 0.1
"""Part of a column that no other one holds, below which its parameter is not determined."""


@dataclass(frozen=True)
class JointFit:
    """torque = inertia a + viscous v + coulomb sgn(v) + offset + gravity, by least squares.

    Attributes:
        inertia: [kg·m²] or [kg].
        viscous: [N·m·s/rad] or [N·s/m].
        coulomb: [N·m] or [N].
        deviations: Of these three.
        residual: Root mean square of what is left [N·m] or [N].
        explained: Part of the torque's variance that is explained.
        friction: Mean torque of friction at the speeds that occur [N·m] or [N].
    """

    inertia: float
    viscous: float
    coulomb: float
    deviations: tuple[float, float, float]
    residual: float
    explained: float
    friction: float

    @property
    def can_be(self) -> bool:
        """Whether a joint could have this inertia and this friction."""
        return self.friction > 0.0 and self.inertia > -_SURE * self.deviations[0]


class BlockMotion(NamedTuple):
    """Block means of a motion; rows are those that slide and have both neighbours."""

    time: Samples
    position: Samples
    velocity: Samples
    acceleration: Samples
    rows: NDArray[np.bool_]
    width: int

    def average_all(self, values: Samples) -> Samples:
        """Means of samples over all blocks. Shape (n_blocks,)."""
        return np.asarray(values[: self.time.size * self.width].reshape(-1, self.width).mean(axis=1))

    def average(self, values: Samples) -> Samples:
        """Means of samples over the blocks that slide. Shape (n_rows,)."""
        return self.average_all(values)[self.rows]


def fit_joint(recording: Recording, torque: Samples | None = None, delay: float = 0.0) -> JointFit | None:
    """Fit a rigid joint with friction; None where the motion is too short, or goes one way only.

    Args:
        recording: Of one joint.
        torque: In place of the recorded one [as torque].
        delay: How long after its stamp the torque acts [s].
    """
    motion = average_motion(recording)
    return (
        None
        if motion is None
        else fit_motion(motion, recording, np.asarray(recording.torque if torque is None else torque), delay)
    )


def fit_motion(motion: BlockMotion, recording: Recording, torque: Samples, delay: float) -> JointFit | None:
    """The same as `fit_joint`, of a motion that was averaged before."""
    if delay != 0.0:
        torque = np.interp(np.asarray(recording.time) - delay, recording.time, torque)
    target = motion.average(torque)
    v, design = motion.velocity[motion.rows], build_design(motion, rotary=recording.metadata.motion == "rotary")
    scale = np.maximum(np.abs(design).max(axis=0), 1e-300)
    q_part, r_part = np.linalg.qr(design / scale)
    if np.abs(np.diag(r_part)).min() < 1e-9 * np.abs(np.diag(r_part)).max():
        inverse = np.linalg.pinv(r_part)
    else:
        inverse = np.linalg.inv(r_part)
    solution = inverse @ (q_part.T @ target)
    left = target - design / scale @ solution
    residual = compute_rms(left)
    size = np.sqrt(np.sum(inverse**2, axis=1))
    spread = residual * np.sqrt(_ALIKE) * size
    alone = 1.0 / np.maximum(size, 1e-300) / np.maximum(np.linalg.norm(design / scale, axis=0), 1e-300)
    spread[alone < _APART] = np.inf  # another column can take its place, such as gravity that of inertia in one swing
    inertia, viscous, coulomb = (solution / scale)[:3].tolist()
    variance = float(np.var(target))
    mean = coulomb + viscous * float(np.mean(np.abs(v)))
    return JointFit(
        inertia, viscous, coulomb, tuple((spread / scale)[:3].tolist()), residual,
        1.0 - residual**2 / variance if variance > 0.0 else 0.0, mean,
    )  # fmt: skip


def average_motion(recording: Recording) -> BlockMotion | None:
    """Average a recorded motion over blocks; None where it is too short, or goes one way only."""
    width = max(3, round(_BLOCK / recording.sample_period))
    count = len(recording) // width * width
    if count < 60 * width:
        return None
    time, position = (
        np.asarray(values)[:count].reshape(-1, width).mean(axis=1) for values in (recording.time, recording.position)
    )
    velocity = np.gradient(position, time)
    acceleration = np.gradient(velocity, time)
    top = float(np.percentile(np.abs(velocity), 98))
    direction = np.sign(velocity) * (np.abs(velocity) > _SLOW * top)
    rows = direction != 0.0
    for shift in (1, 2):
        rows[shift:] &= direction[shift:] == direction[:-shift]
        rows[:-shift] &= direction[:-shift] == direction[shift:]
    gaps = np.concatenate([[0.0], np.diff(time)]) > 3.0 * float(np.median(np.diff(time)))
    for shift in (-2, -1, 0, 1, 2):
        rows &= ~np.roll(gaps, shift)
    rows[:2] = rows[-2:] = False
    if min(np.sum(velocity[rows] > 0.0), np.sum(velocity[rows] < 0.0)) < 10:
        return None
    return BlockMotion(time, position, velocity, acceleration, rows, width)


def build_design(motion: BlockMotion, *, rotary: bool) -> Samples:
    """Build what inertia, viscous and Coulomb friction, offset and gravity each add to a torque. Shape (n_rows, 5 or
    6)."""
    v, a, q = (each[motion.rows] for each in (motion.velocity, motion.acceleration, motion.position))
    held = [np.sin(q), np.cos(q)] if rotary else [q]
    return np.column_stack([a, v, np.sign(v), np.ones(v.size), *held])

"""Gravity that a recording asks for, where the arm is mounted otherwise than in its simulation, or where a controller
had taken gravity off the torques.

    τ = D + G g + r a + F_c sign v + F_v v + b

of each joint, D being what the simulation asks for without gravity, and G its change with gravity, which all joints
share. Links would be fitted to torques that are none of theirs, and come out far off.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from ..arm_recording import ArmRecording
from ..columns import plain_columns
from ..record import JointFrame
from ..rigid.simulated_arm import SimulatedArm
from .frames import (
    LEAST_ROWS,
    POOR,
    build_slow_rows,
    explains_better,
    find_better_frames,
    find_turned_torques,
    measure_frames,
)

_TURN = 0.1
"""[rad] from which on gravity has another direction. A base that is less off its level is found with the links."""

_LENGTHS = (0.6, 1.6)
"""Length of the gravity that is found, in that of the file: links may be heavier all together."""

_NONE = 0.2
"""The same, below which there is none."""

_ALIKE = float(np.log(2.0))
"""Difference in the logarithms of what two explanations leave, over all joints, up to which they do as well."""

_ROUNDS = 6
"""In which joints are weighed by what is left of them."""


class Mounting(NamedTuple):
    """How an arm is mounted.

    Attributes:
        gravity: In the axes of the simulation [m/s²], as long as that of the file; zero where it was taken off the
            torques. Shape (3,).
        frames: Frames of joints that would do as well: where a joint lies level, its zero turns as gravity does.
    """

    gravity: FloatArray
    frames: tuple[JointFrame, ...]


def find_mounting(arm: SimulatedArm, recording: ArmRecording) -> Mounting | None:
    """Gravity that explains a recording much better than that of the file.

    None where none does, or where other frames of joints do better, or torques the other way round: friction and
    inertia tell all of these from gravity that pulls up.

    Args:
        arm: The simulation.
        recording: Of its joints.
    """
    found = _find_gravity(arm, recording)
    if found is None:
        return None
    left = measure_frames(arm.with_gravity(found), recording)
    if measure_frames(arm, _turn(recording, find_turned_torques(arm, recording))) < left:
        return None
    frames = find_better_frames(arm, recording)
    beyond = measure_frames(arm, recording, frames) - left
    if beyond < -_ALIKE:
        return None
    return Mounting(found, frames if beyond < _ALIKE else ())


def _find_gravity(arm: SimulatedArm, recording: ArmRecording) -> FloatArray | None:
    given = arm.gravity
    size = float(np.linalg.norm(given))
    if not size:
        return None
    pulls, torques, spread = _separate(arm, recording)
    if not len(torques):
        return None
    as_given = _measure_left(pulls, torques, given)
    if not np.any(as_given > POOR * spread):
        return None
    free = _fit(pulls, torques, given)
    length = float(np.linalg.norm(free))
    if length < _NONE * size:
        return np.zeros(3) if _falls(_measure_left(pulls, torques, np.zeros(3)), as_given) else None
    scale = max(float(_fit(pulls @ given[:, None], torques, np.ones(1))[0]), 0.0)
    turn = float(np.arccos(np.clip(free @ given / (length * size), -1.0, 1.0)))
    known = _LENGTHS[0] * size < length < _LENGTHS[1] * size and turn > _TURN
    fallen = _falls(_measure_left(pulls, torques, free), _measure_left(pulls, torques, scale * given))
    return np.asarray(free * size / length) if known and fallen else None


def _turn(recording: ArmRecording, joints: Collection[str]) -> ArmRecording:
    """The recording with the torques of some joints the other way round."""
    ways = np.array([-1.0 if name in joints else 1.0 for name in recording.joints])
    return replace(recording, parts=tuple(replace(part, torque=ways * part.torque) for part in recording.parts))


def _separate(arm: SimulatedArm, recording: ArmRecording) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Pull of gravity on each joint and torques without that of the motion, less what friction and rotor may be.

    Returns:
        Shapes (n_joints, n, 3) and (n_joints, n), and how much each torque varies, shape (n_joints,).
    """
    rows, *pulled = (build_slow_rows(arm.with_gravity(g), recording) for g in (np.zeros(3), *np.eye(3)))
    if len(rows) < LEAST_ROWS:
        return np.empty((0, 0, 3)), np.empty((0, 0)), np.empty(0)
    still = rows.links @ arm.inertia.ravel()
    pulls = np.stack([one.links @ arm.inertia.ravel() - still for one in pulled], axis=2)
    acceleration = rows.compare(lambda _, __, a: a)
    columns, torques = [], []
    for j in range(len(arm.joints)):
        sign, one, velocity, _ = plain_columns(rows, j).T
        base, _ = np.linalg.qr(np.stack([acceleration[:, j], sign, one, velocity], axis=1))
        each = np.column_stack([pulls[:, j], rows.torque[:, j] - still[:, j]])
        each = each - base @ (base.T @ each)
        columns.append(each[:, :3])
        torques.append(each[:, 3])
    return np.stack(columns), np.stack(torques), np.std(rows.torque, axis=0)


def _fit(pulls: FloatArray, torques: FloatArray, start: FloatArray) -> FloatArray:
    """Factors on pulls, joints weighed by what is left of them. Shape (n_columns,)."""
    found = start
    for _ in range(_ROUNDS):
        weights = _measure_left(pulls, torques, found) ** -2.0
        square = np.einsum("j,jni,jnk->ik", weights, pulls, pulls)
        found = np.asarray(np.linalg.pinv(square) @ np.einsum("j,jni,jn->i", weights, pulls, torques))
    return found


def _measure_left(pulls: FloatArray, torques: FloatArray, factors: FloatArray) -> FloatArray:
    """RMS of what factors on pulls leave of each joint [N·m] or [N]. Shape (n_joints,)."""
    return np.asarray(np.maximum(np.sqrt(np.mean((torques - pulls @ factors) ** 2, axis=1)), 1e-300))


def _falls(left: FloatArray, before: FloatArray) -> bool:
    """Whether so little is left, over all joints, that links that are off could not be why."""
    return explains_better(float(np.sum(np.log(left))), float(np.sum(np.log(before))))

"""The motion of the bodies of a MuJoCo model along a recorded motion, all samples at once.

From the base outwards, with joint axis z and anchor c of each joint,

    ω' = ω + z q̇,  α' = α + z q̈ + ω × z q̇           a hinge; points about c move on
    a' = a + 2 ω × z q̇ + z q̈                         a slide

in the axes of the world, accelerations less that of gravity.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from fricomp.laws import FloatArray


class JointMotion(NamedTuple):
    """Motion of one joint of a model [rad] or [m]. Shapes (n,)."""

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True)
class _Column:
    """How a joint moves what comes after it: its number, its axis, and its anchor where it turns."""

    joint: int
    axis: FloatArray
    anchor: FloatArray | None


@dataclass(frozen=True)
class BodyMotion:
    """Where a body is and how it moves, in the axes of the world. Shapes (n, 3), or (n, 3, 3).

    Attributes:
        place: Of its origin [m].
        turn: Its axes as columns.
        angular_velocity: [rad/s]
        angular_acceleration: [rad/s²]
        velocity: Of its origin [m/s].
        acceleration: Of its origin, less that of gravity [m/s²].
    """

    place: FloatArray
    turn: FloatArray
    angular_velocity: FloatArray
    angular_acceleration: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    _columns: tuple[_Column, ...] = ()

    def in_own_axes(self, vector: FloatArray) -> FloatArray:
        """A vector of the world in the axes of the body. Shape (n, 3)."""
        return np.asarray(np.einsum("nji,nj->ni", self.turn, vector))

    def build_jacobian(self, joint: int) -> tuple[FloatArray, FloatArray]:
        """Velocity of the origin and angular velocity by that of a joint, in the body's axes. Shapes (n, 3)."""
        none = np.zeros_like(self.place)
        column = next((one for one in self._columns if one.joint == joint), None)
        if column is None:
            return none, none
        if column.anchor is None:
            return self.in_own_axes(column.axis), none
        return (
            self.in_own_axes(_cross(column.axis, self.place - column.anchor)),
            self.in_own_axes(column.axis),
        )

    def carry(self, arm: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Velocity and acceleration of a point that the body carries, an arm away from its origin [m]."""
        w = self.angular_velocity
        spin = _cross(w, arm)
        return self.velocity + spin, self.acceleration + _cross(self.angular_acceleration, arm) + _cross(w, spin)


def move_bodies(
    model: Any, pose: FloatArray, joints: dict[int, JointMotion], bodies: Sequence[int], n: int
) -> dict[int, BodyMotion]:
    """Move bodies of a model.

    Args:
        model: MuJoCo's; all joints from its base to these bodies turn or slide.
        pose: Positions of all joints: those that do not move stay there. Shape (nq,).
        joints: Motion of those that move, by number.
        bodies: Numbers of the bodies that are wanted.
        n: Number of samples.

    Returns:
        The motion of each body.
    """
    zero = np.zeros((n, 3))
    still = np.tile(-np.asarray(model.opt.gravity, dtype=np.float64), (n, 1))
    moved = {0: BodyMotion(zero, np.tile(np.eye(3), (n, 1, 1)), zero, zero, zero, still)}

    def move(body: int) -> BodyMotion:
        if body not in moved:
            moved[body] = _move_body(model, pose, joints, body, move(int(model.body_parentid[body])))
        return moved[body]

    return {body: move(body) for body in bodies}


def _move_body(
    model: Any, pose: FloatArray, joints: dict[int, JointMotion], body: int, parent: BodyMotion
) -> BodyMotion:
    import mujoco

    first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
    motion = _shift(parent, parent.turn @ model.body_pos[body])
    motion = replace(motion, turn=motion.turn @ _rotate_quaternion(model.body_quat[body]))
    for number in range(first, first + count):
        at, kind = int(model.jnt_qposadr[number]), int(model.jnt_type[number])
        hold = np.full(len(motion.place), pose[at])
        moving = joints.get(number, JointMotion(hold, 0.0 * hold, 0.0 * hold))
        away = moving.position - float(model.qpos0[at])
        if kind == int(mujoco.mjtJoint.mjJNT_SLIDE):
            motion = _slide(motion, number, model.jnt_axis[number], away, moving)
        else:
            motion = _hinge(motion, number, model.jnt_axis[number], model.jnt_pos[number], away, moving)
    return motion


def _shift(motion: BodyMotion, arm: FloatArray) -> BodyMotion:
    """The same body with its origin an arm away [m], in the axes of the world."""
    velocity, acceleration = motion.carry(arm)
    return replace(motion, place=motion.place + arm, velocity=velocity, acceleration=acceleration)


def _hinge(
    motion: BodyMotion, number: int, axis: FloatArray, anchor: FloatArray, angle: FloatArray, moving: JointMotion
) -> BodyMotion:
    there = _shift(motion, motion.turn @ anchor)
    z = there.turn @ axis
    spin = z * moving.velocity[:, None]
    there = replace(
        there,
        turn=there.turn @ _rotate_about(axis, angle),
        angular_velocity=there.angular_velocity + spin,
        angular_acceleration=there.angular_acceleration
        + z * moving.acceleration[:, None]
        + _cross(there.angular_velocity, spin),
        _columns=(*there._columns, _Column(number, z, there.place)),
    )
    return _shift(there, -(there.turn @ anchor))


def _slide(motion: BodyMotion, number: int, axis: FloatArray, way: FloatArray, moving: JointMotion) -> BodyMotion:
    z = motion.turn @ axis
    there = _shift(motion, z * way[:, None])
    speed = z * moving.velocity[:, None]
    return replace(
        there,
        velocity=there.velocity + speed,
        acceleration=there.acceleration
        + 2.0 * _cross(there.angular_velocity, speed)
        + z * moving.acceleration[:, None],
        _columns=(*there._columns, _Column(number, z, None)),
    )


def _rotate_about(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Turns about an axis by these angles [rad]. Shape (n, 3, 3)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    s, c = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.asarray(np.eye(3) + s * cross + (1.0 - c) * (cross @ cross))


def _rotate_quaternion(quaternion: FloatArray) -> FloatArray:
    """The turn of a quaternion, its real part first. Shape (3, 3)."""
    w, x, y, z = quaternion / np.linalg.norm(quaternion)
    return np.array(
        [
            [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
            [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
            [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
        ]
    )


def _cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """a x b, row by row: a third of the time of numpy's, which is for any shapes. Shapes (n, 3)."""
    x, y, z = a.T
    u, v, w = b.T
    return np.stack([y * w - z * v, z * u - x * w, x * v - y * u], axis=-1)

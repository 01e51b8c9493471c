"""Joint torques of an arm are linear in what its links weigh.

    f = m a + α × h + ω × (ω × h),  n = I α + ω × I ω + h × a,  τ = Σ_links (Jᵥᵀ f + J_ωᵀ n)

in the frame of each link, a being the acceleration of its origin less that of gravity [hollerbach2016].
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from fricomp.laws import FloatArray

from .inertia import N_INERTIA
from .simulated_arm import LinkMotion, SimulatedArm

_STEP = 1e-4
"""[rad] or [m] to each side for a derivative: its error is the square of that, and rounding's part 1e-12."""

N_GRAVITY = 4
"""Inertial numbers of a link that gravity acts on: its mass and first moments, which come first."""


class Regressors(NamedTuple):
    """Torque of every joint for one unit of what a link weighs.

    Attributes:
        links: Of each inertial number of each link. Shape (n, n_joints, 10 n_links).
        lean: Its change as gravity leans over by a radian, for each of `SimulatedArm.level_axes`, of the numbers that
            gravity acts on. Shape (n, n_joints, 2, 4 n_links).
    """

    links: FloatArray
    lean: FloatArray


def compute_regressor(
    arm: SimulatedArm, position: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> FloatArray:
    """Torque of every joint for one unit of each inertial number of each link.

    Args:
        arm: Kinematics.
        position: [rad] or [m]. Shape (n, n_joints), like the others.
        velocity: [rad/s] or [m/s].
        acceleration: [rad/s²] or [m/s²].

    Returns:
        Shape (n, n_joints, 10 n_links); times `arm.inertia.ravel()` it is the torque [N·m] or [N], rotors left out.
    """
    links = arm.follow(position, velocity, acceleration)
    return np.concatenate([_weigh_torque(link) for link in links], axis=2)


def compute_regressors(
    arm: SimulatedArm, position: FloatArray, velocity: FloatArray, acceleration: FloatArray
) -> Regressors:
    """The same, and how it changes with the direction of gravity.

    Args:
        arm: Kinematics.
        position: [rad] or [m]. Shape (n, n_joints), like the others.
        velocity: [rad/s] or [m/s].
        acceleration: [rad/s²] or [m/s²].
    """
    links = arm.follow(position, velocity, acceleration)
    return Regressors(
        np.concatenate([_weigh_torque(link) for link in links], axis=2),
        np.concatenate([np.stack([_weigh_lean(link, k) for k in range(2)], axis=2) for link in links], axis=3),
    )


def compute_mass_matrices(arm: SimulatedArm, position: FloatArray, inertia: FloatArray) -> FloatArray:
    """Mass matrices of the links, rotors left out [kg·m²].

    Args:
        arm: Kinematics.
        position: [rad] or [m]. Shape (n, n_joints).
        inertia: Ten numbers of each link. Shape (n_links, 10).

    Returns:
        Shape (n, n_joints, n_joints).
    """
    n, count = position.shape
    steps = np.vstack([np.zeros(count), np.eye(count)])
    each = np.repeat(steps, n, axis=0)  # all at once: a call costs more than its rows
    torque = compute_regressor(arm, np.tile(position, (count + 1, 1)), np.zeros_like(each), each) @ inertia.ravel()
    at_rest, *moved = torque.reshape(count + 1, n, count)
    return np.stack(moved, axis=2) - at_rest[:, :, None]


def compute_gradients(
    arm: SimulatedArm, position: FloatArray, velocity: FloatArray, acceleration: FloatArray, inertia: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """How the torques of all joints change as one of them stands elsewhere [N·m/rad], or turns faster [N·m·s/rad].

    Args:
        arm: Kinematics.
        position: [rad] or [m]. Shape (n, n_joints), like the next two.
        velocity: [rad/s] or [m/s].
        acceleration: [rad/s²] or [m/s²].
        inertia: Ten numbers of each link. Shape (n_links, 10).

    Returns:
        Of joint i by the position of joint j, and by its velocity. Shapes (n, n_joints, n_joints).
    """
    n, count = position.shape
    each = np.repeat(_STEP * np.vstack([np.eye(count), -np.eye(count)]), n, axis=0)
    motion = [np.tile(one, (2 * count, 1)) for one in (position, velocity, acceleration)]
    slopes = []
    for moved in range(2):
        there = [one + each if k == moved else one for k, one in enumerate(motion)]
        torque = (compute_regressor(arm, *there) @ inertia.ravel()).reshape(2, count, n, count)
        slopes.append(np.moveaxis(torque[0] - torque[1], 0, 2) / (2.0 * _STEP))
    return slopes[0], slopes[1]


def _weigh_torque(link: LinkMotion) -> FloatArray:
    """Shape (n, n_joints, 10)."""
    w, alpha, a = link.angular_velocity, link.angular_acceleration, link.acceleration
    n = len(w)
    force, moment = np.zeros((n, 3, N_INERTIA)), np.zeros((n, 3, N_INERTIA))
    turning = _cross(w)
    force[:, :, 0] = a
    force[:, :, 1:4] = _cross(alpha) + turning @ turning
    moment[:, :, 1:4] = -_cross(a)
    moment[:, :, 4:] = _multiply_inertia(alpha) + turning @ _multiply_inertia(w)
    back = np.swapaxes(link.translation, 1, 2) @ force + np.swapaxes(link.rotation, 1, 2) @ moment
    return np.asarray(back)


def _weigh_lean(link: LinkMotion, axis: int) -> FloatArray:
    """Shape (n, n_joints, 4)."""
    a = link.lean[:, :, axis]
    force, moment = np.zeros((len(a), 3, N_GRAVITY)), np.zeros((len(a), 3, N_GRAVITY))
    force[:, :, 0] = a
    moment[:, :, 1:] = -_cross(a)
    back = np.swapaxes(link.translation, 1, 2) @ force + np.swapaxes(link.rotation, 1, 2) @ moment
    return np.asarray(back)


def _cross(v: FloatArray) -> FloatArray:
    """Matrices that take the cross product with v from the left. Shape (n, 3, 3)."""
    result = np.zeros((len(v), 3, 3))
    result[:, 0, 1], result[:, 0, 2], result[:, 1, 2] = -v[:, 2], v[:, 1], -v[:, 0]
    return result - np.swapaxes(result, 1, 2)


def _multiply_inertia(v: FloatArray) -> FloatArray:
    """Matrices that take (I_xx, I_xy, I_xz, I_yy, I_yz, I_zz) to I v. Shape (n, 3, 6)."""
    x, y, z = v.T
    o = np.zeros_like(x)
    return np.stack(
        [np.stack(row, axis=1) for row in ((x, y, z, o, o, o), (o, x, o, y, z, o), (o, o, x, o, y, z))], axis=1
    )

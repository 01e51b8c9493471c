"""One joint of a moving arm as a joint that stands alone: what its neighbours do to it is known and taken off."""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray
from fricomp.recording import Recording

from .identification import ArmIdentification
from .regressor import compute_regressor

__all__ = ["view_joint"]


def view_joint(found: ArmIdentification, joint: int) -> list[Recording]:
    """Recordings of one joint, one a part, in which it turns a constant inertia of its own.

    Gravity, inertia that changes with the pose, and the coupling to all other joints are taken off the torque; the
    joint's mean inertia stays in it, so that a diagnosis of a single joint applies. What the joint transmits to its
    load is kept beside it.

    Args:
        found: An identified arm.
        joint: Number of the joint.
    """
    own = mean_inertia(found)[joint]
    views = []
    for number, (position, velocity, acceleration) in enumerate(found.rows.motion):
        links = compute_regressor(found.fit.arm, position, velocity, acceleration)[:, joint] @ found.fit.inertia.ravel()
        rigid = links + found.fit.armature[joint] * acceleration[:, joint]
        torque = found.rows.dense_torque[number][:, joint]
        views.append(
            Recording(
                time=found.rows.dense_time[number],
                position=position[:, joint],
                torque=torque / found.fit.gain[0] - rigid + own * acceleration[:, joint],
                load_torque=links,
                metadata=found.recording.metadata[joint],
            )
        )
    return views


def mean_inertia(found: ArmIdentification) -> FloatArray:
    """Inertia about each joint, the others held, averaged over the motion [kg·m²] or [kg]. Shape (n_joints,)."""
    arm = found.fit.arm
    positions = np.concatenate([motion[0] for motion in found.rows.motion])
    places = positions[:: max(1, len(positions) // 50)]
    still, theta = np.zeros_like(places), found.fit.inertia.ravel()
    rest = compute_regressor(arm, places, still, still) @ theta
    result = np.empty(len(arm.joints))
    for j in range(len(arm.joints)):
        pushed = still.copy()
        pushed[:, j] = 1.0
        result[j] = float(np.mean((compute_regressor(arm, places, still, pushed) @ theta - rest)[:, j]))
    return result + found.fit.armature

"""An arm as its simulation has it: joints, links, what each link weighs, and where each is as the joints move."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fricomp.errors import SimulationFileError
from fricomp.laws import FloatArray
from fricomp.simulation_file import compile_simulation

from .inertia import combine_inertia

__all__ = ["LinkMotion", "SimulatedArm", "read_arm"]


class LinkMotion(NamedTuple):
    """How one link moves along a recording, in its own frame about its own origin.

    Attributes:
        angular_velocity: [rad/s]. Shape (n, 3).
        angular_acceleration: [rad/s²]. Shape (n, 3).
        acceleration: Of the origin, with that of gravity taken off [m/s²]. Shape (n, 3).
        translation: Motion of the origin for each joint [m/rad]. Shape (n, 3, n_joints).
        rotation: Turn of the link for each joint [rad/rad]. Shape (n, 3, n_joints).
    """

    angular_velocity: FloatArray
    angular_acceleration: FloatArray
    acceleration: FloatArray
    translation: FloatArray
    rotation: FloatArray


@dataclass(frozen=True)
class SimulatedArm:
    """Kinematics and inertia of an arm.

    Attributes:
        joints: Names of the joints that were recorded, in the order of all columns.
        links: Names of the links that these joints move.
        inertia: Mass [kg], first moments [kg·m] and moments of inertia [kg·m²] of each link about its own origin: m,
            h_x, h_y, h_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz. Shape (n_links, 10).
        armature: Inertia of each joint's rotor behind its gear [kg·m²] or [kg]. Shape (n_joints,).
        rotary: Whether each joint turns.
        held: Names of the joints that nothing was recorded of: they stay where the simulation has them.
    """

    joints: tuple[str, ...]
    links: tuple[str, ...]
    inertia: FloatArray
    armature: FloatArray
    rotary: tuple[bool, ...]
    held: tuple[str, ...]
    _model: Any
    _bodies: tuple[int, ...]

    def follow(self, position: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> list[LinkMotion]:
        """Move the links as the joints moved.

        Args:
            position: [rad] or [m]. Shape (n, n_joints), like the others.
            velocity: [rad/s] or [m/s].
            acceleration: [rad/s²] or [m/s²].

        Returns:
            The motion of each of `links`.
        """
        import mujoco

        model, n = self._model, len(position)
        data = mujoco.MjData(model)
        places, dofs = self._addresses()
        motion = np.empty((len(self._bodies), n, 12))
        columns = np.empty((len(self._bodies), n, 6, len(dofs)))
        full = np.zeros((6, model.nv))
        for k in range(n):
            data.qpos[places], data.qvel[dofs], data.qacc[dofs] = position[k], velocity[k], acceleration[k]
            mujoco.mj_fwdPosition(model, data)
            mujoco.mj_fwdVelocity(model, data)
            mujoco.mj_rnePostConstraint(model, data)
            for i, body in enumerate(self._bodies):
                mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, motion[i, k, :6], 1)
                mujoco.mj_objectAcceleration(model, data, mujoco.mjtObj.mjOBJ_XBODY, body, motion[i, k, 6:], 1)
                mujoco.mj_jacBody(model, data, full[:3], full[3:], body)
                turn = data.xmat[body].reshape(3, 3)
                columns[i, k, :3], columns[i, k, 3:] = turn.T @ full[:3, dofs], turn.T @ full[3:, dofs]
        return [
            LinkMotion(m[:, :3], m[:, 6:9], m[:, 9:], c[:, :3], c[:, 3:]) for m, c in zip(motion, columns, strict=True)
        ]

    def _addresses(self) -> tuple[list[int], list[int]]:
        ids = [self._model.joint(name).id for name in self.joints]
        return [int(self._model.jnt_qposadr[i]) for i in ids], [int(self._model.jnt_dofadr[i]) for i in ids]


def read_arm(path: str | Path, joints: Sequence[str]) -> SimulatedArm:
    """Read an arm from MJCF or URDF.

    Args:
        path: The file. Joints that are not listed, such as those of a gripper, are held where the file has them.
        joints: Names of the recorded joints, in the order of their columns.

    Raises:
        SimulationFileError: The file cannot be read, lacks a joint, or a joint is neither a hinge nor a slide.
    """
    model = compile_simulation(path)
    import mujoco

    kinds = {int(mujoco.mjtJoint.mjJNT_HINGE): True, int(mujoco.mjtJoint.mjJNT_SLIDE): False}
    names = [model.joint(i).name for i in range(model.njnt)]
    for name in joints:
        if name not in names:
            raise SimulationFileError(
                f"{path} has no joint {name!r}; it has {', '.join(names)}: give a mapping of the names"
            )
        if int(model.jnt_type[names.index(name)]) not in kinds:
            raise SimulationFileError(f"{path}: joint {name!r} neither turns nor slides")
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT) | int(mujoco.mjtDisableBit.mjDSBL_ACTUATION)
    ids = [names.index(name) for name in joints]
    moved = _find_moved(model, ids)
    carried = {body: [each for each in range(model.nbody) if _link_of(model, each, moved) == body] for body in moved}
    return SimulatedArm(
        joints=tuple(joints),
        links=tuple(model.body(body).name or f"body {body}" for body in moved),
        inertia=np.array([_weigh(mujoco, model, body, carried[body]) for body in moved]),
        armature=np.array([float(model.dof_armature[model.jnt_dofadr[i]]) for i in ids]),
        rotary=tuple(kinds[int(model.jnt_type[i])] for i in ids),
        held=tuple(name for name in names if name not in joints),
        _model=model,
        _bodies=tuple(moved),
    )


def _find_moved(model: Any, joints: Sequence[int]) -> list[int]:
    """Bodies that a recorded joint is of: with all that is fixed to one, it is one link."""
    return sorted({int(model.jnt_bodyid[i]) for i in joints})


def _link_of(model: Any, body: int, moved: Sequence[int]) -> int:
    """The link that carries a body: the nearest one below it that a recorded joint moves."""
    while body and body not in moved:
        body = int(model.body_parentid[body])
    return body


def _weigh(mujoco: Any, model: Any, link: int, bodies: Sequence[int]) -> FloatArray:
    """Inertia of a link about its own origin, with all bodies that are fixed to it, the held joints as they are."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    origin, turn = np.array(data.xpos[link]), np.array(data.xmat[link]).reshape(3, 3)
    total = np.zeros(10)
    for body in bodies:
        centre = turn.T @ (data.xipos[body] - origin)
        axes = turn.T @ np.array(data.ximat[body]).reshape(3, 3)
        about = axes @ np.diag(model.body_inertia[body]) @ axes.T
        total += combine_inertia(float(model.body_mass[body]), centre, about)
    return total

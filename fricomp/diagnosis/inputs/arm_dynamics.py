"""Dynamics of an arm that is linear in what its bodies weigh: only its kinematics are taken from the simulation."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.simulation_file import compile_simulation

from .settings import INPUT
from .track import FloatArray

__all__ = ["ArmDynamics", "ArmMotion", "read_arm"]


@dataclass(frozen=True)
class ArmMotion:
    """Positions [rad or m], velocities and accelerations of all joints. Shapes (n, n_joints)."""

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray


@dataclass(frozen=True)
class ArmDynamics:
    """A chain of bodies.

    Attributes:
        joints: Names of the joints, in the order of the columns.
        bodies: Index of each body that moves.
        last: Index of the body at the end of the chain.
        model: MuJoCo's model.
    """

    joints: tuple[str, ...]
    bodies: tuple[int, ...]
    last: int
    model: Any

    def compute_body_columns(self, motion: ArmMotion, body: int) -> FloatArray:
        """Joint torques for each of ten point masses of 1 kg on a body, which span all it can weigh.

        Returns:
            Shape (n, n_joints, 10); the mass of the body is the sum of the ten weights, and its first moments are the
            weighted sum of `place_points`.
        """
        return np.stack([self._compute_torques(motion, body, point) for point in place_points()], axis=2)

    def _compute_torques(self, motion: ArmMotion, body: int, point: FloatArray) -> FloatArray:
        import mujoco

        model: Any = self.model
        model.body_mass[:], model.body_inertia[:] = INPUT.still_mass, 1e-12
        model.body_mass[body], model.body_ipos[body], model.body_iquat[body] = 1.0, point, (1.0, 0.0, 0.0, 0.0)
        model.dof_armature[:], model.dof_damping[:], model.dof_frictionloss[:] = 0.0, 0.0, 0.0
        mujoco.mj_setConst(model, mujoco.MjData(model))
        data: Any = mujoco.MjData(model)
        out = np.empty_like(motion.position)
        for k in range(motion.position.shape[0]):
            data.qpos[:], data.qvel[:], data.qacc[:] = motion.position[k], motion.velocity[k], motion.acceleration[k]
            mujoco.mj_inverse(model, data)
            out[k] = data.qfrc_inverse
        return out


def place_points() -> FloatArray:
    """Where the ten point masses sit on a body: their masses and moments are independent [m]. Shape (10, 3)."""
    e = np.eye(3)
    points = [np.zeros(3), *e, *-e, e[0] + e[1], e[1] + e[2], e[0] + e[2]]
    result: FloatArray = INPUT.mass_distance * np.array(points)
    return result


def read_arm(path: str | Path) -> ArmDynamics:
    """Read the kinematics of an arm from MJCF or URDF.

    Raises:
        DiagnosisError: The file cannot be read, or has joints that are neither hinges nor slides.
    """
    model = compile_simulation(path)
    import mujoco

    if model.nq != model.njnt or model.nv != model.njnt:
        raise DiagnosisError(f"{path} has joints that are neither hinges nor slides: give the arm alone")
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    model.jnt_stiffness[:] = 0.0  # a spring is no mass: it would stand in the columns of every body
    if hasattr(model, "jnt_stiffnesspoly"):
        model.jnt_stiffnesspoly[:] = 0.0
    model.body_sameframe[:] = 0  # the masses are moved about, so no frame is another one's any more
    names = tuple(model.joint(i).name for i in range(model.njnt))
    bodies = tuple(i for i in range(1, model.nbody) if model.body_weldid[i] == i)
    return ArmDynamics(names, bodies, bodies[-1], model)

"""The torque that each joint of an arm transmits, from the arm's own dynamics, in a control loop.

    τ_l = M(q) a + c(q, v) + g(q),

without the rotors, which lie before the gears. MuJoCo computes it by the recursive Newton-Euler method; the model is
compiled once, and a call allocates nothing but the numbers that it returns.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from struct import Struct
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from fricomp.errors import ParameterError, SimulationFileError
from fricomp.simulation_file import compile_simulation, list_followers

if TYPE_CHECKING:
    from fricomp.joint import JointFeedback

__all__ = ["ArmLoad"]


class MovingReference(Protocol):
    """What of a reference a load follows: `ReferenceState` has it."""

    @property
    def velocity(self) -> Sequence[float]:
        """[rad/s] or [m/s], one a joint."""

    @property
    def acceleration(self) -> Sequence[float]:
        """[rad/s²] or [m/s²], one a joint."""


_BYTES = 8
"""Of a float64."""


class ArmLoad:
    """Load torques of the joints of an arm: gravity, and what its links' inertia takes.

    It is a `LoadModel` too, for `ControlLoop(load_model=...)`.

    Attributes:
        joints: Names of the joints, in the order of all sequences.
        rotors: Inertia of each rotor behind its gear, seen from the joint [kg·m²] or [kg]: what accelerates it is no
            load of the gear, and part of what the motor has to give.

    Args:
        simulation: MJCF or URDF of the arm, such as the `arm.xml` that `fricomp diagnose` writes of one.
        joints: Names of the joints that move, in the order of the command; all that turn or slide, in the order of the
            file, if None. Others are held where the file has them, and joints that mimic one of these follow it.

    Raises:
        SimulationFileError: The file cannot be read, or has no such joint.
        MissingExtraError: MuJoCo is not installed.
    """

    def __init__(self, simulation: str | os.PathLike[str], joints: Sequence[str] | None = None) -> None:
        model = compile_simulation(os.fspath(simulation), extra="sim")
        import mujoco

        kinds = (int(mujoco.mjtJoint.mjJNT_HINGE), int(mujoco.mjtJoint.mjJNT_SLIDE))
        known = [model.joint(i).name for i in range(model.njnt) if int(model.jnt_type[i]) in kinds]
        self.joints = tuple(known if joints is None else joints)
        missing = [name for name in self.joints if name not in known]
        if missing or not self.joints:
            raise SimulationFileError(f"{simulation} has no joint {missing[:1]}: it has {', '.join(known)}")
        self._model, self._data, self._torque = model, mujoco.MjData(model), np.zeros(model.nv)
        arrays: tuple[Any, ...] = (self._data.qpos, self._data.qvel, self._data.qacc, self._torque)
        self._memory: tuple[Any, ...] = tuple(memoryview(one) for one in arrays)
        self._calls = (mujoco.mj_kinematics, mujoco.mj_comPos, mujoco.mj_comVel, mujoco.mj_rne)
        ids = [model.joint(name).id for name in self.joints]
        places, dofs = ([int(table[i]) for i in ids] for table in (model.jnt_qposadr, model.jnt_dofadr))
        self._places, self._dofs = np.array(places), np.array(dofs)
        self.rotors = tuple(model.dof_armature[dofs].tolist())
        self._followers = [
            (int(model.jnt_qposadr[one.follower]), int(model.jnt_dofadr[one.follower]), ids.index(one.leader), one.path)
            for one in list_followers(model, ids)
        ]
        self._is_row = all(np.all(np.diff(each) == 1) for each in (places, dofs)) and not self._followers
        self._pack = Struct(f"{len(ids)}d")
        self._at = _BYTES * places[0], _BYTES * dofs[0]

    def compute(
        self, position: Sequence[float], velocity: Sequence[float], acceleration: Sequence[float]
    ) -> Sequence[float]:
        """Load torque of each joint [N·m] or [N]; NaN where an input is no number.

        Args:
            position: [rad] or [m], one a joint.
            velocity: [rad/s] or [m/s].
            acceleration: [rad/s²] or [m/s²]; that of the reference, since nobody measures it.

        Raises:
            ParameterError: An input has another number of joints, or holds something else than numbers.
        """
        if not self._is_row:
            return self._compute_apart(position, velocity, acceleration)
        pack, (place, dof), (qpos, qvel, qacc, torque) = self._pack, self._at, self._memory
        try:
            pack.pack_into(qpos, place, *position)
            pack.pack_into(qvel, dof, *velocity)
            pack.pack_into(qacc, dof, *acceleration)
        except Exception as error:
            raise self._refuse(position, velocity, acceleration) from error
        self._run()
        found: Sequence[float] = pack.unpack_from(torque, dof)
        return found

    def load_into(self, out: list[float], feedback: JointFeedback, reference: MovingReference) -> None:
        """Fill `out` with the load at the measured position and the reference's velocity and acceleration."""
        out[:] = self.compute(feedback.position, reference.velocity, reference.acceleration)

    def _run(self) -> None:
        model, data = self._model, self._data
        kinematics, masses, velocities, newton_euler = self._calls
        kinematics(model, data)
        masses(model, data)
        velocities(model, data)
        newton_euler(model, data, 1, self._torque)

    def _compute_apart(
        self, position: Sequence[float], velocity: Sequence[float], acceleration: Sequence[float]
    ) -> Sequence[float]:
        """The same where the joints do not stand in a row in the file, or others follow them."""
        data, torque = self._data, self._torque
        try:
            data.qpos[self._places], data.qvel[self._dofs], data.qacc[self._dofs] = position, velocity, acceleration
        except Exception as error:
            raise self._refuse(position, velocity, acceleration) from error
        for place, dof, leader, path in self._followers:
            q, v, a = float(position[leader]), float(velocity[leader]), float(acceleration[leader])
            slope = float(path.deriv()(q))
            data.qpos[place], data.qvel[dof] = path(q), slope * v
            data.qacc[dof] = slope * a + float(path.deriv(2)(q)) * v * v
        self._run()
        found = torque[self._dofs]
        for _, dof, leader, path in self._followers:
            found[leader] += float(path.deriv()(float(position[leader]))) * torque[dof]
        result: list[float] = found.tolist()
        return result

    def _refuse(self, *given: Sequence[float]) -> ParameterError:
        n = len(self.joints)
        return ParameterError(
            f"position, velocity and acceleration must be {n} numbers each, for {', '.join(self.joints)}; got "
            + ", ".join(f"{len(one)}" if hasattr(one, "__len__") else repr(one) for one in given)
        )

"""An arm in MuJoCo, driven by the torques that were recorded at its joints."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fricomp.errors import SimulationFileError
from fricomp.laws import FloatArray, OperatingPoint, SpringTorque
from fricomp.model import FrictionModel
from fricomp.mujoco_warnings import silence_mujoco
from fricomp.simulation_file import read_specification

from .arm_motion import ArmMotion
from .arm_run import ArmRun
from .equation import follow_law
from .equation_rollout import count_substeps
from .motion import Index
from .mujoco_run import invert_motion, place, roll_out, set_step, spread_torque
from .settings import EVALUATION
from .simulated_joint import hold_others

__all__ = ["SimulatedArm", "read_simulated_arm"]

_STICKING = ((0.002, 1.0), (0.9999, 0.9999, 0.001, 0.5, 2.0))
"""MuJoCo's solref and solimp of friction that holds a joint: its defaults let it creep near breakaway."""


class ArmAlong(NamedTuple):
    """An arm along the recorded motion.

    Attributes:
        torque: That the motion takes [N·m] or [N]. Shape (n, n_joints).
        activation: Of passive motors. Shape (n_activations, n).
        states: Of the terms of each joint, each of shape (n_states, n).
    """

    torque: FloatArray
    activation: FloatArray
    states: tuple[tuple[FloatArray, ...], ...]


@dataclass(frozen=True)
class SimulatedArm:
    """The recorded joints of an arm.

    Attributes:
        model: MuJoCo's `MjModel`, with these joints alone.
        order: Degree of freedom of each recorded joint.
        laws: Friction of each joint in place of the file's; None for the file's own.
        step: Longest step of a simulation [s].
        notes: What to know, in sentences.
    """

    model: Any
    order: tuple[int, ...]
    laws: tuple[FrictionModel | None, ...] | None
    step: float
    notes: tuple[str, ...]

    @silence_mujoco()
    def follow(self, motion: ArmMotion, part: int) -> ArmAlong:
        """Torques that the recorded motion of a part takes, and the states that it leaves."""
        rigid, load, activation = self._invert(motion, part)
        rest = [one.rest_speed for one in motion.joints]
        recorded = motion.stack(part, "torque")
        if self.laws is None:
            rests = np.abs(motion.stack(part, "smooth_velocity")) <= rest
            return ArmAlong(np.where(rests, recorded, rigid), activation, ())
        torque = rigid.copy()
        states: list[tuple[FloatArray, ...]] = []
        for j, model in enumerate(self.laws):
            one = motion.joints[j].parts[part]
            if model is None:
                states.append(())
                continue
            point = OperatingPoint(one.smooth_velocity, one.position, one.acceleration, load[:, j])
            point = replace(point, temperature=one.channels.get("temperature"))
            along = follow_law(model.law, point, rigid[:, j], recorded[:, j], (one.dt, rest[j]))
            torque[:, j] = along.torque
            states.append(along.states)
        return ArmAlong(torque, activation, tuple(states))

    @silence_mujoco()
    def simulate(
        self, motion: ArmMotion, part: int, along: ArmAlong, starts: Index, lengths: Sequence[int]
    ) -> FloatArray:
        """Positions after so many samples from each start. Shape (n_lengths, n_starts, n_joints)."""
        if self.laws is None:
            return self._roll_out(motion, part, along, starts, lengths)
        return self._roll_out_with_laws(motion, part, along, starts, lengths)

    def _invert(self, motion: ArmMotion, part: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Torque of the file's arm, torque that its gears transmit, and activations, at each sample."""
        model, substeps = self.model, set_step(self.model, motion.dt, self.step)
        self._lift_limits(motion, part)
        position, velocity, acceleration = (
            self._spread(motion.stack(part, name)) for name in ("position", "smooth_velocity", "acceleration")
        )
        torque, states = invert_motion(model, position, velocity, acceleration, substeps)
        load = torque - np.asarray(model.dof_armature) * acceleration
        return torque[:, self.order], load[:, self.order], states

    def _lift_limits(self, motion: ArmMotion, part: int) -> None:
        """No stop at the end of a range that a joint was recorded beyond: there, the torque of none was recorded."""
        joints = np.asarray(self.model.dof_jntid)[list(self.order)]
        low, high = np.asarray(self.model.jnt_range)[joints].T
        position = motion.stack(part, "position")
        self.model.jnt_limited[joints[np.any((position < low) | (position > high), axis=0)]] = 0

    def _spread(self, values: FloatArray) -> FloatArray:
        """Columns of the recorded joints in MuJoCo's order."""
        result = np.empty_like(values)
        result[..., list(self.order)] = values
        return result

    def _list_starts(
        self, motion: ArmMotion, part: int, along: ArmAlong, starts: Index
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Positions, velocities and activations at these samples, each of shape (n_starts, ...)."""
        position, velocity = (self._spread(motion.stack(part, name)[starts]) for name in ("position", "velocity"))
        return position, velocity, along.activation[:, starts].T

    def _drive(self, motion: ArmMotion, part: int, starts: Index, length: int, substeps: int) -> FloatArray:
        """Torques of the recorded joints at each step. Shape (n_starts, n_steps, n_joints)."""
        torque = motion.stack(part, "torque")
        return np.stack([spread_torque(column, starts, length, substeps) for column in torque.T], axis=-1)

    def _roll_out(
        self, motion: ArmMotion, part: int, along: ArmAlong, starts: Index, lengths: Sequence[int]
    ) -> FloatArray:
        substeps = set_step(self.model, motion.dt, self.step)
        drive = self._spread(self._drive(motion, part, starts, lengths[-1], substeps))
        states = self._list_starts(motion, part, along, starts)
        return roll_out(self.model, states, drive, substeps * np.array(lengths))[:, :, list(self.order)]

    def _roll_out_with_laws(
        self, motion: ArmMotion, part: int, along: ArmAlong, starts: Index, lengths: Sequence[int]
    ) -> FloatArray:
        """Levels of dry friction and drag are told to MuJoCo before each step; all else is a torque."""
        import mujoco

        assert self.laws is not None
        data = [mujoco.MjData(self.model) for _ in starts]
        for one, state in zip(data, zip(*self._list_starts(motion, part, along, starts), strict=True), strict=True):
            place(one, *state)
        substeps = set_step(self.model, motion.dt, self.step, self._count_substeps(motion, part))
        top = np.array([max(float(np.max(np.abs(one.parts[part].velocity))), 1e-9) for one in motion.joints])
        run = ArmRun(self.model, self.order, [None if one is None else one.law for one in self.laws], data, top)
        run.remember(along.states, starts)
        drive = self._drive(motion, part, starts, lengths[-1], substeps)
        result = np.empty((len(lengths), starts.size, len(self.order)))
        for step in range(lengths[-1] * substeps):
            run.advance(drive[:, step].copy())
            for i, length in enumerate(lengths):
                if step + 1 == length * substeps:
                    result[i] = run.position
        return result

    def _count_substeps(self, motion: ArmMotion, part: int) -> int:
        assert self.laws is not None
        least = np.maximum(np.asarray(self.model.dof_M0)[list(self.order)], 1e-9)
        return max(
            count_substeps(model.law, float(inertia), motion.dt, float(np.max(np.abs(one.parts[part].velocity))))
            for model, inertia, one in zip(self.laws, least, motion.joints, strict=True)
            if model is not None
        )


def read_simulated_arm(
    path: str | os.PathLike[str], joints: Sequence[str], laws: tuple[FrictionModel | None, ...] | None
) -> SimulatedArm:
    """Read the recorded joints of an arm; the others are held where the file has them.

    Args:
        path: MJCF or URDF file.
        joints: Names of the recorded joints in it.
        laws: Friction of each, in place of the file's; None for the file's own.

    Raises:
        SimulationFileError: The file cannot be read, lacks a joint, or a joint neither turns nor slides.
    """
    spec = read_specification(Path(path))
    import mujoco

    known = [one.name for one in spec.joints]
    for name in joints:
        if name not in known:
            raise SimulationFileError(f"{path} has no joint {name!r}; it has {', '.join(known)}: match the names")
    hold_others(spec, joints, passive=laws is None)
    try:
        model = spec.compile()
    except ValueError as error:
        raise SimulationFileError(f"{path}: its recorded joints cannot be simulated alone: {error}") from error
    if model.nq != len(joints) or model.nv != len(joints):
        raise SimulationFileError(f"{path}: a recorded joint neither turns nor slides: leave its recording out")
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    if laws is not None:
        _clear_friction(model)
        _clear_springs(model, [name for name, law in zip(joints, laws, strict=True) if law is not None and _pulls(law)])
    order = tuple(int(model.jnt_dofadr[model.joint(name).id]) for name in joints)
    held = [name for name in known if name not in joints]
    notes = (f"Held where the file has them: {', '.join(held)}.",) if held else ()
    return SimulatedArm(model, order, laws, min(float(model.opt.timestep), EVALUATION.longest_step), notes)


def _clear_friction(model: Any) -> None:
    """No friction but what the laws say, which truly sticks."""
    model.dof_damping[:] = 0.0
    model.dof_frictionloss[:] = 0.0
    model.dof_solref[:], model.dof_solimp[:] = _STICKING


def _pulls(model: FrictionModel) -> bool:
    """Whether a law has a spring: the joint's whole one, which the file may have as well."""
    return any(term.name == SpringTorque.name for term in model.law.terms)


def _clear_springs(model: Any, joints: Sequence[str]) -> None:
    for name in joints:
        at = model.joint(name).id
        model.jnt_stiffness[at] = 0.0
        if hasattr(model, "jnt_stiffnesspoly"):
            model.jnt_stiffnesspoly[at] = 0.0

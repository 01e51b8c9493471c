"""One joint of an MJCF or URDF file in MuJoCo, the others held where the file has them."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import SimulationFileError
from fricomp.laws import FloatArray, SpringTorque
from fricomp.model import JointDynamics
from fricomp.mujoco_warnings import silence_mujoco
from fricomp.simulation_file import read_specification

from .equation import Along
from .evaluated import EvaluatedJoint
from .motion import Index, MotionPart
from .mujoco_run import invert_motion, roll_out, set_step, spread_torque
from .settings import EVALUATION

_MOTOR_CONSTANT = 1  # place in the gain parameters of MuJoCo's dcmotor


@dataclass(frozen=True)
class SimulatedJoint(EvaluatedJoint):
    """A joint in MuJoCo, driven by a torque that is applied to it: drives of the file itself are switched off.

    Attributes:
        model: MuJoCo's `MjModel` with this one joint.
        step: Of the simulation at most [s]: that of the file.
    """

    model: Any
    step: float

    @silence_mujoco()
    def follow(self, part: MotionPart, rest_speed: float) -> Along:
        """Torque by inverse dynamics, and the states of passive motors; a resting joint takes what the drive gives."""
        position, velocity, acceleration = (
            one[:, None] for one in (part.position, part.smooth_velocity, part.acceleration)
        )
        substeps = set_step(self.model, part.dt, self.step)
        torque, states = invert_motion(self.model, position, velocity, acceleration, substeps)
        rests = np.abs(part.smooth_velocity) <= rest_speed
        return Along(np.where(rests, part.torque, torque[:, 0]), (states,))

    @silence_mujoco()
    def simulate(self, part: MotionPart, along: Along, starts: Index, lengths: Sequence[int]) -> FloatArray:
        """See `EvaluatedJoint`; all simulations run in one call of `mujoco.rollout`."""
        substeps = set_step(self.model, part.dt, self.step)
        states = part.position[starts, None], part.velocity[starts, None], along.states[0][:, starts].T
        drive = spread_torque(part.torque, starts, lengths[-1], substeps)
        return roll_out(self.model, states, drive[:, :, None], substeps * np.array(lengths))[:, :, 0]

    def measure_dynamics(self) -> JointDynamics:
        """Inertia and gravity about the joint, by MuJoCo's own recursion."""
        import mujoco

        model, data = self.model, mujoco.MjData(self.model)
        turn = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False) if self.motion == "rotary" else np.zeros(1)
        bias = np.empty(turn.size)
        for k, position in enumerate(turn):
            data.qpos[0] = position
            mujoco.mj_forward(model, data)
            bias[k] = data.qfrc_bias[0]
        full = np.zeros((1, 1))
        mujoco.mj_fullM(model, data, full)
        turns = 2.0 if self.motion == "rotary" else 0.0
        cosine, sine = (turns * float(np.mean(bias * wave)) for wave in (np.cos(turn), np.sin(turn)))
        return JointDynamics(float(full[0, 0]), cosine, sine, float(np.mean(bias)))

    def read_spring(self) -> SpringTorque | None:
        """The straight spring of the joint; None where it has none."""
        stiffness = float(np.ravel(self.model.jnt_stiffness[0])[0])
        return SpringTorque(stiffness, float(self.model.qpos_spring[0])) if stiffness > 0.0 else None


def read_simulated_joint(path: str | Path, joint: str | None, *, named: bool = True) -> SimulatedJoint:
    """Read one joint of a simulation; the others are held at their reference position.

    Args:
        path: MJCF or URDF file.
        joint: Name of the joint.
        named: Whether it must have that name; else the only joint will do.

    Raises:
        SimulationFileError: The file cannot be read, or has no such joint.
        MissingExtraError: MuJoCo is not installed.
    """
    spec = read_specification(path)
    import mujoco

    names = [one.name for one in spec.joints]
    if not names:
        raise SimulationFileError(f"{path} has no joint: give a file whose joint moves")
    if joint not in names and (named or len(names) > 1):
        raise SimulationFileError(
            f"{path} {'has no joint ' + repr(joint) if named else f'has {len(names)} joints'}; say which of its joints "
            f"is meant: {', '.join(map(repr, names))}"
        )
    chosen = joint if joint in names else names[0]
    hold_others(spec, (str(chosen),))
    try:
        model = spec.compile()
    except ValueError as error:
        raise SimulationFileError(f"{path}: its joint {chosen!r} cannot be simulated alone: {error}") from error
    kinds: dict[int, Any] = {int(mujoco.mjtJoint.mjJNT_HINGE): "rotary", int(mujoco.mjtJoint.mjJNT_SLIDE): "linear"}
    if int(model.jnt_type[0]) not in kinds:
        raise SimulationFileError(f"{path}: joint {chosen!r} neither turns nor slides: give one that does")
    motion = kinds[int(model.jnt_type[0])]
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    notes = ("The other joints of the file are held where it has them.",) if len(names) > 1 else ()
    step = min(float(model.opt.timestep), EVALUATION.longest_step)
    unit = "N·m" if motion == "rotary" else "N"
    return SimulatedJoint(f"{Path(path).name} in MuJoCo", motion, unit, notes, model, step)


def hold_others(spec: Any, kept: Sequence[str], *, passive: bool = True) -> None:
    """Delete all joints but some, and what drives, couples or watches any of them.

    Args:
        spec: MuJoCo's `MjSpec`.
        kept: Names of the joints that stay.
        passive: Whether passive motors of these joints stay, which are their friction.
    """
    import mujoco

    motor, fixed = int(mujoco.mjtGain.mjGAIN_DCMOTOR), int(mujoco.mjtGain.mjGAIN_FIXED)
    for one in list(spec.actuators):
        mine = passive and one.target in kept
        if mine and int(one.gaintype) == motor:
            one.gainprm[_MOTOR_CONSTANT] = 0.0  # its friction and ripple stay, and it gives no torque of its own
        elif not (mine and int(one.gaintype) == fixed and one.gainprm[0] == 0.0):  # what no control moves is passive
            spec.delete(one)
    for each in (spec.sensors, spec.equalities, spec.keys, spec.tendons, spec.pairs, spec.excludes):
        for one in list(each):
            spec.delete(one)
    for one in list(spec.joints):
        if one.name not in kept:
            spec.delete(one)

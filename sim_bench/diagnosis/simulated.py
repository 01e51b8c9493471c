"""The user's own simulation, known only by a recording that it made under the same commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .base import BASE_NAMES, BODY_AND_CURVES
from .checks import reasons_against
from .comparison import NAMED, PLAIN, SPLIT, UNEXPLAINED, Doubt
from .controller import Controller
from .diagnose import diagnose, with_remarks
from .result import Diagnosis, NamedEffect, Quantity
from .rigid import RigidJoint
from .sensor_noise import as_sensed
from .shared_effect import without_known
from .track import FloatArray

__all__ = ["SimulatedJoint", "diagnose_against", "motion_remarks", "read_simulated"]

_MECHANICAL = {"N·m", "N"}
_SHORT = 0.8  # of the recording's duration, below which a simulated one is told to be shorter
_MORE_THAN_NOISE = 1.5  # times the noise on held-out data, that is left where the named effects are not all
# Unrelated motions of one size differ by the square root of two, in standard deviations of the position; the same one
# by how differently two joints follow a command.
_SAME_MOTION = 0.5
# How an offset and the difference of the directions make up for each other while the joint slides.
_PARTING = {"offset": 1.0, "forward.coulomb_torque": -1.0, "reverse.coulomb_torque": 1.0}


@dataclass(frozen=True)
class SimulatedJoint:
    """What a simulation's recording says about the simulation.

    Attributes:
        rigid: Its inertia, gravity and friction; without friction where something stays unexplained.
        friction: Its friction; None where something stays unexplained, since that bends the friction most.
        effects: Effects of the catalogue that it has itself.
        noise_ratio: Residual that no effect explains, over the noise; None where nothing stays unexplained.
    """

    rigid: RigidJoint
    friction: FrictionModel | None
    effects: tuple[NamedEffect, ...] = ()
    noise_ratio: float | None = None

    @property
    def remarks(self) -> tuple[str, ...]:
        """What stays unexplained in it, in a sentence."""
        if self.noise_ratio is None:
            return ()
        return (
            f"The simulated recording itself shows something that no effect explains ({self.noise_ratio:.3g} times the "
            "recording's noise): its inertia and gravity were read within one or two per cent at best, its friction "
            "and any constant torque were not compared, and what this recording shows may be in the simulation as "
            "well. The simulation itself, given with --simulation, would tell.",
        )


def read_simulated(
    recording: Recording,
    like: Sequence[Recording] = (),
    *,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> SimulatedJoint:
    """Identify the joint that a simulation has, from its own recording, in the way of any other recording.

    Args:
        recording: What the simulator made.
        like: Recordings of the real joint, whose noise it gets where it has less: whatever a simulator does below that
            noise has no bearing on the comparison with them.
        seed: Of noise, nulls and bootstraps.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: No joint can be identified from it.
    """
    against = reasons_against([recording], None)
    if against:
        raise DiagnosisError(f"the simulated recording cannot be used: {'; '.join(against)}")
    recording = recording.on_joint_side()
    sensed = as_sensed(recording, [one.on_joint_side() for one in like], seed) if like else recording
    found = diagnose(sensed, seed=seed, progress=progress)
    base, left = found.record.base, _left(found)
    if not base:
        raise DiagnosisError(
            "the simulated recording obeys no law of its joint's own motion, so no simulation can be read from it: "
            "give one that moves freely, or the simulation itself with --simulation"
        )

    friction = _friction(recording, base)
    forward, reverse = friction.forward, friction.reverse
    rigid = RigidJoint(
        inertia=base["inertia"].value,
        gravity=(base["gravity_cos"].value, base["gravity_sin"].value),
        offset=base["offset"].value,
        damping=0.5 * (forward.viscous_coefficient + reverse.viscous_coefficient),
        friction_loss=0.5 * (forward.coulomb_torque + reverse.coulomb_torque),
        rotary=recording.metadata.motion == "rotary",
    )
    doubt = UNEXPLAINED if left is not None else NAMED if found.effects else PLAIN
    if found.covariance is not None:
        rigid = replace(rigid, covariance=_body_and_curves(found.covariance, rigid, _level(found, rigid), doubt))
    if left is not None:
        return SimulatedJoint(replace(rigid, damping=0.0, friction_loss=0.0), None, found.effects, left)
    return SimulatedJoint(rigid, friction, found.effects)


def _left(found: Diagnosis) -> float | None:
    """What no effect explains, over the noise; None where that is no more than noise."""
    held = found.heldout
    if found.verdict == "unknown_physics" or held is None:
        return found.record.noise_ratio
    left = held.rmse_after / max(held.noise_floor, 1e-30)
    return left if left > _MORE_THAN_NOISE else None


def _friction(recording: Recording, base: Mapping[str, Quantity]) -> FrictionModel:
    """The refitted curves, without the constant torque that a model alone would hold."""
    curves = (
        StribeckCurve(
            base[f"{side}.coulomb_torque"].value,
            base[f"{side}.coulomb_torque"].value + base[f"{side}.excess"].value,
            base[f"{side}.stribeck_velocity"].value,
            base[f"{side}.viscous_coefficient"].value,
        )
        for side in ("forward", "reverse")
    )
    metadata = recording.metadata
    law = FrictionLaw((BidirectionalStribeck(*curves),))
    return FrictionModel(law=law, joint=metadata.joint, motion=metadata.motion, torque_unit=metadata.torque_unit)


def _level(found: Diagnosis, read: RigidJoint) -> float:
    """Dry friction in both directions, with what of it a named effect has taken over from the base."""
    if found.base_model is None:
        return read.friction_loss
    curves = (found.base_model.forward, found.base_model.reverse)
    return max(read.friction_loss, 0.5 * sum(curve.coulomb_torque for curve in curves))


def diagnose_against(
    recordings: Recording | Sequence[Recording],
    simulated: Recording,
    *,
    joint: str | None = None,
    controller: Controller | None = None,
    thorough: bool = False,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Say what a simulation of a joint leaves out that is known only by what it recorded under the same commands.

    Args:
        recordings: One or several recordings of the real joint.
        simulated: What the simulator recorded; it needs no noise.
        joint: Name of the joint in the recordings; None to take any.
        controller: The loop that moved the real joint; None to estimate it where the reference was recorded.
        thorough: Use more nulls for the thresholds.
        seed: Of noise, nulls and bootstraps; the same seed gives the same answer.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: No joint can be read off the simulated recording, or the recordings do not belong together.
    """
    say = progress or (lambda _: None)
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if reasons_against(given, joint):
        return diagnose(given, joint=joint)  # which says so
    alike = _in_one_unit(simulated, given)
    say("reading the simulation from its recording")
    known = read_simulated(simulated, given, seed=seed, progress=progress)
    found = diagnose(
        given,
        known.rigid,
        joint=joint,
        friction=known.friction if alike else None,
        controller=controller,
        thorough=thorough,
        seed=seed,
        progress=progress,
    )
    found = without_known(found, known.effects, sure=known.noise_ratio is None)
    return with_remarks(found, (*known.remarks, *motion_remarks(given, simulated)))


def _body_and_curves(covariance: FloatArray, read: RigidJoint, level: float, doubt: Doubt) -> FloatArray:
    """Covariance of inertia, gravity, offset and curves; what sliding cannot part is known no better than in a refit.

    Args:
        covariance: Of the base. Shape (p, p).
        read: What was read.
        level: Dry friction.
        doubt: How far all of it strays beyond what the fit knows of its own error.
    """
    named = BASE_NAMES[:BODY_AND_CURVES]
    parting = np.array([_PARTING.get(name, 0.0) for name in named]) * SPLIT * level
    gravity = float(np.hypot(doubt.gravity * float(np.hypot(*read.gravity)), doubt.sliding * level))
    strays = {"log_inertia": doubt.inertia, "gravity_cos": gravity, "gravity_sin": gravity}
    strays |= dict.fromkeys(_PARTING, doubt.uneven * level)
    beyond = np.diag([strays.get(name, 0.0) for name in named]) ** 2
    result: FloatArray = covariance[: len(named), : len(named)] + np.outer(parting, parting) + beyond
    return result


def _in_one_unit(simulated: Recording, recordings: Sequence[Recording]) -> bool:
    """Whether the torques are in one unit; with currents the simulation's friction cannot be compared.

    Raises:
        DiagnosisError: Only the simulated torque is none in N·m or N.
    """
    own, *others = (one.on_joint_side().metadata.torque_unit for one in (simulated, *recordings))
    if own not in _MECHANICAL and set(others) <= _MECHANICAL:
        raise DiagnosisError(
            f"the simulated torque is in {own} and the recorded one in {others[0]}: let the simulator record N·m or N"
        )
    return set(others) == {own}


def motion_remarks(recordings: Sequence[Recording], simulated: Recording) -> tuple[str, ...]:
    """What tells that a simulated recording was not made under the commands of the recordings, in sentences."""
    longest = max(one.duration for one in recordings)
    if simulated.duration < _SHORT * longest:
        return (
            f"The simulated recording lasts {simulated.duration:.3g} s and the recording {longest:.3g} s: what it says "
            "about the simulation holds for the part of the motion that it has.",
        )
    apart = min(_apart(one, simulated) for one in recordings)
    if apart < _SAME_MOTION:
        return ()
    return (
        f"The simulated recording has another motion (positions at the same times differ by {apart:.2g} times the "
        "spread of the recorded ones): let the simulator follow the same commands, since a motion that shows less of "
        "its joint leaves the comparison in doubt.",
    )


def _apart(recording: Recording, simulated: Recording) -> float:
    """RMS difference of the positions at the same time since the start, over the standard deviation of the recorded."""
    time = np.asarray(recording.time) - recording.time[0]
    shared = time <= simulated.duration
    moved = np.interp(time[shared], np.asarray(simulated.time) - simulated.time[0], np.asarray(simulated.position))
    position = np.asarray(recording.position)[shared]
    return float(np.sqrt(np.mean((moved - position) ** 2)) / max(float(np.std(position)), 1e-12))

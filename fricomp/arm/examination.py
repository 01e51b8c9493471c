"""From recordings of all joints and a simulation to the answer on the arm."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from fricomp.blas import one_blas_thread
from fricomp.errors import RecordingError, SimulationFileError
from fricomp.recording import Recording
from fricomp.simulation_file import list_joints

from .answer import ArmAnswer, confirm_terms
from .arm_recording import ArmRecording, join_joints, require_single
from .conclusion import write_record
from .identification import ArmIdentification, Progress, identify_arm, identify_without
from .left_out.guided import find_guided, leave_out_spans
from .left_out.still import find_still
from .log.drive_gain import take_torques
from .log.turns import unwrap_turns
from .prior import ArmPrior
from .record import ArmRecord
from .rigid.naming import find_strangers
from .rigid.simulated_arm import SimulatedArm, read_arm
from .search.degrees import are_degrees, take_radians
from .search.frames import find_turned_torques, turn_torque
from .search.gear import YIELDING_GEAR
from .search.mounting import find_mounting
from .search.order import require_order


@dataclass(frozen=True)
class ArmExamination:
    """The answer on an arm.

    Attributes:
        answer: Fit, evidence and errors.
        record: What `arm.json` holds.
    """

    answer: ArmAnswer
    record: ArmRecord

    def summary(self) -> str:
        """The answer in plain sentences, one a line."""
        return "\n".join(self.record.sentences)


@one_blas_thread()
def examine_arm(
    recordings: Sequence[Recording],
    simulation: str | Path,
    *,
    names: Mapping[str, str] | None = None,
    gains: Mapping[str, float] | None = None,
    prior: ArmPrior | None = None,
    seed: int = 0,
    progress: Progress | None = None,
) -> ArmExamination:
    """Say what the simulation of an arm leaves out, from one recording in which all its joints move.

    Links, rotors and the friction of all joints are fitted together; what is named in a joint comes again in halves of
    the recording and lowers the error on data that took no part.

    Args:
        recordings: One of each joint, from the same time; metadata say which joint each is of.
        simulation: MJCF or URDF of the arm. Joints that were not recorded are held where it has them.
        names: Names in the simulation by names in the recordings, where they differ by more than the word joint.
        gains: Torque of one ampere by names in the recordings [N·m/A] or [N/A], gear included, for torques that were
            recorded as currents and whose metadata do not say it.
        prior: How far the simulation is trusted; masses to some 20 % by default.
        seed: Of the halves; another seed draws others.
        progress: Called with a few words before each step.

    Raises:
        RecordingError: The recordings are not of one arm in motion.
        SimulationFileError: The simulation cannot be read, or lacks a joint.
        IdentificationError: The motion is too short.
    """
    if len(recordings) < 2:
        raise RecordingError("an arm has two joints or more: diagnose a single joint by its own recording")
    arm, recording = match_recordings(recordings, simulation, names, gains)
    if set(recording.one_way) == set(recording.joints):
        raise RecordingError(
            f"{', '.join(recording.joints)} moved one way only: friction is then not told from gravity or a constant "
            "torque; record a motion that goes to and fro"
        )
    found = identify_arm(arm, recording, prior, progress)
    say = progress or (lambda _: None)
    say("confirming on held-out data")
    answer = confirm_terms(found, seed)
    lost = _list_gears(found) - _list_gears(answer.identification)
    if lost:
        say("searching again, without a gear that is not borne out")
        answer = confirm_terms(identify_without(answer.identification, lost, progress), seed)
    return ArmExamination(answer, write_record(answer))


def _list_gears(found: ArmIdentification) -> frozenset[str]:
    """List the gears that give way by the names of `propose_models`: links and the friction of all joints bend with
    one, and what was not sought beside it is missing when it goes."""
    pairs = zip(found.fit.arm.joints, found.fit.model.forms, strict=True)
    return frozenset(f"{joint}: {name}" for joint, form in pairs for name, _ in form.terms if name == YIELDING_GEAR)


def match_recordings(
    recordings: Sequence[Recording],
    simulation: str | Path,
    names: Mapping[str, str] | None = None,
    gains: Mapping[str, float] | None = None,
) -> tuple[SimulatedArm, ArmRecording]:
    """An arm with the joints that were recorded, in the order of the simulation, and all of them on one clock.

    Args:
        recordings: One of each joint.
        simulation: MJCF or URDF.
        names: As for `examine_arm`.
        gains: As for `examine_arm`.

    Raises:
        RecordingError: As for `examine_arm`.
        SimulationFileError: As for `examine_arm`.
    """
    recorded = [one.metadata.joint for one in recordings]
    require_single(recorded)
    torques = take_torques(recordings, gains or {})
    arm, apart = _read_recorded(simulation, torques, names)
    if apart:
        kept = [one for one in recordings if one.metadata.joint not in apart]
        arm, joined = match_recordings(kept, simulation, names, gains)
        still = find_still(torques)
        return arm, replace(
            joined,
            still=(*joined.still, *(name for name in apart if name in still)),
            strangers=tuple(name for name in apart if name not in still),
        )
    if arm.order != tuple(range(len(recorded))):
        recorded, torques = [recorded[i] for i in arm.order], [torques[i] for i in arm.order]
        arm = read_arm(simulation, recorded, names)
    matched = [_name_as_simulated(*one) for one in zip(torques, arm.joints, arm.rotary, strict=True)]
    matched, unwrapped = unwrap_turns(matched, arm.rotary)
    degrees = are_degrees(arm, matched)
    matched = take_radians(arm, matched) if degrees else matched
    still = find_still(matched)
    if not still:
        arm, joined = _join_rightly(arm, matched)
        return arm, replace(joined, degrees=degrees, unwrapped=unwrapped)
    moving = [one for one in matched if one.metadata.joint not in still]
    if not moving:
        raise RecordingError(f"none of {', '.join(still)} moves further than it sways: move the arm")
    held = replace(read_arm(simulation, [one.metadata.joint for one in moving], still=still), in_order=arm.in_order)
    held, joined = _join_rightly(held, moving)
    return held, replace(joined, still=tuple(still), degrees=degrees, unwrapped=unwrapped)


def _join_rightly(arm: SimulatedArm, recordings: Sequence[Recording]) -> tuple[SimulatedArm, ArmRecording]:
    """All joints on one clock, with torques that accelerate towards positive position, and the arm as it is mounted."""
    joined = join_joints(recordings)
    if arm.in_order:
        require_order(arm, joined)
    mounting = find_mounting(arm, joined)
    if mounting is not None:
        arm, joined = arm.with_gravity(mounting.gravity), replace(joined, frames_instead=mounting.frames)
    turned = find_turned_torques(arm, joined)
    if turned:
        recordings = [turn_torque(one) if one.metadata.joint in turned else one for one in recordings]
        joined = replace(join_joints(recordings), turned=turned, frames_instead=joined.frames_instead)
    return arm, _leave_out_guided(arm, joined, recordings)


def _leave_out_guided(arm: SimulatedArm, joined: ArmRecording, recordings: Sequence[Recording]) -> ArmRecording:
    """The recording without what else than the drives moved the arm in, where anything did."""
    guided = find_guided(arm, joined)
    if not guided:
        return joined
    own = join_joints(leave_out_spans(recordings, guided))
    return replace(own, guided=guided, turned=joined.turned, frames_instead=joined.frames_instead)


def _read_recorded(
    simulation: str | Path, recordings: Sequence[Recording], names: Mapping[str, str] | None
) -> tuple[SimulatedArm, tuple[str, ...]]:
    """The arm with these joints, and names of recorded ones that it lacks, such as a gripper's.

    They stood still, or all of its own were recorded beside them.
    """
    recorded = [one.metadata.joint for one in recordings]

    def read(left_out: Collection[str]) -> SimulatedArm:
        given = {name: there for name, there in (names or {}).items() if name not in left_out}
        return read_arm(simulation, [name for name in recorded if name not in left_out], given)

    try:
        return read(()), ()
    except SimulationFileError:
        strangers = find_strangers(recorded, list_joints(simulation), names or {})
        if strangers:
            return read(strangers), strangers
        still = set(find_still(recordings))
        if not still or len(still) > len(recorded) - 2:
            raise
        with suppress(SimulationFileError):
            read(still)
            apart = tuple(name for name in recorded if name in still and not _is_readable(read, still - {name}))
            return read(apart), apart
        raise


def _is_readable(read: Callable[[Collection[str]], SimulatedArm], left_out: Collection[str]) -> bool:
    with suppress(SimulationFileError):
        read(left_out)
        return True
    return False


def _name_as_simulated(recording: Recording, name: str, rotary: bool) -> Recording:
    """The recording with the joint's name and kind of motion in the simulation."""
    metadata = recording.metadata
    if rotary and metadata.motion == "linear":
        raise RecordingError(f"joint {metadata.joint!r} was recorded in m and N, and turns in the simulation")
    if rotary:
        return recording.with_metadata(joint=name)
    unit = "N" if metadata.torque_unit == "N·m" else metadata.torque_unit
    return recording.with_metadata(joint=name, motion="linear", torque_unit=unit)

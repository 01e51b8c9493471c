"""From recordings of all joints and a simulation to the answer on the arm."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from fricomp.errors import RecordingError
from fricomp.recording import Recording

from .answer import ArmAnswer, confirm_terms
from .arm_recording import join_joints
from .conclusion import write_record
from .identification import Progress, identify_arm
from .prior import ArmPrior
from .record import ArmRecord
from .simulated_arm import read_arm

__all__ = ["ArmExamination", "examine_arm"]


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


def examine_arm(
    recordings: Sequence[Recording],
    simulation: str | Path,
    *,
    names: Mapping[str, str] | None = None,
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
        names: Names in the simulation by names in the recordings, where they differ.
        prior: How far the simulation is trusted; masses to some 20 % by default.
        seed: Of the halves; another seed draws others.
        progress: Called with a few words before each step.

    Raises:
        RecordingError: The recordings are not of one arm in motion.
        SimulationFileError: The simulation cannot be read, or lacks a joint.
        IdentificationError: The motion is too short.
    """
    renamed = [_rename(one, names or {}) for one in recordings]
    if len(renamed) < 2:
        raise RecordingError("an arm has two joints or more: diagnose a single joint by its own recording")
    recording = join_joints(renamed)
    found = identify_arm(read_arm(simulation, recording.joints), recording, prior, progress)
    (progress or (lambda _: None))("confirming on held-out data")
    answer = confirm_terms(found, seed)
    return ArmExamination(answer, write_record(answer))


def _rename(recording: Recording, names: Mapping[str, str]) -> Recording:
    name = recording.metadata.joint
    return replace(recording, metadata=replace(recording.metadata, joint=names.get(name, name)))

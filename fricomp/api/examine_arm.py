"""`fricomp.examine_arm`: what the simulation of an arm leaves out, from a log in which all its joints move."""

import os
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from fricomp.arm import ArmExamination, ArmPrior
from fricomp.arm import examine_arm as examine_recordings
from fricomp.arm.log import ArmLog, read_arm_log
from fricomp.arm.output.choice import WrittenFiles, add_file_errors, prepare_files
from fricomp.arm.output.files import write_arm
from fricomp.errors import RecordingError
from fricomp.extras import require
from fricomp.recording import Recording
from fricomp.result_kinds import ARM
from fricomp.results import claim_folder

Source = str | os.PathLike[str]


def examine_arm(
    log: Source | Sequence[Source] | Sequence[Recording] | ArmLog,
    simulation: Source,
    *,
    names: Mapping[str, str] | None = None,
    gains: Mapping[str, float] | None = None,
    mapping: Source = "",
    channels: Mapping[str, str] | None = None,
    prior: ArmPrior | None = None,
    seed: int = 0,
    out: Source | None = None,
    overwrite: bool = False,
    progress: Callable[[str], None] | None = None,
) -> ArmExamination:
    """Say what the simulation of an arm leaves out: links, rotors and the friction of every joint.

    Torque is linear in what links weigh,

        τ = Y(q, v, a) θ + J_r a + F(q, v, τ_l),

    so that all of it is fitted together from one recording, the links shared by all joints and the simulation trusted
    as far as `prior` says. A term of friction is named where it recurs in halves of the recording and lowers the error
    on held-out data.

    Args:
        log: A bag, one table with the columns of all joints (CSV, Parquet, MAT, NPZ), a folder, or a recording of each
            joint; all from the same time, half a minute and more with all joints moving.
        simulation: MJCF or URDF of the arm, as it was shipped. Joints that were not recorded are held where it has
            them.
        names: Names in the simulation by names in the log, where they differ by more than the word joint.
        gains: Torque of one ampere by names in the log [N·m/A] or [N/A], gear included, where currents were logged.
        mapping: Mapping file, or the name of one in the package, where the names of columns do not say what they hold.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}.
        prior: How far the simulation is trusted; masses to some 20 % by default.
        seed: Of the halves; another seed draws others.
        out: Folder for the page, the record, the models and the corrected simulation; nothing is written if None.
        overwrite: Replace the arm that `out` holds already.
        progress: Called with a few words before each step.

    Raises:
        RecordingError: The log cannot be read, or is not of one arm in motion.
        SimulationFileError: The simulation cannot be read, or lacks a joint; the message has the names to write.
        IdentificationError: The motion is too short.
        OutputError: `out` holds something that is not to be replaced.
        MissingExtraError: A package is not installed; the message names the extra that brings it.
    """
    require("mujoco", extra="diagnose")
    recordings, paths = _read(
        log, Path(simulation), {"mapping": os.fspath(mapping), "channels": channels, "names": names}
    )
    settings = {"names": names, "gains": gains, "prior": prior, "seed": seed, "progress": progress}
    if out is None:
        return _examine(recordings, Path(simulation), settings)[0]
    with claim_folder(Path(out), ARM, overwrite=overwrite, inputs=(*paths, Path(simulation))) as claim:
        found, written = _examine(recordings, Path(simulation), settings)
        (progress or (lambda _: None))("writing the report")
        claim.clear()
        write_arm(found, Path(out), Path(simulation), written)
    return found


def _examine(
    recordings: Sequence[Recording], simulation: Path, settings: dict[str, Any]
) -> tuple[ArmExamination, WrittenFiles]:
    """The answer, and the files that are written with what they are worth."""
    found = examine_recordings(recordings, simulation, **settings)
    (settings["progress"] or (lambda _: None))("simulating the written files on held-out data")
    written = prepare_files(found.answer, simulation)
    return replace(found, record=add_file_errors(found.record, written)), written


def take_session(log: ArmLog) -> tuple[Recording, ...]:
    """The recordings of an arm that was recorded once.

    Raises:
        RecordingError: The log is of one joint, of joints that do not move at the same time, or of several sessions.
    """
    names = ", ".join(dict.fromkeys(one.metadata.joint for one in log.recordings))
    if len(log.sessions) > 1 and log.is_arm:
        raise RecordingError(
            f"the log has {len(log.sessions)} sessions of {names}: examine one, or compare the payloads of two by "
            "fricomp.diagnose"
        )
    if not log.is_arm:
        raise RecordingError(f"the log is not of several joints that were recorded at the same time: it has {names}")
    return log.sessions[0]


def _read(
    log: Source | Sequence[Source] | Sequence[Recording] | ArmLog, simulation: Path, settings: dict[str, Any]
) -> tuple[Sequence[Recording], list[Path]]:
    """Recordings of all joints, and the files that they are from."""
    if isinstance(log, ArmLog):
        return take_session(log), list(log.files)
    sources = [log] if isinstance(log, str | os.PathLike) else list(log)
    recordings = [one for one in sources if isinstance(one, Recording)]
    if len(recordings) == len(sources):
        return recordings, []
    paths = [os.fspath(one) for one in sources if not isinstance(one, Recording)]
    read = read_arm_log(paths, simulation=simulation, **settings)
    return take_session(read), list(read.files)

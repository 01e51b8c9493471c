"""From a log of a whole arm to a recording of each joint."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from glob import glob
from pathlib import Path

from fricomp.arm.rigid.naming import match_joints
from fricomp.arm.rigid.simulated_arm import read_arm
from fricomp.errors import RecordingError, SimulationFileError
from fricomp.recording import Recording, RecordingMetadata, convert, load_mapping, read_recording
from fricomp.recording.named.choice import INTEGRAL
from fricomp.recording.named.log import NamedLog, read_named_log, separate_joints
from fricomp.recording.named.native import is_native
from fricomp.recording.named.quantity_files import read_quantity_files
from fricomp.recording.named.sliding import slides_by_force_alone
from fricomp.recording.named.source import is_bag_folder
from fricomp.recording.sources.reader import SUFFIXES
from fricomp.simulation_file import list_joints

from .sides import join_sides, list_called

_SUFFIXES = tuple(one for one in SUFFIXES if one not in (".npy", ".bin"))
"""Of logs that say what their columns are."""

_LOOKED_AT = 20_000
"""Bytes of a text by which it is told whether it holds numbers."""
_NUMBER = re.compile(rb"\d+(?:[.,]\d+)?")

_Simulated = tuple[str | Path | None, Mapping[str, str]]
"""A simulation, and names in it by names in the log."""


@dataclass(frozen=True)
class ArmLog:
    """What was read.

    Attributes:
        sessions: Recordings of all joints, a group for each time that the arm was recorded.
        notes: What was taken for what, and what was left out, in sentences.
        files: What was read.
    """

    sessions: tuple[tuple[Recording, ...], ...]
    notes: tuple[str, ...] = ()
    files: tuple[Path, ...] = ()

    @property
    def recordings(self) -> tuple[Recording, ...]:
        """Of all sessions, one after the other."""
        return tuple(one for session in self.sessions for one in session)

    @property
    def is_arm(self) -> bool:
        """Whether every session is of several joints that move at the same time."""
        return bool(self.sessions) and all(_is_together(session) for session in self.sessions)


def read_arm_log(
    sources: Sequence[str | Path],
    *,
    mapping: str | Path = "",
    channels: Mapping[str, str] | None = None,
    simulation: str | Path | None = None,
    names: Mapping[str, str] | None = None,
) -> ArmLog:
    """Read a log of an arm: a bag, one table with the columns of all joints, or a recording of each joint.

    Args:
        sources: Files, folders, patterns. A table is CSV, Parquet, MAT, NPZ or JSON; the names of its columns say what
            they hold, such as `q_1`, `Position1`, `tau:1`, `elbow.effort`, `/joint_states/elbow/position`.
        mapping: Mapping file, or the name of one in the package, where names do not say it.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}; the name is that
            of the columns of all joints without the joint, or with `{joint}` in its place.
        simulation: Of the arm. Files that name no joint, and are each called as one of its joints (`elbow.csv`), are
            those of these joints.
        names: Names in the simulation by such names of files, where they differ by more than the word joint.

    Raises:
        RecordingError: A source cannot be read, or does not say what its columns are.
        SimulationFileError: The simulation cannot be read.
        MissingExtraError: The package that reads a format is not installed.
    """
    single: dict[Path, Recording] = {}
    tables: dict[Path, tuple[Recording, ...]] = {}
    notes: list[str] = []
    files = list_log_files(sources)
    for path in files:
        found = _read_one(path, str(mapping), dict(channels or {}), notes, (simulation, names or {}))
        if len(found) > 1:
            tables[path] = found
        elif found:
            single[path] = found[0]
    sessions = list(tables.values())
    if simulation is not None:
        single = _name_by_files(single, simulation, names or {}, notes)
        sessions = join_sides(tables, list_joints(simulation), names or {}, notes) if len(tables) > 1 else sessions
    return ArmLog((*_group(list(single.values())), *sessions), tuple(notes), tuple(files))


def list_log_files(sources: Sequence[str | Path]) -> list[Path]:
    """Files that are meant by files, folders and patterns; a bag, and a folder of one quantity a file, is one.

    Raises:
        RecordingError: A source holds none.
    """
    found: list[Path] = []
    for source in map(str, sources):
        path = Path(source)
        if path.is_dir() and not is_bag_folder(path):
            inside = sorted(one for one in path.iterdir() if one.suffix.lower() in _SUFFIXES or is_bag_folder(one))
            logs = [one for one in inside if not _holds_words(one)]
            matches = [path] if read_quantity_files(path) else logs or inside or _list_one_each(path)
        elif any(mark in source for mark in "*?[") and not path.exists():
            matches = sorted(map(Path, glob(source, recursive=True)))
        else:
            matches = [path]
        if not matches:
            below, known = _list_log_folders(path), f"one of {', '.join(_SUFFIXES)}, or a rosbag2"
            instead = f"{below[0]}, which does" if len(below) == 1 else known
            raise RecordingError(f"{source} holds no log: give {instead}")
        found += matches
    return list(dict.fromkeys(found))


def _list_log_folders(path: Path) -> list[Path]:
    """Folders right below a path that hold a log."""
    folders = [one for one in sorted(path.iterdir()) if one.is_dir()] if path.is_dir() else []
    return [one for one in folders if any(each.suffix.lower() in _SUFFIXES for each in one.iterdir())]


def _list_one_each(folder: Path) -> list[Path]:
    """The only log in each of the folders in this one; empty where one has none, or several."""
    inside = [
        [one for one in sorted(each.iterdir()) if one.suffix.lower() in _SUFFIXES and not _holds_words(one)]
        for each in sorted(folder.iterdir())
        if each.is_dir()
    ]
    return [logs[0] for logs in inside] if all(len(logs) == 1 for logs in inside) else []


def _holds_words(path: Path) -> bool:
    """Whether a text beside logs, such as a README, has hardly a line with two numbers."""
    if path.suffix.lower() != ".txt" or not path.is_file():
        return False
    with path.open("rb") as file:
        lines = [line for line in file.read(_LOOKED_AT).split(b"\n") if line.strip()]
    return 2 * sum(len(_NUMBER.findall(line)) >= 2 for line in lines) < len(lines)


def _read_one(
    path: Path, mapping: str, channels: dict[str, str], notes: list[str], simulated: _Simulated
) -> tuple[Recording, ...]:
    if mapping:
        return tuple(one.recording for one in convert(path, load_mapping(mapping)))
    if path.is_dir() and not is_bag_folder(path):
        log = separate_joints(path, read_quantity_files(path), channels)
    elif not channels and is_native(path):
        return (read_recording(path),)
    else:
        log = read_named_log(path, channels)
    if simulated[0] is not None:
        _require_positions(path, log)
    notes += log.notes
    return _turn_as_simulated(path, log, *simulated, notes)


def _require_positions(path: Path, log: NamedLog) -> None:
    """Refuse velocities alone: their integrals have no zero, and what links weigh hangs on where an arm is.

    Raises:
        RecordingError: A joint of several has no position.
    """
    without = [joint for joint, own in log.sources.items() if own["position"][0] == INTEGRAL]
    if len(log.recordings) > 1 and without:
        raise RecordingError(
            f"{path} does not say where the positions of {', '.join(without)} are, and velocities alone do not tell "
            "where an arm was: say it by --channel position=NAME, the name of such columns without their joint or "
            f"number ('fricomp convert {path} --inspect' lists them), or record them"
        )


def _turn_as_simulated(
    path: Path, log: NamedLog, simulation: str | Path | None, names: Mapping[str, str], notes: list[str]
) -> tuple[Recording, ...]:
    """The recordings of a log; those that slide by the word force alone turn where they do in the simulation."""
    joints = [one.metadata.joint for one in log.recordings]
    guessed = {joint for joint in joints if slides_by_force_alone(log.sources[joint])}
    if simulation is None or not guessed:
        return log.recordings
    try:
        arm = read_arm(simulation, joints, names)
    except SimulationFileError:  # which is told where they are joined
        return log.recordings
    turning = {joint for joint, rotary in zip(joints, arm.rotary, strict=True) if rotary} & guessed
    if turning:
        notes.append(f"{path.name}: forces of {', '.join(sorted(turning))} are torques in N·m: these joints turn.")
    return tuple(
        one.with_metadata(motion="rotary", torque_unit="N·m") if one.metadata.joint in turning else one
        for one in log.recordings
    )


def _name_by_files(
    single: dict[Path, Recording], simulation: str | Path, names: Mapping[str, str], notes: list[str]
) -> dict[Path, Recording]:
    """Recordings that name no joint, called as their files, where each file is called as a joint of the simulation."""
    stems = list_called(list(single))
    if len(single) < 2 or any(one.metadata.joint != RecordingMetadata().joint for one in single.values()):
        return single
    try:
        match_joints(stems, list_joints(simulation), names)
    except SimulationFileError:
        return single  # several recordings of one joint
    notes.append(f"Each file is taken for the joint that it is called after: {', '.join(stems)}.")
    return {
        path: replace(one, metadata=replace(one.metadata, joint=stem))
        for stem, (path, one) in zip(stems, single.items(), strict=True)
    }


def _group(recordings: Sequence[Recording]) -> list[tuple[Recording, ...]]:
    """Recordings of one joint each as sessions: a new one begins where a joint comes for another time."""
    sessions: list[list[Recording]] = []
    for one in recordings:
        if not sessions or one.metadata.joint in {other.metadata.joint for other in sessions[-1]}:
            sessions.append([])
        sessions[-1].append(one)
    return [tuple(session) for session in sessions]


def _is_together(session: Sequence[Recording]) -> bool:
    names = Counter(one.metadata.joint for one in session)
    first, last = max(one.time[0] for one in session), min(one.time[-1] for one in session)
    return len(session) > 1 and max(names.values()) == 1 and bool(first < last)

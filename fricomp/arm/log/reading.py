"""From a log of a whole arm to a recording of each joint."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from glob import glob
from pathlib import Path

from fricomp.errors import RecordingError
from fricomp.recording import Recording, convert, load_mapping, read_recording
from fricomp.recording.named.log import is_native, read_named_log, separate_joints
from fricomp.recording.named.source import is_bag_folder, read_quantity_files

__all__ = ["ArmLog", "list_log_files", "read_arm_log"]

_SUFFIXES = (".csv", ".txt", ".dat", ".tsv", ".parquet", ".pq", ".mat", ".npz", ".json", ".mcap", ".bag", ".db3")


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
    sources: Sequence[str | Path], *, mapping: str | Path = "", channels: Mapping[str, str] | None = None
) -> ArmLog:
    """Read a log of an arm: a bag, one table with the columns of all joints, or a recording of each joint.

    Args:
        sources: Files, folders, patterns. A table is CSV, Parquet, MAT, NPZ or JSON; the names of its columns say what
            they hold, such as `q_1`, `Position1`, `tau:1`, `elbow.effort`, `/joint_states/elbow/position`.
        mapping: Mapping file, or the name of one in the package, where names do not say it.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}; the name is that
            of the columns of all joints without the joint, or with `{joint}` in its place.

    Raises:
        RecordingError: A source cannot be read, or does not say what its columns are.
        MissingExtraError: The package that reads a format is not installed.
    """
    single: list[Recording] = []
    sessions: list[tuple[Recording, ...]] = []
    notes: list[str] = []
    files = list_log_files(sources)
    for path in files:
        found = _read_one(path, str(mapping), dict(channels or {}), notes)
        if len(found) > 1:
            sessions.append(found)
        else:
            single += found
    return ArmLog((*_group(single), *sessions), tuple(notes), tuple(files))


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
            matches = [path] if read_quantity_files(path) else inside
        elif any(mark in source for mark in "*?[") and not path.exists():
            matches = sorted(map(Path, glob(source, recursive=True)))
        else:
            matches = [path]
        if not matches:
            raise RecordingError(f"{source} holds no log: give one of {', '.join(_SUFFIXES)}, or a rosbag2")
        found += matches
    return list(dict.fromkeys(found))


def _read_one(path: Path, mapping: str, channels: dict[str, str], notes: list[str]) -> tuple[Recording, ...]:
    if mapping:
        return tuple(one.recording for one in convert(path, load_mapping(mapping)))
    if path.is_dir() and not is_bag_folder(path):
        log = separate_joints(path, read_quantity_files(path), channels)
    elif not channels and is_native(path):
        return (read_recording(path),)
    else:
        log = read_named_log(path, channels)
    notes += log.notes
    return log.recordings


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

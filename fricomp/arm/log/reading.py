"""From a log of a whole arm to a recording of each joint."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from glob import glob
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata, convert, load_mapping, read_recording
from fricomp.recording.unit import find_unit
from fricomp.recording.validity import drop_bad_rows

from .column import ColumnMeaning, name_joint, read_column_name, simplify_joint
from .source import is_bag_folder, read_named_columns, read_quantity_files

__all__ = ["ArmLog", "is_recording", "list_log_files", "read_arm_log"]

_SUFFIXES = (".csv", ".txt", ".dat", ".tsv", ".parquet", ".pq", ".mat", ".npz", ".json", ".mcap", ".bag", ".db3")
_TIME = re.compile(
    r"^(.*[/_.])?(t|time|times|timestamps?|stamps?|elapsed|__time)([_\s\[(]*(s|sec|ms|us|ns)[\])]?)?$", re.I
)

_TIME_UNITS = ((0.5, "s"), (500.0, "ms"), (5e5, "us"), (float("inf"), "ns"))
"""Largest median step of stamps, and the unit that they are then in: no arm is logged below 2 Hz or above 2 kHz."""


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
        return _separate(path, read_quantity_files(path), channels, notes)
    if not channels and is_recording(path):
        return (read_recording(path),)
    return _separate(path, read_named_columns(path), channels, notes)


_NATIVE = {"time", "position", "torque"}


def is_recording(path: Path) -> bool:
    """Whether a file is a recording of one joint: its columns are called as channels are, and hold one number a row."""
    if path.suffix.lower() in (".parquet", ".pq"):
        from pyarrow import ArrowException, parquet, types

        try:
            schema = parquet.read_schema(path)
        except (OSError, ArrowException):
            return True  # whose reader says what is wrong with it
        return set(schema.names) >= _NATIVE and not types.is_list(schema.field("position").type)
    if path.suffix.lower() not in (".csv", ".txt") or not path.is_file():
        return path.suffix.lower() in (".csv", ".txt")
    with path.open(encoding="utf-8-sig", errors="replace") as stream:
        lines = (line for line in stream if line.strip() and not line.startswith("#"))
        head, row = next(lines, "")[:9999], next(lines, "")[:9999]
    return {cell.strip() for cell in head.split(",")} >= _NATIVE and "[" not in row


def _separate(
    path: Path, columns: dict[str, FloatArray], channels: dict[str, str], notes: list[str]
) -> tuple[Recording, ...]:
    """One recording of each joint that has a position and a torque or a current."""
    time, clock = _take_time(path, columns)
    chosen = _choose_columns(path, columns, channels)
    joints = list(dict.fromkeys(joint for channel, joint in chosen if channel == "position"))
    complete = [j for j in joints if ("torque", j) in chosen or ("current", j) in chosen]
    if not complete:
        what = "a position and a torque" if not joints else "the torque"
        raise RecordingError(
            f"{path} does not say where {what} of a joint is: its columns are {_list_names(columns)}. Name them such "
            "as q_1 and tau_1, say it by --channel torque=NAME, or give a --mapping (docs/recordings.md)"
        )
    silent = [chosen["position", j][1].joint for j in joints if j not in complete]
    if silent:
        notes.append(
            f"{path.name} has no torque of {', '.join(map(name_joint, silent))}: held as the simulation has it."
        )
    read = tuple(_build(path, joint, time, columns, chosen, notes) for joint in complete)
    notes.append(_say_columns(path, complete, chosen, clock))
    return read


def _take_time(path: Path, columns: dict[str, FloatArray]) -> tuple[FloatArray, str]:
    """Time of the rows from the first one [s], and what it was read from."""
    names = [name for name in columns if _TIME.match(name)]
    names.sort(key=lambda name: (len(name), name))
    if not names:
        raise RecordingError(
            f"{path} has no column of time: its columns are {_list_names(columns)}. Call it time [s], or give a "
            "--mapping with time = { rate = ROWS_A_SECOND }"
        )
    time = columns[names[0]]
    finite = time[np.isfinite(time)]
    if finite.size < 2:
        raise RecordingError(f"{path}: the column {names[0]!r} holds no times")
    said = re.search(r"(ms|us|ns)[\])]?$", names[0], re.IGNORECASE)
    step = float(np.median(np.abs(np.diff(finite))))
    unit = said.group(1).lower() if said else next(one for most, one in _TIME_UNITS if step < most)
    return np.asarray((time - finite[0]) * find_unit(unit).factor), f"time {names[0]!r} in {unit}"


Chosen = dict[tuple[str, str], tuple[str, ColumnMeaning]]
"""Column and its meaning, by channel and joint."""


def _choose_columns(path: Path, columns: dict[str, FloatArray], channels: dict[str, str]) -> Chosen:
    candidates: dict[tuple[str, str], list[tuple[str, ColumnMeaning]]] = {}
    asked = {name: meaning for name in columns for meaning in [_match_asked(name, channels)] if meaning}
    for name in columns:
        meaning = asked.get(name) or read_column_name(name)
        if meaning is None or (meaning.channel in channels and name not in asked):
            continue
        candidates.setdefault((meaning.channel, simplify_joint(meaning.joint)), []).append((name, meaning))
    chosen = {}
    for (channel, joint), found in candidates.items():
        most = max(meaning.certainty for _, meaning in found)
        best = [one for one in found if one[1].certainty == most]
        if len(best) > 1 and channel in ("position", "torque") and joint:
            raise RecordingError(
                f"{path}: {' and '.join(repr(name) for name, _ in best)} could each be the {channel} of joint "
                f"{name_joint(best[0][1].joint)}: choose by --channel {channel}=NAME"
            )
        chosen[channel, joint] = best[0]
    missing = sorted(set(channels) - {channel for channel, _ in chosen})
    if missing:
        raise RecordingError(
            f"{path} has no column {channels[missing[0]]!r} for --channel {missing[0]}: it has {_list_names(columns)}"
        )
    return {key: one for key, one in chosen.items() if key[1]}


def _match_asked(name: str, channels: dict[str, str]) -> ColumnMeaning | None:
    """What a column is by what the user said of it."""
    for channel, wanted in channels.items():
        pattern = re.escape(wanted).replace(re.escape("{joint}"), "(.+)")
        pattern = pattern if "{joint}" in wanted else f"{pattern}[:_.\\[]?(\\d+)\\]?"
        match = re.fullmatch(pattern, name)
        if match:
            meaning = read_column_name(name)
            return ColumnMeaning(channel, match.group(1), 3, meaning.unit if meaning else "")
    return None


def _build(
    path: Path, joint: str, time: FloatArray, columns: dict[str, FloatArray], chosen: Chosen, notes: list[str]
) -> Recording:
    own = {channel: one for (channel, j), one in chosen.items() if j == joint}
    name = name_joint(own["position"][1].joint)
    unit = "N·m"
    if "torque" not in own:
        own["torque"], unit = own["current"], "A"
    elif find_unit(own["torque"][1].unit or "N·m").si == "A":
        unit = "A"
    table = {"time": time}
    for channel, (column, meaning) in own.items():
        found = find_unit(meaning.unit) if meaning.unit else None
        values = columns[column]
        if values.size != time.size:
            raise RecordingError(f"{path}: {column!r} has {values.size} rows, and the time {time.size}")
        table[channel] = values * found.factor + found.offset if found else values
    usable, findings = drop_bad_rows(_leave_out_empty(table))
    notes += [f"{path.name}, {name}: {finding.message}." for finding in findings]
    metadata = RecordingMetadata(joint=name, torque_unit=unit, source=path.name)
    return Recording.from_channels(usable, metadata)


def _leave_out_empty(table: dict[str, FloatArray]) -> dict[str, FloatArray]:
    """Channels that are needed, and the others where they have a number in nearly every row with a position."""
    said = np.isfinite(table["position"]) & np.isfinite(table["torque"])
    needed = ("time", "position", "torque")
    return {
        name: values[said]
        for name, values in table.items()
        if name in needed or np.count_nonzero(np.isfinite(values[said])) > 0.99 * np.count_nonzero(said)
    }


def _say_columns(path: Path, joints: Sequence[str], chosen: Chosen, clock: str) -> str:
    first = {channel: column for (channel, joint), (column, _) in chosen.items() if joint == joints[0]}
    names = ", ".join(f"{channel} {column!r}" for channel, column in first.items())
    return f"{path.name}: {len(joints)} joints, {clock}; of the first, {names}."


def _list_names(columns: Mapping[str, FloatArray]) -> str:
    return ", ".join(list(columns)[:20]) + (" …" if len(columns) > 20 else "")


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

"""From the named columns of a log to a recording of each joint in it."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.finding import Finding
from fricomp.recording.metadata import RecordingMetadata
from fricomp.recording.recording import CHANNELS, Recording
from fricomp.recording.stamps import with_row_rate
from fricomp.recording.unit import find_unit
from fricomp.recording.validity import Samples, drop_bad_rows

from .column import RAW_UNIT, ColumnMeaning, name_joint, read_column_name, simplify_joint
from .source import read_first_lines, read_named_columns

__all__ = ["NamedLog", "is_native", "read_named_log", "separate_joints"]

_TIME = re.compile(
    r"^(.*[/_.])?(t|time|times|timestamps?|stamps?|elapsed|__time)([_\s\[(]*(s|sec|ms|us|ns)[\])]?)?$", re.I
)

_TIME_UNITS = ((0.5, "s"), (500.0, "ms"), (5e5, "us"), (float("inf"), "ns"))
"""Largest median step of stamps, and the unit that they are then in: no arm is logged below 2 Hz or above 2 kHz."""


@dataclass(frozen=True)
class NamedLog:
    """What was read by names.

    Attributes:
        recordings: One a joint.
        sources: Column of each channel, by the joint's name in its recording; `time` is of all.
        notes: What was taken for what, and what was left out, in sentences.
        findings: Of all joints' rows.
    """

    recordings: tuple[Recording, ...]
    sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]]
    notes: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()


Chosen = dict[tuple[str, str], tuple[str, ColumnMeaning]]
"""Column and its meaning, by channel and by what is left of the column's name for the joint."""


def is_native(path: Path) -> bool:
    """Whether a file is a recording of one joint: its columns are called as channels are, and hold one number a row."""
    if path.suffix.lower() in (".parquet", ".pq"):
        return _is_native_parquet(path)
    if path.suffix.lower() not in (".csv", ".txt") or not path.is_file():
        return path.suffix.lower() in (".csv", ".txt")
    lines = read_first_lines(path, 2)
    if lines.states_schema or not lines.rows:
        return True
    cells = {cell.strip() for cell in lines.rows[0].split(",")}
    return cells <= set(CHANNELS) and not any("[" in row for row in lines.rows[1:])


def _is_native_parquet(path: Path) -> bool:
    from pyarrow import ArrowException, parquet, types

    try:
        schema = parquet.read_schema(path)
    except (OSError, ArrowException):
        return True  # whose reader says what is wrong with it
    return set(schema.names) <= set(CHANNELS) and not any(types.is_list(field.type) for field in schema)


def read_named_log(path: Path, channels: Mapping[str, str] | None = None, *, row_rate: float | None = None) -> NamedLog:
    """A recording of each joint in a file whose columns say what they hold.

    Args:
        path: CSV or text with a line of names, Parquet, MAT, NPZ, JSON, MCAP or a bag.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.

    Raises:
        RecordingError: The file cannot be read, or does not say what its columns are.
        MissingExtraError: The package that reads the format is not installed.
    """
    columns = read_named_columns(path)
    if row_rate is not None:
        stamps = [name for name in columns if _TIME.match(name)]
        columns = with_row_rate({name: values for name, values in columns.items() if name not in stamps}, row_rate)
    return separate_joints(path, columns, channels or {})


def separate_joints(path: Path, columns: Mapping[str, Samples], channels: Mapping[str, str]) -> NamedLog:
    """One recording of each joint that has a position and a torque or a current.

    Args:
        path: Of the file, for messages.
        columns: All columns by name; shape (n_rows,) each.
        channels: As for `read_named_log`.

    Raises:
        RecordingError: The columns do not say where time, position or torque is.
    """
    time_name, unit, time = _take_time(path, columns)
    chosen = _choose_columns(path, columns, channels)
    joints = list(dict.fromkeys(joint for channel, joint in chosen if channel == "position"))
    complete = [j for j in joints if ("torque", j) in chosen or ("current", j) in chosen]
    if not complete:
        what = "a position and a torque" if not joints else "the torque"
        raise RecordingError(
            f"{path} does not say where {what} of a joint is: its columns are {_list_names(columns)}. Name them such "
            "as q_1 and tau_1, say it by --channel torque=NAME, or give a --mapping (docs/recordings.md)"
        )
    notes: list[str] = []
    silent = [chosen["position", j][1].joint for j in joints if j not in complete]
    if silent:
        notes.append(
            f"{path.name} has no torque of {', '.join(map(name_joint, silent))}: held as the simulation has it."
        )
    recordings: list[Recording] = []
    sources: dict[str, Mapping[str, tuple[str, ColumnMeaning]]] = {}
    findings: list[Finding] = []
    for joint in complete:
        own = {channel: one for (channel, j), one in chosen.items() if j == joint}
        recording, found = _build(path, time, columns, own)
        notes += [f"{path.name}, {recording.metadata.joint}: {finding.message}." for finding in found]
        findings += found
        recordings.append(recording)
        sources[recording.metadata.joint] = {"time": (time_name, ColumnMeaning("time", "", 0, unit)), **own}
    notes.append(_say_columns(path, recordings, sources))
    return NamedLog(tuple(recordings), sources, tuple(notes), tuple(findings))


def _take_time(path: Path, columns: Mapping[str, Samples]) -> tuple[str, str, Samples]:
    """The column of time, its unit, and the time of the rows from the first one [s]."""
    names = sorted((name for name in columns if _TIME.match(name)), key=lambda name: (len(name), name))
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
    return names[0], unit, np.asarray((time - finite[0]) * find_unit(unit).factor)


def _choose_columns(path: Path, columns: Mapping[str, Samples], channels: Mapping[str, str]) -> Chosen:
    """The column of each channel of each joint; of one joint alone the columns may name none."""
    candidates: dict[tuple[str, str], list[tuple[str, ColumnMeaning]]] = {}
    asked = {name: meaning for name in columns for meaning in [_match_asked(name, channels)] if meaning}
    for name in columns:
        meaning = asked.get(name) or read_column_name(name)
        if meaning is None or (meaning.channel in channels and name not in asked):
            continue
        candidates.setdefault((meaning.channel, simplify_joint(meaning.joint)), []).append((name, meaning))
    missing = sorted(set(channels) - {channel for channel, _ in candidates})
    if missing:
        raise RecordingError(
            f"{path} has no column {channels[missing[0]]!r} for --channel {missing[0]}: it has {_list_names(columns)}"
        )
    alone = not any(joint for channel, joint in candidates if channel == "position")
    wanted = {key: found for key, found in candidates.items() if alone == (not key[1])}
    return {(channel, joint): _choose_one(path, channel, found) for (channel, joint), found in wanted.items()}


def _choose_one(path: Path, channel: str, found: Sequence[tuple[str, ColumnMeaning]]) -> tuple[str, ColumnMeaning]:
    """The column that says the most surely that it was measured."""
    most = max(meaning.certainty for _, meaning in found)
    best = [one for one in found if one[1].certainty == most]
    if len(best) > 1 and channel in ("position", "torque"):
        joint = best[0][1].joint
        whose = f" of joint {name_joint(joint)}" if joint else ""
        raise RecordingError(
            f"{path}: {' and '.join(repr(name) for name, _ in best)} could each be the {channel}{whose}: choose by "
            f"--channel {channel}=NAME"
        )
    return best[0]


def _match_asked(name: str, channels: Mapping[str, str]) -> ColumnMeaning | None:
    """What a column is by what the user said of it."""
    for channel, wanted in channels.items():
        pattern = re.escape(wanted).replace(re.escape("{joint}"), "(.+)")
        pattern = pattern if "{joint}" in wanted else f"{pattern}(?:[:_.\\[]?(\\d+)\\]?)?"
        match = re.fullmatch(pattern, name)
        if match:
            meaning = read_column_name(name)
            return ColumnMeaning(channel, match.group(1) or "", 3, meaning.unit if meaning else "")
    return None


def _build(
    path: Path, time: Samples, columns: Mapping[str, Samples], own: dict[str, tuple[str, ColumnMeaning]]
) -> tuple[Recording, tuple[Finding, ...]]:
    """The recording of a joint, and what is said of its rows; a current stands in for a torque that is not there."""
    joint, linear = own["position"][1].joint, _is_linear(own)
    unit = "N" if linear else "N·m"
    if "torque" not in own:
        own["torque"], unit = own["current"], "A"
    elif own["torque"][1].unit in ("A", "mA"):
        unit = "A"
    table = {"time": time}
    for channel, (column, meaning) in own.items():
        if meaning.unit == RAW_UNIT:
            raise RecordingError(
                f"{path}: {column!r} is in units of a device: say in a mapping what one is worth, such as "
                f"{channel} = {{ column = {column!r}, scale = 1e-3 }}"
            )
        found = find_unit(meaning.unit) if meaning.unit else None
        values = columns[column]
        if values.size != time.size:
            raise RecordingError(f"{path}: {column!r} has {values.size} rows, and the time {time.size}")
        table[channel] = values * found.factor + found.offset if found else values
    usable, findings = drop_bad_rows(_leave_out_empty(table))
    if usable["time"].size < 2:
        raise RecordingError(
            f"{path}: {findings[0].message}; say --row-rate to fricomp convert where stamps are held or missing"
        )
    metadata = RecordingMetadata(
        joint=name_joint(joint) if joint else RecordingMetadata().joint,
        motion="linear" if linear else "rotary",
        torque_unit=unit,
        source=path.name,
    )
    return Recording.from_channels(usable, metadata), findings


def _is_linear(own: Mapping[str, tuple[str, ColumnMeaning]]) -> bool:
    """Whether the joint slides: its position is in metres, or what moves it is a force."""
    said = {channel: meaning.unit for channel, (_, meaning) in own.items() if meaning.unit not in ("", RAW_UNIT)}
    stated = {channel: find_unit(unit).si for channel, unit in said.items()}
    return stated.get("position") == "m" or stated.get("torque") == "N"


def _leave_out_empty(table: dict[str, Samples]) -> dict[str, Samples]:
    """Channels that are needed, and the others where they have a number in nearly every row with a position."""
    said = np.isfinite(table["position"]) & np.isfinite(table["torque"])
    needed = ("time", "position", "torque")
    return {
        name: values[said]
        for name, values in table.items()
        if name in needed or np.count_nonzero(np.isfinite(values[said])) > 0.99 * np.count_nonzero(said)
    }


def _say_columns(
    path: Path, recordings: Sequence[Recording], sources: Mapping[str, Mapping[str, tuple[str, ColumnMeaning]]]
) -> str:
    """One sentence on what was taken for what, with the units that names state."""
    first = recordings[0]
    said = [
        f"{channel} {column!r}" + (f" in {meaning.unit}" if meaning.unit else "")
        for channel, (column, meaning) in sources[first.metadata.joint].items()
        if channel in first.channels
    ]
    whose = f"{len(recordings)} joints; of the first, " if len(recordings) > 1 else "by the names of its columns, "
    return f"{path.name}: {whose}{', '.join(said)}."


def _list_names(columns: Mapping[str, Samples]) -> str:
    return ", ".join(list(columns)[:20]) + (" …" if len(columns) > 20 else "")

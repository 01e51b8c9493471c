"""Recordings on disk: the suffix of the path decides between CSV and Parquet."""

from __future__ import annotations

import itertools
import os
import shlex
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.checks import CheckedRecording, check_recording
from fricomp.recording.csv_file import FileContent, read_csv, write_csv
from fricomp.recording.finding import Finding, RecordingWarning, raise_errors
from fricomp.recording.metadata import RecordingMetadata
from fricomp.recording.named.joints.joint_name import select_joint
from fricomp.recording.named.log import NamedLog, read_named_log
from fricomp.recording.named.native import is_native
from fricomp.recording.named.quantity_files import is_log_folder
from fricomp.recording.named.source import read_first_lines
from fricomp.recording.parquet_file import read_parquet, write_parquet
from fricomp.recording.recording import Recording
from fricomp.recording.sources.text import read_lines
from fricomp.recording.sources.text_line import is_comment

if TYPE_CHECKING:
    from pandas import DataFrame

_CSV = (".csv", ".txt")
_RESTS = 0.01
"""Part of the largest travel of a log's joints below which one holds still."""
_PARQUET = (".parquet", ".pq")


def write_recording(recording: Recording, path: str | Path) -> None:
    """Write a recording as CSV or Parquet; the file appears whole or not at all.

    Raises:
        RecordingError: The suffix is unknown, or the file cannot be written.
        MissingExtraError: Parquet is asked for and pyarrow is not installed.
    """
    if not isinstance(recording, Recording):
        raise RecordingError(
            f"{type(recording).__name__} is no recording: make one by Recording.from_pandas, or give a Recording"
        )
    target = Path(path)
    if _suffix(target) in _PARQUET:
        write_parquet(recording, target)
    else:
        write_csv(recording, target)


def read_recording(
    path: str | Path,
    *,
    channels: Mapping[str, str] | None = None,
    joint: str | None = None,
    simulated: Sequence[str] = (),
) -> Recording:
    """Read a recording: a CSV or Parquet file of the project's own, or the log of one joint whose columns have names.

    Of such a log (CSV, Parquet, MAT, NPZ, JSON, MCAP, a bag) names such as `t_ms`, `q_deg` and `tau` say what the
    columns hold; a warning tells what was taken for what.

    Warns with `RecordingWarning` when the file ends in an unfinished line.
    `check_recording` looks for what may mislead: units, signs, gaps, wraps.

    Args:
        path: File, or the folder of a bag.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}.
        joint: Which one of a log of several; the recording is called so.
        simulated: As for `read_content`.

    Raises:
        RecordingError: The file is missing, damaged, or its samples cannot be used; the
            message names row, column and what to do.
        MissingExtraError: The file is Parquet and pyarrow is not installed.
    """
    content = read_content(_require_path(path), channels=channels, joint=joint, simulated=simulated)
    for finding in content.findings:
        warnings.warn(f"{path}: {finding}", RecordingWarning, stacklevel=2)
    return content.recording


def _require_path(path: object) -> Path:
    """The path that was given; anything else is refused.

    Raises:
        RecordingError: It is no path.
    """
    if isinstance(path, str | os.PathLike):
        return Path(path)
    raise RecordingError(
        f"{type(path).__name__} is no path of a recording: give that of a file or of a bag's folder; "
        "Recording.from_pandas makes a recording of a data frame"
    )


def read_checked(path: str | Path) -> CheckedRecording:
    """Read a recording and check it.

    Raises:
        RecordingError: The file is missing, damaged, or its samples cannot be used.
        MissingExtraError: The file is Parquet and pyarrow is not installed.
    """
    content = read_content(Path(path))
    return CheckedRecording(content.recording, content.findings + check_recording(content.recording))


def read_content(
    path: Path,
    *,
    skip_bad_rows: bool = False,
    row_rate: float | None = None,
    channels: Mapping[str, str] | None = None,
    joint: str | None = None,
    simulated: Sequence[str] = (),
) -> FileContent:
    """Read a recording with what was wrong with its file; nothing is warned about.

    Args:
        path: File.
        skip_bad_rows: Leave out rows without a finite number in every column or with a time that does not advance;
            a finding says how many.
        row_rate: Rows a second in place of the stamps [Hz]; None takes the stamps.
        channels: Column by channel where several could be one, such as {"torque": "tau_measured"}.
        joint: Which one of a log of several.
        simulated: Names of all joints of the simulation that has it: where these count from one, so does the log.

    Raises:
        RecordingError: As for `read_recording`.
        MissingExtraError: The file is Parquet and pyarrow is not installed.
    """
    if not path.exists():
        raise RecordingError(f"no recording at {path}: check the path")
    if path.is_dir() and not is_log_folder(path):
        raise RecordingError(f"{path} is a folder: name the recording inside it")
    if channels or not is_own(path):
        asked = (joint, simulated)
        return _read_named(path, channels or {}, asked, skip_bad_rows=skip_bad_rows, row_rate=row_rate)
    if path.suffix.lower() in _PARQUET:
        return _call_as_asked(
            path, read_parquet(path, skip_bad_rows=skip_bad_rows, row_rate=row_rate), joint, simulated
        )
    try:
        content = read_csv(path, skip_bad_rows=skip_bad_rows, row_rate=row_rate)
    except RecordingError:
        if skip_bad_rows or row_rate is not None or read_first_lines(path, 0).states_schema:
            raise
        return _read_leniently(path, (joint, simulated))
    return _call_as_asked(path, content, joint, simulated)


def _call_as_asked(path: Path, content: FileContent, joint: str | None, simulated: Sequence[str]) -> FileContent:
    """A recording that says of no joint whose it is gets the name that is asked for; of another joint it is refused.

    Which joint of a simulation it is says whoever names that, whatever the recording calls it.

    Raises:
        RecordingError: It is of another joint.
    """
    called = content.recording.metadata.joint
    if joint is None or simulated or called == joint:
        return content
    if select_joint([called], joint) is None:
        raise RecordingError(
            f"{path} is the recording of joint {called!r}, not of {joint!r}: leave out --joint, or give that name"
        )
    return content._replace(recording=content.recording.with_metadata(joint=joint))


def _read_leniently(path: Path, asked: tuple[str | None, Sequence[str]]) -> FileContent:
    """A log whose columns happen to be called as channels are, with words or runs between its rows; or why not.

    Raises:
        RecordingError: It cannot be read in this way either: what the strict reading says of it.
    """
    lines = [line for line in read_lines(path) if line.strip()]
    states_facts = any(":" in line for line in itertools.takewhile(is_comment, lines))
    if states_facts or len({line.count(",") for line in lines if not is_comment(line)}) > 1:
        return read_csv(path)
    try:
        return _read_named(path, {}, asked, skip_bad_rows=False, row_rate=None)
    except RecordingError:
        return read_csv(path)


def is_own(path: Path) -> bool:
    """Whether a file is of the project's own form, or is not there; else the names of its columns say what it holds."""
    return not path.exists() or (path.is_file() and path.suffix.lower() in _CSV + _PARQUET and is_native(path))


def _read_named(
    path: Path,
    channels: Mapping[str, str],
    asked: tuple[str | None, Sequence[str]],
    *,
    skip_bad_rows: bool,
    row_rate: float | None,
) -> FileContent:
    """The one joint of a log whose columns say by their names what they hold.

    Args:
        path: Of the log.
        channels: As for `read_content`.
        asked: Name of the joint, None where it was not said, and names of all joints of the simulation.
        skip_bad_rows: As for `read_content`.
        row_rate: As for `read_content`.
    """
    log = read_named_log(path, channels, row_rate=row_rate)
    joint, simulated = asked
    found, note = _select_moving(path, log) if joint is None else _select_joint(path, log, joint, simulated)
    notes = [*log.notes, note] if note else log.notes
    if not skip_bad_rows:
        raise_errors(log.findings, str(path))
    advice = "if it is wrong, 'fricomp convert LOG --inspect' writes a mapping to edit"
    notes = [note for note in notes if not any(found.message in note for found in log.findings)]  # told below
    bare = [note.removeprefix(f"{path.name}: ").rstrip(".") for note in notes]  # whoever tells it names the file
    told = tuple(Finding("named_columns", "note", note, advice) for note in bare)
    return FileContent(found, (*told, *log.findings))


def _select_moving(path: Path, log: NamedLog) -> tuple[Recording, str]:
    """The only joint of a log, or the only one that moves, and what is said of that.

    Raises:
        RecordingError: Several move.
    """
    if len(log.recordings) == 1:
        return log.recordings[0], ""
    moving = _list_moving(log)
    if len(moving) != 1:
        raise RecordingError(_list_joints(path, log))
    (name,) = moving
    found = next(one for one in log.recordings if one.metadata.joint == name)
    return found, f"{path.name}: of {len(log.recordings)} joints {name} alone moves, and was taken"


def _list_moving(log: NamedLog) -> list[str]:
    """The joints of a log that do not rest while another one moves."""
    ways = {one.metadata.joint: float(np.ptp(one.position)) for one in log.recordings}
    return [name for name, way in ways.items() if way > _RESTS * max(ways.values())]


def _select_joint(path: Path, log: NamedLog, wanted: str, simulated: Sequence[str]) -> tuple[Recording, str]:
    """The joint that is meant, called as it is wanted, and what is said where the log calls it otherwise.

    Raises:
        RecordingError: None is, or several could be.
    """
    recordings = {one.metadata.joint: one for one in log.recordings}
    name = select_joint(list(recordings), wanted, simulated)
    if name is None and len(recordings) == 1:
        (other,) = recordings
        own = {
            channel: column for channel, (column, _) in log.sources[other].items() if channel in ("position", "torque")
        }
        said = " ".join(f"--channel {shlex.quote(f'{channel}={column}')}" for channel, column in own.items() if column)
        raise RecordingError(f"{path} is the log of joint {other!r}: where that is {wanted!r}, say so by {said}")
    if name is None:
        raise RecordingError(_list_joints(path, log, wanted, in_simulation=bool(simulated)))
    found = recordings[name].with_metadata(joint=wanted)
    is_plain = name in (wanted, RecordingMetadata().joint)
    return found, "" if is_plain else f"{path.name}: its joint {name!r} was taken for {wanted!r}"


def _list_joints(path: Path, log: NamedLog, wanted: str = "", *, in_simulation: bool = False) -> str:
    """What a log of several joints holds, and how one of them is taken."""
    names, moving = [one.metadata.joint for one in log.recordings], _list_moving(log)
    option, name, rest = ("--match", "LOGGED", f"={wanted}") if in_simulation else ("--joint", "NAME", "")
    such = f", such as {option} {moving[0]}{rest}, which alone moves" if wanted and len(moving) == 1 else ""
    none = f", none of them clearly {wanted!r}" if wanted else ""
    arm = "say which is by" if in_simulation else "give the --simulation of their arm, or take one by"
    return f"{path} is the log of {len(names)} joints, {', '.join(names)}{none}: {arm} {option} {name}{rest}{such}"


def _suffix(path: Path) -> str:
    suffix = path.suffix.lower()
    if suffix not in _CSV + _PARQUET:
        raise RecordingError(
            f"{path.name!r} says no format that a recording is written in: give a name that ends in "
            f"{', '.join(_CSV + _PARQUET[:1])} or {_PARQUET[1]}"
        )
    return suffix


def take_recording(given: Recording | DataFrame | str | os.PathLike[str]) -> Recording | Path:
    """The recording that was given, or the path of its file.

    Args:
        given: A recording, a data frame with its channels in SI units, or a path.

    Raises:
        RecordingError: It is something else, or the frame lacks a channel.
    """
    if isinstance(given, Recording):
        return given
    if isinstance(given, str | os.PathLike):
        return Path(given)
    if is_frame(given):
        return Recording.from_pandas(given)
    raise RecordingError(
        f"{type(given).__name__} is no recording: give a Recording, a data frame with the columns time, position and "
        "torque, or the path of a file"
    )


def is_frame(given: object) -> bool:
    """Whether it is a data frame of pandas, which need not be installed."""
    return hasattr(given, "columns") and hasattr(given, "iloc") and hasattr(given, "attrs")


def is_motion(given: object) -> bool:
    """Whether it is a data frame whose rows are a motion over time, and not points of friction."""
    return is_frame(given) and {"position", "torque"} <= set(given.columns)  # type: ignore[attr-defined]

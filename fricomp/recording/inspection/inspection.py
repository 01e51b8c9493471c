"""What a log seems to hold: each column, what it is taken for and why, and what speaks against it."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.checks import check_recording
from fricomp.recording.file import is_own, read_content
from fricomp.recording.finding import Finding
from fricomp.recording.named.choice import TORQUES
from fricomp.recording.named.column import RAW_UNIT, ColumnMeaning, read_column_name, read_column_unit
from fricomp.recording.named.device_unit import are_counts
from fricomp.recording.named.head_fact import read_head_facts
from fricomp.recording.named.log import NamedLog, separate_joints
from fricomp.recording.named.quantity_files import read_quantity_files
from fricomp.recording.named.source import (
    has_rows,
    is_bag_folder,
    read_named_columns,
    read_unnamed_columns,
)
from fricomp.recording.named.times.clock import find_stamps
from fricomp.recording.quantity_word import says_asked_for
from fricomp.recording.recording import Recording
from fricomp.recording.sources import is_text
from fricomp.recording.sources.simulation_text import refuse_simulation
from fricomp.recording.unit_word import UNKNOWN_UNIT, find_unit_words, kind_of_unit
from fricomp.recording.validity import Samples

from .unnamed import Guess, GuessedJoint, guess_columns, render_guess


@dataclass(frozen=True)
class InspectedColumn:
    """One column of a log.

    Attributes:
        name: As the file has it.
        rows: Numbers in it that are finite.
        lowest: The smallest of them, as the file has it.
        highest: The largest.
        taken_for: Channel and joint, or empty where it is left out.
        why: In words.
    """

    name: str
    rows: int
    lowest: float
    highest: float
    taken_for: str
    why: str


@dataclass(frozen=True)
class Inspection:
    """What was seen in a log.

    Attributes:
        columns: All of numbers, in the order of the file.
        log: Recordings by names; None where the names do not say enough.
        refusal: Why, then; else empty.
        findings: What the checks say of each recording, by the name of the joint.
        guess: A mapping to edit where the names do not say enough, by what the numbers do.
    """

    columns: tuple[InspectedColumn, ...]
    log: NamedLog | None
    refusal: str
    findings: Mapping[str, tuple[Finding, ...]]
    guess: str = ""


def inspect_log(path: Path, channels: Mapping[str, str] | None = None) -> Inspection:
    """Look at a log without converting it.

    Args:
        path: As for `read_named_log`.
        channels: Column by channel where several could be one.

    Raises:
        RecordingError: The file cannot be read, or its columns have no names.
        MissingExtraError: The package that reads the format is not installed.
    """
    refuse_simulation(path)
    columns, log, refusal, numbered = *_read_columns(path), False
    if not refusal:
        try:
            log = _with_facts_of_file(path, separate_joints(path, columns, channels or {}))
        except RecordingError as error:
            refusal = str(error)
    else:
        numbered = True
    taken: dict[str, list[tuple[str, ColumnMeaning]]] = {}
    for joint, sources in log.sources.items() if log is not None else ():
        for channel, (name, meaning) in sources.items():
            taken.setdefault(name, []).append((channel if channel == "time" else f"{channel} of {joint}", meaning))
    left = _explain_left if log is not None else _explain_unread
    seen = tuple(_look_at(name, values, taken.get(name, []), left(name)) for name, values in columns.items())
    recordings = log.recordings if log is not None else ()
    findings = {one.metadata.joint: check_recording(one) for one in recordings}
    guess = _propose(path, columns, numbered=numbered) if log is None else ""
    return Inspection(seen, log, refusal, findings, guess)


def _with_facts_of_file(path: Path, log: NamedLog) -> NamedLog:
    """The log with what a recording of the project's own form says of itself above its rows: joint, encoder, gear."""
    if path.is_dir() or not is_own(path) or len(log.recordings) != 1:
        return log
    try:
        metadata = read_content(path).recording.metadata
    except RecordingError:
        return log
    (recording,) = log.recordings
    sources = {metadata.joint: log.sources[recording.metadata.joint]}
    own = Recording.from_channels(dict(recording.channels), metadata)
    return replace(log, recordings=(own,), sources=sources)


def _read_columns(path: Path) -> tuple[dict[str, Samples], NamedLog | None, str]:
    """All columns of a log, none of its joints yet, and why names say nothing: a text has none."""
    if path.is_dir() and not is_bag_folder(path):
        columns = read_quantity_files(path)
        if not columns:
            raise RecordingError(
                f"{path} is a folder: name the log inside of it (a folder is one log where it holds a bag, or a file a "
                "quantity, such as q.txt, tau.txt and time.txt)"
            )
        return columns, None, ""
    try:
        return read_named_columns(path), None, ""
    except RecordingError as error:
        if not (path.is_file() and is_text(path)) or not has_rows(path):
            raise
        return read_unnamed_columns(path), None, str(error)


def _propose(path: Path, columns: Mapping[str, Samples], *, numbered: bool) -> str:
    """A mapping to edit, by what the names say and, where they do not, by what the numbers do.

    What a joint was asked for is never proposed as what was measured.
    """
    meanings = {name: read_column_name(name) for name in columns}
    left = {name: values for name, values in columns.items() if not says_asked_for(name)}
    rate = read_head_facts(path).get("rate")
    guess = _prefer_named(guess_columns(left, _list_others(left), rate.value if rate is not None else 0.0), meanings)
    counted = [name for name, values in left.items() if are_counts(name, values)]
    return render_guess(path, guess, numbered=numbered, counted=counted, columns=columns)


def _prefer_named(guess: Guess, meanings: Mapping[str, ColumnMeaning | None]) -> Guess:
    """The guess with the joint that the names say, where one column is called position and one torque.

    Where none is called a torque, and the numbers show no joint, with the position alone.
    """
    called = {
        channel: [name for name, one in meanings.items() if one is not None and one.channel == channel]
        for channel in ("position", "motor_position", "velocity", *TORQUES)
    }
    position = called["position"] or called["motor_position"]
    torque = next((called[one] for one in TORQUES if called[one]), [])
    if len(torque) == 1 and len(guess.joints) == 1 and not guess.joints[0].torque:
        return guess._replace(joints=(guess.joints[0]._replace(torque=torque[0]),))
    if len(position) != 1 or len(torque) > 1 or (guess.joints and not torque):
        return guess
    velocity = called["velocity"][0] if len(called["velocity"]) == 1 else ""
    return guess._replace(joints=(GuessedJoint(position[0], velocity, next(iter(torque), ""), 1.0),))


def _list_others(columns: Mapping[str, Samples]) -> list[str]:
    """Columns whose names say that they hold something else than a torque."""
    meanings = {name: read_column_name(name) for name in columns}
    kinds = {name: kind_of_unit(said[0].unit) for name in columns if (said := find_unit_words(name, -1))}
    stated = [name for name, kind in kinds.items() if kind not in ("", "torque", "current", "voltage")]
    return [*stated, *(name for name, one in meanings.items() if one is not None and one.channel not in TORQUES)]


def _look_at(name: str, values: Samples, taken: list[tuple[str, ColumnMeaning]], left: str) -> InspectedColumn:
    finite = values[np.isfinite(values)]
    lowest, highest = (float(finite.min()), float(finite.max())) if finite.size else (float("nan"), float("nan"))
    channels = list(dict.fromkeys(channel for channel, _ in taken))
    taken_for = "time" if "time" in channels else "; ".join(channels)
    why = _explain_taken(taken_for, taken[0][1]) if taken else left
    return InspectedColumn(name, finite.size, lowest, highest, taken_for, why)


def _explain_taken(taken_for: str, meaning: ColumnMeaning) -> str:
    """Why a column is taken for what it is."""
    if taken_for == "time":
        return f"called as a time; in {meaning.unit}, by its name or by the step from row to row"
    return f"in {meaning.unit}" if meaning.unit else "in the unit of SI, as no other is named"


def _explain_unread(name: str) -> str:
    """What the name of a column says by itself, where the log as a whole was not read."""
    if find_stamps([name]):
        return "called as a time"
    meaning = read_column_name(name) or read_column_unit(name)
    if meaning is None:
        return "no word of its name is a quantity"
    asked = {RAW_UNIT: ", in units of a device", UNKNOWN_UNIT: ", in a unit that is not known"}
    return f"its name says {meaning.channel}{asked.get(meaning.unit, f' in {meaning.unit}' if meaning.unit else '')}"


def _explain_left(name: str) -> str:
    """Why a column is left out."""
    meaning = read_column_name(name)
    if meaning is None:
        return "no word of its name is a quantity"
    return f"could be {meaning.channel}, but another column says so more surely, or its joint has no position or torque"

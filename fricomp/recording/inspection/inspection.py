"""What a log seems to hold: each column, what it is taken for and why, and what speaks against it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.checks import check_recording
from fricomp.recording.finding import Finding
from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.log import NamedLog, separate_joints
from fricomp.recording.named.source import read_named_columns
from fricomp.recording.validity import Samples

__all__ = ["InspectedColumn", "Inspection", "inspect_log"]


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
    """

    columns: tuple[InspectedColumn, ...]
    log: NamedLog | None
    refusal: str
    findings: Mapping[str, tuple[Finding, ...]]


def inspect_log(path: Path, channels: Mapping[str, str] | None = None) -> Inspection:
    """Look at a log without converting it.

    Args:
        path: As for `read_named_log`.
        channels: Column by channel where several could be one.

    Raises:
        RecordingError: The file cannot be read, or its columns have no names.
        MissingExtraError: The package that reads the format is not installed.
    """
    columns, log, refusal = read_named_columns(path), None, ""
    try:
        log = separate_joints(path, columns, channels or {})
    except RecordingError as error:
        refusal = str(error)
    taken: dict[str, list[str]] = {}
    for joint, sources in log.sources.items() if log is not None else ():
        for channel, (name, _) in sources.items():
            taken.setdefault(name, []).append(channel if channel == "time" else f"{channel} of {joint}")
    seen = tuple(_look_at(name, values, taken.get(name, [])) for name, values in columns.items())
    recordings = log.recordings if log is not None else ()
    return Inspection(seen, log, refusal, {one.metadata.joint: check_recording(one) for one in recordings})


def _look_at(name: str, values: Samples, taken: list[str]) -> InspectedColumn:
    finite = values[np.isfinite(values)]
    lowest, highest = (float(finite.min()), float(finite.max())) if finite.size else (float("nan"), float("nan"))
    taken_for = "; ".join(dict.fromkeys(taken)) if len(set(taken)) == 1 or "time" not in taken else "time"
    return InspectedColumn(name, finite.size, lowest, highest, taken_for, _explain(name, taken_for))


def _explain(name: str, taken_for: str) -> str:
    """Why a column is taken for what it is, or left out."""
    meaning = read_column_name(name)
    if taken_for == "time":
        return "called as a time; the unit by its name, or by the step from row to row"
    if taken_for:
        unit = f"in {meaning.unit}" if meaning is not None and meaning.unit else "no unit in the name: taken as SI"
        return unit
    if meaning is None:
        return "no word of its name is a quantity"
    return f"could be {meaning.channel}, but another column says so more surely, or its joint has no position or torque"

"""Columns in units that no log states, which are asked for: of a device, of a controller's axis, parts of a rating."""

import re
import shlex
from collections.abc import Collection, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.position_size import find_sign_bit
from fricomp.recording.unit_word import (
    UNKNOWN_UNIT,
    find_unit_words,
    kind_of_unit,
    make_narrow,
    unit_for,
)
from fricomp.recording.validity import Samples

from .column import RAW_UNIT, ColumnMeaning, read_column_name, says_counts
from .head_fact import find_counts_beside, say_head_facts
from .units.unit_step import find_unit_step

_FAR = 8.0 * np.pi
"""Way of an axis without a unit [rad], above which it is as likely in degrees or mm: four turns of a joint."""
_FEWEST_COUNTS = 10
"""Different whole numbers from which on no chance makes all of them so."""
_RATED = ("torque", "torque_command", "current", "load_torque")
_DUTY = re.compile(r"(?<![a-z])(?:duty|pwm)(?![a-z])", re.IGNORECASE)
_PER_CENT = re.compile(r"[%]|(?<![a-z])(?:percent|pct)(?![a-z])", re.IGNORECASE)
_PART_OF_CENT = re.compile(r"(?<![\d.,])(0[.,]0*1)\s*%")
"""A part of a per cent as the unit of whole numbers."""
_PER_MILLE = re.compile(
    r"‰|(?<![a-z])(?:permille|per[ _]thousand|per[ _]mille)(?![a-z])|(?<![0-9A-Fa-f])(?:0x)?607[1478](?:h|\b|_)",
    re.IGNORECASE,
)
"""Words, and the objects of CiA 402 for the torque and current of a drive, in per mille of their ratings [cia402]."""
_LENGTHS = ("position", "position_reference")
_INCHES = re.compile(r"[_ ]in$", re.IGNORECASE)
_POUNDS = ("lbf", "kip", "in·lbf", "ft·lbf")
"""`in` alone may be what goes in; beside these it is inches."""
_LOGIX = re.compile(r"^(.+)\.(?:Torque|Current)(?:Feedback|Reference|Command|Trim)$")
"""Tags of an axis of Rockwell's controllers: per cent of the rating of its motor."""
_SYSMAC = re.compile(r"^(.+\.(?:Act|Cmd))\.Trq$")
"""The torque of an axis of Omron's controllers, in per cent of the rated one too."""
_AXIS_VALUE = re.compile(r"(?:^|[./ _\]])f?Act(?:ual)?_?Pos(?:ition)?$")
"""Position of an axis as controllers of machines call it: in the unit that its project has chosen."""


def find_rating_parts(name: str, beside: Collection[str]) -> int:
    """Of how many parts of its rating a torque or a current consists, 100 and more; 0 where its name says none.

    Args:
        name: Of the column.
        beside: Names of all columns, with their numbers where they are known.
    """
    tag = _LOGIX.match(name)
    axis = _SYSMAC.match(name)
    is_share = (tag and f"{tag.group(1)}.ActualPosition" in beside) or (axis and f"{axis.group(1)}.Pos" in beside)
    if _PER_CENT.search(name) or is_share:
        return _count_parts(name, beside)
    return 1000 if _PER_MILLE.search(name) else 0


def _count_parts(name: str, beside: Collection[str]) -> int:
    """100 of what is in per cent, and more of whole numbers of which each is a part of one: `Torque[0.1%]`.

    Numbers that are not whole are in per cent, and what stands before it is their resolution.
    """
    step = _PART_OF_CENT.search(make_narrow(name))
    known = beside[name] if isinstance(beside, Mapping) and name in beside else np.empty(0)
    if step is None or not known.size or not _are_whole(known):
        return 100
    return round(100.0 / float(step.group(1).replace(",", ".")))


def is_duty(name: str) -> bool:
    """Whether a column is called as the part of the supply that a drive switches on."""
    return bool(_DUTY.search(name))


def is_of_axis(name: str) -> bool:
    """Whether a column is called as the position of a controller's axis, whose unit its project has chosen."""
    return bool(_AXIS_VALUE.search(name)) and not find_unit_words(name, -1)


def with_device_unit(name: str, meaning: ColumnMeaning, beside: Mapping[str, Samples]) -> ColumnMeaning:
    """The meaning with its unit to be asked for, where the name says a rating or an axis; others are as they were.

    `pos_in` beside a force in pounds is in inches.

    Args:
        name: Of the column.
        meaning: What its words say, without a unit.
        beside: All columns by name.
    """
    if meaning.channel in _RATED and find_rating_parts(name, beside):
        return replace(meaning, unit=RAW_UNIT)
    if meaning.channel in _LENGTHS and not meaning.unit and _INCHES.search(name) and _has_pounds(beside):
        return replace(meaning, unit="in")
    if meaning.channel in ("position", "motor_position") and not meaning.unit and find_counts_beside(beside):
        return replace(meaning, unit=RAW_UNIT) if _are_whole(beside[name]) else meaning
    return meaning


def with_unit_step(name: str, meaning: ColumnMeaning, values: Samples) -> ColumnMeaning:
    """The meaning of whole numbers with what one of them is, where the name says it: `current (0.01 A)`.

    Numbers that are not whole may have been multiplied by it before; they are asked about.

    Args:
        name: Of the column.
        meaning: What its words say.
        values: Shape (n_rows,).
    """
    step = find_unit_step(name) if meaning.unit == UNKNOWN_UNIT else None
    is_of_it = step is not None and kind_of_unit(step.unit) in (meaning.channel.removesuffix("_reference"), "current")
    if step is None or not is_of_it or not _are_whole(values):
        return meaning
    return replace(meaning, unit=unit_for(meaning.channel, step.unit), scale=step.worth)


def _has_pounds(names: Collection[str]) -> bool:
    return any(word.unit in _POUNDS for name in names for word in find_unit_words(name, -1))


def refuse_axis(path: Path, column: str, meaning: ColumnMeaning, values: Samples) -> None:
    """Refuse to take for rad what is called as the position of a controller's axis, and goes far.

    Args:
        path: Of the log, for messages.
        column: Name of the position, which does not wrap.
        meaning: What it says.
        values: Shape (n_rows,).

    Raises:
        RecordingError: It is such a position.
    """
    known = values[np.isfinite(values)]
    way = float(np.ptp(known)) if known.size else 0.0
    if meaning.unit or not is_of_axis(column) or way < _FAR:
        return
    in_counts = "scale = 6.2832/COUNTS_A_TURN } with the number worked out"
    what = in_counts if _are_whole(values) else 'unit = "deg" }'
    raise RecordingError(
        f"{path}: {column!r} is in the unit of its axis, and covers {way:.4g}, far for rad: say in a mapping which it "
        f'is, such as position = {{ column = {column!r}, {what}, or "rad", or "mm" and motion = "linear" '
        "('fricomp convert LOG --inspect --out log.toml' begins one)"
    )


def _are_whole(values: Samples) -> bool:
    known = values[np.isfinite(values)]
    return bool(np.all(known == np.round(known)))


def explain_unit(path: Path, channel: str, column: str, meaning: ColumnMeaning, beside: Mapping[str, Samples]) -> str:
    """What to write for a column whose unit is not known; empty where it is.

    Args:
        path: Of the log, for messages.
        channel: Of the column.
        column: Its name.
        meaning: What its name says.
        beside: All columns by name.
    """
    if meaning.unit not in (RAW_UNIT, UNKNOWN_UNIT):
        return ""
    if is_duty(column) and channel in _RATED and find_rating_parts(column, beside):
        return (
            f"{path}: {column!r} is a part of the supply, and no torque: write {channel} = {{ column = {column!r}, "
            'scale = SUPPLY/100 } with the number worked out and torque_unit = "V", SUPPLY in V, or record the current'
        )
    return say_head_facts(path, _ask_unit(path, channel, column, meaning, beside), column, beside)


def _ask_unit(path: Path, channel: str, column: str, meaning: ColumnMeaning, beside: Mapping[str, Samples]) -> str:
    parts = find_rating_parts(column, beside) if channel in _RATED else 0
    if parts:
        share = {100: "per cent", 1000: "per mille"}.get(parts, f"parts of 1/{parts}")
        of_current = channel == "current"
        what = "current" if of_current else "torque"
        behind = 'and torque_unit = "A"' if of_current else "times the gear ratio where the position is behind a gear"
        return (
            f"{path}: {column!r} is in {share} of the rated {what} of the motor: write "
            f"{'torque' if of_current else channel} = {{ column = {column!r}, scale = RATED/{parts} }} in a mapping "
            f"with the number worked out, RATED that {what} in {'A' if of_current else 'N·m'} (on its plate, in the "
            f"settings of the drive), {behind}{_offer_current(channel, beside)}{_ask_position(beside)} "
            "('fricomp convert LOG --inspect --out log.toml' begins one)"
        )
    is_angle = channel in ("position", "motor_position")
    is_whole = column not in beside or _are_whole(beside[column])
    if meaning.unit == RAW_UNIT and is_angle and not is_whole and not says_counts(column):
        return (
            f"{path}: {column!r} is called as an encoder's, and not in counts, since its numbers are not whole: "
            f'say in a mapping which unit it has, such as {channel} = {{ column = {column!r}, unit = "deg" }}, or '
            '"rad", "turns", or "mm" and motion = "linear"'
        )
    if meaning.unit == RAW_UNIT:
        scale = "6.2832/COUNTS_A_TURN" if is_angle else "VALUE_OF_ONE"
        signed = find_sign_bit(beside[column]) if is_angle and column in beside else None
        scale += f", sign_bit = {signed[0]}" if signed is not None else ""
        return (
            f"{path}: {column!r} is in units of a device: say in a mapping what one is worth, such as "
            f"{channel} = {{ column = {column!r}, scale = {scale} }} with the number worked out"
        )
    return (
        f"{path}: the unit in {column!r} is not known: say in a mapping what one of it is in SI, such as "
        f"{channel} = {{ column = {column!r}, scale = VALUE_OF_ONE }}, and the other columns beside it "
        "('fricomp convert LOG --inspect' shows them)"
    )


def _offer_current(channel: str, beside: Mapping[str, Samples]) -> str:
    """That a current in a known unit may be taken in place of a torque that is a part of a rating."""
    said = {name: one for name in beside if (one := read_column_name(name)) is not None and one.channel == "current"}
    known = [
        name for name, one in said.items() if one.unit not in (RAW_UNIT, UNKNOWN_UNIT) and find_unit_words(name, -1)
    ]
    if channel != "torque" or len(known) != 1:
        return ""
    return f"; or take the current, which gives friction in A, by --channel {shlex.quote(f'torque={known[0]}')}"


def _ask_position(beside: Mapping[str, Samples]) -> str:
    """That a position is to be told as well, where it is in units of a device too."""
    said = {name: one for name in beside if (one := read_column_name(name)) is not None}
    positions = {name: one for name, one in said.items() if one.channel in ("position", "motor_position")}
    is_asked = any(one.unit == RAW_UNIT or are_counts(name, beside[name]) for name, one in positions.items())
    return "; and say there what one of the position is" if is_asked else ""


def are_counts(name: str, values: Samples) -> bool:
    """Whether a column holds many different numbers, all of them whole, and its name states no unit.

    Args:
        name: Of the column.
        values: Shape (n_rows,).
    """
    if find_unit_words(name, -1):
        return False
    finite = values[np.isfinite(values)]
    return bool(np.all(finite == np.round(finite))) and np.unique(finite).size >= _FEWEST_COUNTS

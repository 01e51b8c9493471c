"""Columns without a unit where the log tells it elsewhere: in words above its rows, or by a velocity that has one."""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.checks.unit_checks import compare_rate
from fricomp.recording.recording import Recording
from fricomp.recording.unit import UNITS, shows_radians
from fricomp.recording.unit_word import UnitWord, find_unit_words, kind_of_unit, unit_for

from .choice import INTEGRAL
from .column import ColumnMeaning
from .device_unit import are_counts
from .head_fact import read_head_lines
from .times.stamp_unit import read_time_unit

SURE = 3
"""Certainty of a column that the user has named."""
_FINER = 5.0
"""How much farther than its velocity says a position without a unit moves that is in no rad of the joint: a motor that
is read beside the joint's angle moves less far than its own velocity says."""
_ALIKE = 0.95
"""Correlation of a position with the integral of a velocity from which on they are of one motion."""
_SAME_UNIT = 5e-3
"""Relative error within which the factor between a way and its rate is that of a unit: ten is 5 % from that of rpm."""
_RARE = ("mrad/s", "mdeg/s", "krpm", "in/s")
"""Units of a velocity that none is in without saying so."""
_COUNTED, _POWERS = ("ms", "us", "ns"), (-2, -1, 1, 2)
"""Units of time that were guessed by steps, and the powers of ten by which these miss: counters of 0.1 ms, of 10 us."""
STATED_BY_MANUALS = re.compile(r"effort|qfrc_|tau_J|actual_current", re.IGNORECASE)
"""Torques of ROS, MuJoCo, Franka and UR, whose manuals state radians, and N·m."""
_TURN = 2.0 * np.pi
_TWO_TURNS = 2.0 * _TURN
"""Travel above which few joints of an arm are [rad]."""
_ALL_BUT_OUTLIERS = (2, 98)
_OFTEN_DEGREES = re.compile(r"ang|winkel|heading|yaw|pitch|roll|tilt", re.IGNORECASE)
"""Names of positions that people log in degrees as often; a motor that turns and turns in a log without units is in SI,
as nearly all that is called `q`, `theta` or `pos` there."""
_PARTS = re.compile(r"[,;:]\s|\band\b|\bund\b")
"""Where a line goes on to another quantity: `angles in degrees, torques in mNm`."""
_BESIDE_NUMBER = re.compile(r"\d\s*[\[(]?$")
"""What stands before the unit of a number, which is that of no column: `limit 10 deg`."""


def refuse_unstated(path: Path, recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]) -> None:
    """Refuse to take a column without a unit for one of SI where the log tells another.

    Args:
        path: Of the log.
        recording: What was read of it.
        own: Column and meaning of the joint by channel.

    Raises:
        RecordingError: It does.
    """
    silent = {channel: own[channel] for channel in ("position", "velocity", "torque") if _is_silent(channel, own)}
    said = _find_units_above(path) if silent else {}
    told = {channel: (column, *said[channel]) for channel, (column, _) in silent.items() if channel in said}
    if told:
        names = " and ".join(repr(column) for column, _, _ in told.values())
        lines = " and ".join(dict.fromkeys(repr(line) for _, _, line in told.values()))
        rules = ", ".join(f'{one} = {{ column = {name!r}, unit = "{unit}" }}' for one, (name, unit, _) in told.items())
        plain = " ".join(f"--channel {channel}={shlex.quote(column)}" for channel, (column, _, _) in told.items())
        raise RecordingError(
            f"{path}: no unit stands in {names}, and above the rows stands {lines}: write {rules} in a mapping "
            f"('fricomp convert LOG --inspect --out log.toml' begins one), or say {plain} where that is in SI"
        )
    if "position" in silent and "velocity" in own and find_unit_words(own["velocity"][0], -1):
        _refuse_other_way(path, recording, own["position"][0], own["velocity"][0])


def _is_silent(channel: str, own: Mapping[str, tuple[str, ColumnMeaning]]) -> bool:
    """Whether a channel has a column whose unit neither its name nor the user says."""
    column, meaning = own.get(channel, ("", None))
    is_said = meaning is None or meaning.unit or meaning.certainty >= SURE
    return bool(column) and not is_said and not find_unit_words(column, -1)


def _find_units_above(path: Path) -> dict[str, tuple[str, str]]:
    """Units other than those of SI in words above the rows, with their line, by quantity; none that is told twice."""
    found: dict[str, set[tuple[str, str]]] = {}
    for line in read_head_lines(path):
        for part, word in _list_units(line):
            unit = unit_for(kind_of_unit(word.unit), word.unit)
            if unit in UNITS and len(word.text) > 1 and not _BESIDE_NUMBER.search(part[: word.span[0]]):
                found.setdefault(kind_of_unit(unit), set()).add((unit, line))
    return {kind: next(iter(said)) for kind, said in found.items() if len({unit for unit, _ in said}) == 1}


def _list_units(line: str) -> list[tuple[str, UnitWord]]:
    """The units of a line, with the part of it in which each stands."""
    return [(part, word) for part in _PARTS.split(line) for word in find_unit_words(part, -1)]


def _refuse_other_way(path: Path, recording: Recording, position: str, velocity: str) -> None:
    """Refuse a position that moves far more than a velocity with a unit says.

    Raises:
        RecordingError: It does.
    """
    compared = compare_rate(recording) if recording.metadata.motion == "rotary" else None
    if compared is not None and compared[0] > _FINER and compared[1] > _ALIKE:
        raise RecordingError(
            f"{path}: {position!r} states no unit, and moves {compared[0]:.5g} times as far as {velocity!r} says: "
            f"write position = {{ column = {position!r}, scale = {1.0 / compared[0]:.5g} }} in a mapping, or the unit "
            "that makes about that ('fricomp convert LOG --inspect --out log.toml' begins one)"
        )


def settle_units(
    path: Path, recording: Recording, own: dict[str, tuple[str, ColumnMeaning]], time: tuple[str, str]
) -> tuple[Recording, list[str]]:
    """The recording with the units that position and velocity tell of each other, and what was taken for what.

    One is the rate of another: where the factor between them is that of a unit, the column without one is in that. A
    position is converted only by a velocity that states its unit, since a gear makes a factor as well.

    Args:
        path: Of the log.
        recording: What was read of it.
        own: Column and meaning of the joint by channel; what was settled is written into it.
        time: Name of the column with the time, and its unit.

    Raises:
        RecordingError: The time states no unit and may count others: a gear of ten looks alike.
    """
    compared = compare_rate(recording) if "velocity" in own else None
    if compared is None or compared[1] < _ALIKE or abs(compared[0] - 1.0) < _SAME_UNIT:
        return recording, []
    silent = [channel for channel in ("position", "velocity") if _is_silent(channel, own)]
    if not silent and _is_per_second(own["velocity"]) and abs(compared[0] * _TURN - 1.0) < _SAME_UNIT:
        own["velocity"] = (own["velocity"][0], replace(own["velocity"][1], unit="rad/s"))
        return recording.with_channels(velocity=np.asarray(recording.velocity) / _TURN), [
            f"{path.name}: {own['velocity'][0]!r} was taken to be in rad/s, by {own['position'][0]!r}."
        ]
    unit = _find_unit_by_rate(compared[0], recording, own, silent)
    if unit is not None:
        channel = kind_of_unit(unit)
        column, meaning = own[channel]
        own[channel] = (column, replace(meaning, unit=unit))
        scaled = {channel: np.asarray(recording.channels[channel]) * UNITS[unit].factor}
        other = own["velocity" if channel == "position" else "position"][0]
        return recording.with_channels(**scaled), [f"{path.name}: {column!r} was taken to be in {unit}, by {other!r}."]
    power = round(np.log10(compared[0]))
    is_open = time[1] in _COUNTED and not read_time_unit(time[0]) and len(silent) != 1
    if not is_open or power not in _POWERS or abs(compared[0] / 10.0**power - 1.0) > _SAME_UNIT:
        return recording, []
    one, rule = 10.0**power, f'column = {time[0]!r}, unit = "{time[1]}", scale = {10.0**power:g}, from_zero = true'
    raise RecordingError(
        f"{path}: {time[0]!r} states no unit, and beside it in {time[1]} {own['position'][0]!r} moves "
        f"{compared[0]:.4g} times as far as {own['velocity'][0]!r} says: where it counts {one:g} {time[1]}, write "
        f"time = {{ {rule} }} in a mapping; where the velocity is that of another side of a gear, leave its line out "
        "('fricomp convert LOG --inspect --out log.toml' begins one)"
    )


def _is_per_second(velocity: tuple[str, ColumnMeaning]) -> bool:
    """Whether a velocity is called as `rps`, which is read as turns and may be radians a second."""
    return any(word.text.lower() == "rps" for word in find_unit_words(velocity[0], -1)) and velocity[1].unit != "rad/s"


def _find_unit_by_rate(
    factor: float, recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]], silent: Sequence[str]
) -> str | None:
    """The unit of the column without one, by how many times as far the position moves as the velocity says."""
    if "velocity" in silent:
        si = "rad/s" if recording.metadata.motion == "rotary" else "m/s"
        worth = {unit: one.factor for unit, one in UNITS.items() if one.si == si and unit not in _RARE}
    elif "position" in silent and recording.metadata.motion == "rotary":
        by_turns = ("turns",) if own["velocity"][1].unit in ("rpm", "turns/s") else ()
        worth = {unit: 1.0 / UNITS[unit].factor for unit in ("deg", *by_turns)}
    else:
        return None
    return next((unit for unit, one in worth.items() if one != 1.0 and abs(factor / one - 1.0) < _SAME_UNIT), None)


def say_missing_unit(
    path: Path, recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]], joints: int
) -> list[str]:
    """What was taken for the unit of a position, where nothing in the log tells it, and what another would do.

    A column that is called as the channel is of a recording of our own, in radians.

    Raises:
        RecordingError: In rad it would cover more turns than most joints do, and its name is one of degrees as often.
    """
    column, meaning = own["position"]
    stated = any(find_unit_words(own[one][0], -1) for one in ("position", "velocity") if one in own)
    ours = column == INTEGRAL or (column == "position" and own["torque"][0] == "torque")
    told = stated or meaning.unit or meaning.certainty >= SURE or ours or STATED_BY_MANUALS.search(own["torque"][0])
    counted = are_counts(column, recording.position)  # which the checks ask about
    if told or counted or recording.metadata.motion != "rotary" or shows_radians(recording.position):
        return []
    travel = float(np.ptp(np.percentile(recording.position, _ALL_BUT_OUTLIERS)))
    if travel > _TWO_TURNS and _OFTEN_DEGREES.search(column):
        asked = shlex.quote(f"position={column.replace(meaning.joint, '{joint}') if joints > 1 else column}")
        raise RecordingError(
            f"{path}: nothing tells the unit of {column!r}, which covers {travel:.4g}, in rad {travel / _TURN:.1f} "
            f'turns: say position = {{ column = {column!r}, unit = "deg" }} or unit = "turns" in a mapping'
            f"{_beside(own)} ('fricomp convert LOG --inspect --out log.toml' begins one), or --channel {asked} "
            "where it is in rad"
        )
    return [
        f"{path.name}: nothing tells the unit of {column!r}: it was taken as rad. If it is in turns, friction by speed "
        "and inertia come out 6.28 times too large; if in degrees, 57.3 times too small."
    ]


def _beside(own: Mapping[str, tuple[str, ColumnMeaning]]) -> str:
    """That the velocity is to be told as well, where its unit is not."""
    column, meaning = own.get("velocity", ("", None))
    is_silent = meaning is not None and not meaning.unit and not find_unit_words(column, -1)
    return f', with velocity = {{ column = {column!r}, unit = "deg/s" }} where it goes with it,' if is_silent else ""

"""Columns without a unit where the log tells it elsewhere: in words above its rows, or by a velocity that has one."""

import re
import shlex
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.recording import Recording
from fricomp.recording.runs import integrate
from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import UnitWord, find_unit_words, kind_of_unit, unit_for

from .column import ColumnMeaning
from .head_fact import read_head_lines

_SURE = 3
"""Certainty of a column that the user has named."""
_FINER = 5.0
"""How much farther than its velocity says a position without a unit moves that is in no rad of the joint: a motor that
is read beside the joint's angle moves less far than its own velocity says."""
_ALIKE = 0.95
"""Correlation of a position with the integral of a velocity from which on they are of one motion."""
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
    is_said = meaning is None or meaning.unit or meaning.certainty >= _SURE
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
    if recording.velocity is None or recording.metadata.motion != "rotary":
        return
    way = integrate(np.asarray(recording.velocity), np.asarray(recording.time))
    if np.ptp(way) == 0.0 or np.ptp(recording.position) == 0.0:
        return
    factor = float(np.polyfit(way, recording.position, 1)[0])
    if factor > _FINER and np.corrcoef(way, recording.position)[0, 1] > _ALIKE:
        raise RecordingError(
            f"{path}: {position!r} states no unit, and moves {factor:.5g} times as far as {velocity!r} says: write "
            f"position = {{ column = {position!r}, scale = {1.0 / factor:.5g} }} in a mapping, or the unit that makes "
            "about that ('fricomp convert LOG --inspect --out log.toml' begins one)"
        )

"""Whether a joint turns or slides: what the names and units of its columns say, else its simulation."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.quantity_word import split_words
from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_unit, shows_radians
from fricomp.recording.unit_word import UNKNOWN_UNIT, find_unit_words
from fricomp.recording.validity import Samples

from .column import RAW_UNIT, ColumnMeaning

_SLIDES = frozenset(
    [
        "stroke",
        "displacement",
        "weg",
        "lin",
        "linear",
        "slide",
        "slider",
        "carriage",
        "rail",
        "prismatic",
        "gantry",
        "piston",
        "ballscrew",
        "schlitten",
    ]
)
"""Words in the position of an axis that slides."""
_TURNS = frozenset(["angle", "angular", "rotation", "rotary", "winkel", "theta"])
"""Words of one that turns whatever else it is called: an angular displacement."""
_LONGEST_AXIS = 3.0
"""Travel without a unit, above which it is asked whether such an axis is logged in metres: most are shorter [m]."""
_ASSUMED = "motion_assumed"
"""In `extra` of the metadata: `motion` is what most joints do."""


def is_linear(own: Mapping[str, tuple[str, ColumnMeaning]]) -> bool:
    """Whether the joint slides: its position is in metres, or what moves it is a force."""
    said = {
        channel: meaning.unit
        for channel, (_, meaning) in own.items()
        if meaning.unit not in ("", RAW_UNIT, UNKNOWN_UNIT)
    }
    stated = {channel: find_unit(unit).si for channel, unit in said.items()}
    if stated.get("position") == "m" or stated.get("velocity") == "m/s":
        return True
    if stated.get("torque") == "N":
        return not (_says_angle(*own["position"]) and slides_by_force_alone(own))
    return _says_linear(*own["position"])


def slides_by_force_alone(own: Mapping[str, tuple[str, ColumnMeaning]]) -> bool:
    """Whether nothing but the word force says that a joint slides: it may be a generalised one."""
    column, meaning = own["torque"]
    others = {channel: one for channel, one in own.items() if channel != "torque"}
    stated = any(one.unit == "N" for one in find_unit_words(column, -1))
    return meaning.unit == "N" and not stated and not is_linear(others)


def _says_angle(column: str, meaning: ColumnMeaning) -> bool:
    """Whether a position is called an angle, or has the unit of one."""
    words = {word for word, _ in split_words(column)}
    return bool(words & _TURNS or meaning.unit or find_unit_words(column, -1))


def _says_linear(column: str, meaning: ColumnMeaning) -> bool:
    """Whether a position without a unit is called as that of an axis that slides."""
    words = {word for word, _ in split_words(column)}
    return not meaning.unit and bool(words & _SLIDES) and not words & _TURNS


def require_length(path: Path, position: tuple[str, ColumnMeaning], values: Samples) -> None:
    """Refuse to take for metres what an axis is called to slide by, and is no length of one.

    Raises:
        RecordingError: It is such a position.
    """
    column, meaning = position
    travel = float(np.nanmax(values) - np.nanmin(values)) if np.isfinite(values).any() else 0.0
    if _says_linear(column, meaning) and travel > _LONGEST_AXIS:
        raise RecordingError(
            f"{path}: {column!r} is called as the position of an axis that slides, states no unit and covers "
            f'{travel:.4g}: say in a mapping which it is, such as position = {{ column = {column!r}, unit = "mm" }} '
            "('fricomp convert LOG --inspect --out log.toml' begins one)"
        )


def mark_assumed(recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]) -> Recording:
    """The recording, marked where neither a name nor the step of its encoder says that the joint turns.

    Args:
        recording: From the columns of a log.
        own: Column and meaning by channel.
    """
    said = [own[one] for one in ("position", "velocity", "torque") if one in own]
    has_unit = any(meaning.unit or find_unit_words(name, -1) for name, meaning in said)
    if has_unit or recording.metadata.motion != "rotary" or shows_radians(recording.position):
        return recording
    return recording.with_metadata(extra={**recording.metadata.extra, _ASSUMED: True})


def take_motion(recording: Recording, *, rotary: bool) -> Recording:
    """A recording whose motion was assumed as that of the simulation's joint; any other as it is."""
    facts = recording.metadata
    if not facts.extra.get(_ASSUMED) or (facts.motion == "rotary") == rotary:
        return recording
    unit = {"N·m": "N"}.get(facts.torque_unit, facts.torque_unit)
    kept = {name: value for name, value in facts.extra.items() if name != _ASSUMED}
    return recording.with_metadata(motion="rotary" if rotary else "linear", torque_unit=unit, extra=kept)

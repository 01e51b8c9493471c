"""References without a unit beside a measured column with one: `pos_cmd` beside `pos_deg`."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import find_unit_words
from fricomp.recording.validity import Samples

from .column import REFERENCES, ColumnMeaning
from .unstated import SURE

_OF_TURNING, _OF_SLIDING = ("deg/s", "rpm", "turns/s"), ("mm/s",)
"""Units that velocities are in beside those of SI."""
_NEARER = 0.3
"""Part of the distance between reference and measured values that another unit has to leave, to be the one."""


def settle_references(
    path: Path, recording: Recording, own: dict[str, tuple[str, ColumnMeaning]]
) -> tuple[Recording, list[str]]:
    """The recording with each reference in the unit of what was measured, where it follows that far better so.

    Args:
        path: Of the log.
        recording: What was read of it.
        own: Column and meaning of the joint by channel; what was settled is written into it.
    """
    said = []
    for channel, asked in REFERENCES.items():
        if asked not in own or asked not in recording.channels or own["torque"][0] == own[asked][0]:
            continue
        column, meaning = own[asked]
        if meaning.unit or meaning.certainty >= SURE or find_unit_words(column, -1):
            continue
        measured, by, units = _find_measured(channel, recording, own)
        values = recording.channels[asked]
        left = {name: _measure_distance(factor * values, measured) for name, factor in units.items()}
        unit = min(left, key=lambda name: left[name], default="")
        if unit and left[unit] < _NEARER * _measure_distance(values, measured):
            recording = recording.with_channels(**{asked: units[unit] * values})
            own[asked] = (column, replace(meaning, unit=unit, scale=units[unit] / find_unit(unit).factor))
            said.append(f"{path.name}: {column!r} was taken to be in {unit}, by {by!r}.")
    return recording, said


def _find_measured(
    channel: str, recording: Recording, own: Mapping[str, tuple[str, ColumnMeaning]]
) -> tuple[Samples, str, dict[str, float]]:
    """What was measured, the name of its column, and what one of each unit that a reference may be in is in SI.

    That is the unit of the measured column; beside no velocity that of any, by the rate of the position.
    """
    if channel in own and channel in recording.channels:
        column, meaning = own[channel]
        worth = find_unit(meaning.unit).factor * meaning.scale if meaning.unit else 1.0
        return recording.channels[channel], column, {} if worth == 1.0 else {meaning.unit: worth}
    if channel != "velocity":
        return np.zeros(len(recording)), "", {}
    units = _OF_TURNING if recording.metadata.motion == "rotary" else _OF_SLIDING
    rate = np.gradient(recording.position, recording.time)
    return rate, own["position"][0], {unit: find_unit(unit).factor for unit in units}


def _measure_distance(reference: Samples, measured: Samples) -> float:
    """How far a reference is from what was measured, but for a constant."""
    return float(np.std(reference - measured))

"""References without a unit beside a measured column with one: `pos_cmd` beside `pos_deg`."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from fricomp.recording.recording import Recording
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import find_unit_words
from fricomp.recording.validity import Samples

from .column import REFERENCES, ColumnMeaning
from .unstated import SURE

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
        if asked not in own or channel not in own or asked not in recording.channels:
            continue
        (measured, known), (column, meaning) = own[channel], own[asked]
        is_stated = meaning.unit or meaning.certainty >= SURE or find_unit_words(column, -1)
        factor = find_unit(known.unit).factor * known.scale if known.unit else 1.0
        values = recording.channels[asked]
        if is_stated or factor == 1.0 or own["torque"][0] == column:
            continue
        if _measure_distance(factor * values, recording.channels[channel]) < _NEARER * _measure_distance(
            values, recording.channels[channel]
        ):
            recording = recording.with_channels(**{asked: factor * values})
            own[asked] = (column, replace(meaning, unit=known.unit, scale=known.scale))
            said.append(f"{path.name}: {column!r} was taken to be in {known.unit}, by {measured!r}.")
    return recording, said


def _measure_distance(reference: Samples, measured: Samples) -> float:
    """How far a reference is from what was measured, but for a constant."""
    return float(np.std(reference - measured))

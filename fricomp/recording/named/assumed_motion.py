"""Whether a joint turns or slides, where no name of its log states a unit: a simulation of it says so."""

from __future__ import annotations

from collections.abc import Mapping

from fricomp.recording.recording import Recording
from fricomp.recording.unit import shows_radians
from fricomp.recording.unit_word import find_unit_words

from .column import ColumnMeaning

_ASSUMED = "motion_assumed"
"""In `extra` of the metadata: `motion` is what most joints do."""


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

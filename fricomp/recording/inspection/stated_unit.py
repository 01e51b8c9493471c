"""What the name of a column says of its unit, for the mapping that is proposed."""

from fricomp.recording.named.column import (
    RAW_UNIT,
    ColumnMeaning,
    find_bare_unit,
    read_column_name,
    read_column_unit,
)
from fricomp.recording.named.device_unit import with_unit_step
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import UNKNOWN_UNIT
from fricomp.recording.validity import Samples


def find_si(name: str) -> str:
    """The unit of SI of what a name says; empty where it says none."""
    meaning = read_column_name(name) or read_column_unit(name)
    if meaning is None or meaning.unit in (RAW_UNIT, UNKNOWN_UNIT, ""):
        return "A" if meaning is not None and meaning.channel == "current" else find_bare_unit(name)
    return find_unit(meaning.unit).si


def read_step(name: str, values: Samples) -> ColumnMeaning | None:
    """What one of a column is, where its name says how many of a unit: `current (0.01 A)`; None where it does not."""
    meaning = read_column_name(name)
    found = None if meaning is None else with_unit_step(name, meaning, values)
    return found if found is not None and found.scale != 1.0 else None


def read_stated_unit(name: str) -> tuple[str, bool]:
    """The unit that a name states, and whether it has to be asked for since it is a device's, or not known."""
    meaning = read_column_name(name) or read_column_unit(name)
    if meaning is None:
        return "", False
    asked = meaning.unit in (RAW_UNIT, UNKNOWN_UNIT)
    return "" if asked else meaning.unit, asked

"""Names that stand in a list beside lists of numbers, as in a `JointState`: whose each entry is."""

from collections.abc import Collection, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np

from fricomp.recording.quantity_word import count_known

NAMES_OF_ENTRIES = ("name", "names", "joint_names", "joint_name", "joints", "motor_names", "motors", "interface_names")
"""What such a list of names is called."""


_NAMES_OF_COLUMNS = (*NAMES_OF_ENTRIES, "columns", "labels", "header", "fields", "channels", "keys", "legend")
"""What a list of the names of a matrix' columns is called."""


def find_column_names(record: Mapping[str, Any]) -> list[str]:
    """The names of the columns of a matrix beside them: of quantities, and not of joints; empty where none are."""
    names = find_entry_names(record, _NAMES_OF_COLUMNS)
    return names if count_known(names) > 1 else []


def find_entry_names(record: Mapping[str, Any], called: Collection[str] = NAMES_OF_ENTRIES) -> list[str]:
    """The names of the entries of the lists in a record; empty where it has none, or one comes twice.

    Args:
        record: Lists and others by name.
        called: What such a list is called.
    """
    for key, value in record.items():
        if key.rpartition(".")[2].lower() not in called:
            continue
        if isinstance(value, np.ndarray) and value.ndim != 1:
            continue
        names = list(value) if isinstance(value, list | tuple | np.ndarray) else []
        if names and all(isinstance(one, str) for one in names) and len(set(names)) == len(names):
            return [one.strip() for one in names]
    return []


@lru_cache
def _are_quantities(names: tuple[str, ...]) -> bool:
    return count_known(list(names)) == len(names)


def tell_entries_apart(record: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    """The record with each list of as many entries as there are names taken apart, as `<name>.<field>`.

    Objects in a list that alone is as long are called `<name>`, and so are numbers where the names are of quantities,
    as `interface_names` of a `DynamicJointState`: the field adds nothing.
    """
    told = {
        field: value
        for field, value in record.items()
        if isinstance(value, list | tuple) and len(value) == len(names) and not isinstance(value[0], str)
    }
    objects = [isinstance(one, Mapping) for value in told.values() for one in value]
    says_all = len(told) == 1 and (all(objects) or _are_quantities(tuple(names)))
    result: dict[str, Any] = {}
    for field, value in record.items():
        called = [name if says_all else f"{name}.{field}" for name in names]
        result.update(zip(called, value, strict=True) if field in told else {field: value})
    return result

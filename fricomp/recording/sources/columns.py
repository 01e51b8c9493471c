"""The columns of a foreign file, by name or by number."""

from collections.abc import Collection, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording.mapping import Column
from fricomp.recording.sources.cell import parse_number
from fricomp.recording.sources.entry_names import find_column_names, find_entry_names, tell_entries_apart
from fricomp.untrusted import require_filled

Columns = dict[Column, NDArray[np.float64]]
"""By name, and by number from 1 where the source has an order; a name made of digits is still a name."""

_MOST_CHANNELS, _LONGER = 64, 20
"""Rows of a matrix that stands alone, up to which they are channels, and how many times longer they are then."""

_SIGNAL_VALUES, _SIGNAL_LABELS = ("values", "Data", "data"), ("label", "Name", "name")
"""Keys of what a signal consists of, in Simulink and in ControlDesk."""


class Contents(NamedTuple):
    """What a file holds.

    Attributes:
        columns: Of numbers.
        words: Of words, by the names that their numbers would have; one where it is said once.
    """

    columns: Columns
    words: dict[str, list[str]]


def find_column(columns: Columns, key: Column) -> NDArray[np.float64]:
    """Return a column by its name (text) or its number counted from 1 (an integer).

    A unit in brackets behind the name is that which stands beside the column, and no part of its name there.

    Raises:
        RecordingError: There is no such column; the message lists some that are there.
    """
    if key not in columns and isinstance(key, str) and key.partition(" [")[0] in columns:
        key = key.partition(" [")[0]
    if key not in columns:
        shown = ", ".join(map(str, list(columns)[:20])) + (" …" if len(columns) > 20 else "")
        raise RecordingError(f"the source has no column {key!r}: it has {shown}")
    return columns[key]


def flatten_arrays(arrays: Mapping[str, Any]) -> Columns:
    """Give every numeric array a name: vectors `name`, column k of a matrix `name:k`.

    A matrix that stands alone also answers to the numbers of its columns, and one of as many columns as there are names
    in a list beside it to `<name>.<matrix>`; where these are names of quantities, the columns are called so.
    """
    columns: Columns = {}
    arrays = {name: np.asarray(value) for name, value in arrays.items()}
    called = find_column_names(arrays)
    entries = [] if called else find_entry_names(arrays)
    lengths = {array.size for array in arrays.values() if max(array.shape, default=0) == array.size}
    for name, array in arrays.items():
        if array.dtype.kind not in "buif":
            continue
        matrix = _stand_rows(np.squeeze(array.astype(np.float64)), lengths)
        if matrix.ndim < 2:
            columns[name] = np.atleast_1d(matrix)
        elif matrix.ndim == 2:
            each = list(matrix.T)
            names = called if len(called) == len(each) else [f"{name}:{k}" for k in range(1, len(each) + 1)]
            columns.update(zip(names, each, strict=True))
            if len(arrays) == 1:
                columns.update(enumerate(each, start=1))
            if len(entries) == len(each):
                columns.update({f"{entry}.{name}": column for entry, column in zip(entries, each, strict=True)})
    return columns


def _stand_rows(array: NDArray[np.float64], lengths: Collection[int]) -> NDArray[np.float64]:
    """A matrix with a row a sample: turned round where its rows are as long as the vectors beside it, such as a time.

    Args:
        array: Of any shape.
        lengths: Of the vectors beside it.
    """
    if array.ndim != 2 or array.shape[0] >= array.shape[1]:
        return array
    height, width = array.shape
    lies = width in lengths or (height not in lengths and height <= _MOST_CHANNELS and width >= _LONGER * height)
    return array.T if lies else array


def flatten_structures(content: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """The entries of nested structures, named with dots; signals by their label, else by their number.

    Signals are structures of values with a label: of Simulink, and `Y` beside the time `X` of dSPACE's ControlDesk.
    """
    flat: dict[str, Any] = {}
    for name, value in content.items():
        label, values = _read_signal(value) if _is_signal(value) else ("", None)
        if name == "X" and values is not None and "Y" in content:
            flat[f"{prefix}time"] = values
        elif label:
            flat[f"{prefix}{name}.{label}"] = values
        elif isinstance(value, dict):
            flat.update(flatten_structures(value, f"{prefix}{name}."))
        elif _are_signals(value):
            for number, (label, values) in enumerate(map(_read_signal, value), start=1):
                flat[f"{prefix}{name}.{label or number}"] = values
        else:
            flat[f"{prefix}{name}"] = value
    return flat


def _are_signals(value: Any) -> bool:
    """Whether a value holds several signals."""
    some = isinstance(value, list | tuple | np.ndarray) and len(value) > 0
    return some and all(map(_is_signal, value))


def _is_signal(value: Any) -> bool:
    """Whether a value is a structure with values, and with no time of its own."""
    if not isinstance(value, dict) or {"Time", "time"} & value.keys():
        return False
    return any(isinstance(value.get(key), list | np.ndarray) for key in _SIGNAL_VALUES)


def _read_signal(signal: Mapping[str, Any]) -> tuple[str, Any]:
    """Label and values of a signal; the label, with its unit in brackets, is empty where it has none."""
    label = next((signal[key] for key in _SIGNAL_LABELS if isinstance(signal.get(key), str)), "")
    unit = next((signal[key] for key in ("Unit", "unit") if isinstance(signal.get(key), str)), "")
    values = next(signal[key] for key in _SIGNAL_VALUES if isinstance(signal.get(key), list | np.ndarray))
    return f"{label} [{unit}]" if label and unit and "[" not in label else label, values


def columns_of_records(records: Iterable[Any]) -> Columns:
    """Turn rows, each an object or a list of numbers, into columns; what is missing becomes NaN.

    Rows that are lists answer to the numbers of their entries.
    """
    records = list(records)
    rows = [_flatten_record(record) for record in records]
    names = dict.fromkeys(name for row in rows for name in row)
    require_filled(len(rows), len(names), sum(map(len, rows)))
    columns: Columns = {name: np.array([row.get(name, np.nan) for row in rows], dtype=np.float64) for name in names}
    if all(isinstance(record, list | tuple) for record in records):
        columns.update({int(name): columns[name] for name in names if name.isdigit()})
    return columns


def _flatten_record(record: Any, prefix: str = "", names: Sequence[str] = ()) -> dict[str, float]:
    """Numbers of a nested record, and dates in seconds: keys joined by dots, list entries by their name or number.

    Args:
        record: A value, an object or a list.
        prefix: What it is called.
        names: Of the entries of lists in it, as an object around it says them.
    """
    if isinstance(record, bool | int | float):
        return {prefix: float(record)}
    if isinstance(record, str):
        return _read_word(record, prefix)
    if isinstance(record, Mapping):
        names = find_entry_names(record) or names
        items = [(str(name), value) for name, value in (tell_entries_apart(record, names) if names else record).items()]
    elif isinstance(record, list | tuple):
        items = list(zip(_call_entries(record), record, strict=True))
    else:
        return {}
    flat: dict[str, float] = {}
    for name, value in items:
        flat.update(_flatten_record(value, f"{prefix}.{name}" if prefix else name, names))
    return flat


def _call_entries(entries: Sequence[Any]) -> list[str]:
    """What the entries of a list are called: as each says itself, where all are objects with a name, else by number."""
    said = [entry.get("name") for entry in entries if isinstance(entry, Mapping)]
    names = [one for one in said if isinstance(one, str) and one]
    is_told = len(set(names)) == len(entries) == len(names)
    return names if is_told else [str(k) for k in range(1, len(entries) + 1)]


def _read_word(word: str, name: str) -> dict[str, float]:
    """A number or a date that is written as a word; nothing of any other."""
    try:
        return {name: parse_number(word, ".")} if word[:1].isdigit() or word[:1] in ("-", "+", ".") else {}
    except ValueError:
        return {}

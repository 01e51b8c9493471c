"""Data frames in HDF5 as `DataFrame.to_hdf` writes them, both the fixed form and the one that can be appended to.

The fixed form has a matrix `block<k>_values` beside the names of its columns, `block<k>_items`, and the index as
`axis1`; the other one has a table with a field `values_block_<k>`, or a field for each column, and its index as
`index`. Names are pickles there, whose words are read without running them.
"""

import pickletools
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from fricomp.recording.quantity_word import TIMES, split_words
from fricomp.recording.unit import UNITS

_KIND = "pandas_type"
_OF_TEXT = ("UNICODE", "BINUNICODE", "SHORT_BINUNICODE", "BINUNICODE8")
"""Operations of a pickle that hold a word."""
_BLOCK = re.compile(r"block(\d+)_items|values_block_(\d+)")
_DATE = re.compile(r"(?:datetime|timedelta)64(?:\[(ns|us|ms|s)\])?")
"""Kind of numbers that are dates, with the unit that they count; nanoseconds where it says none."""
_INDEX = "time"


def find_frame(group: Any) -> str:
    """The kind of frame that a group of a HDF5 file is; empty where it is none."""
    kind = _read_word(group.attrs, _KIND)
    return kind if kind in ("frame", "frame_table", "series", "series_table") else ""


def read_frame(group: Any) -> dict[str, Any]:
    """The columns of a frame and its index by their names; those that hold no numbers are left out.

    An index that only counts the rows is left out; one without a name is the time where no column is.

    Args:
        group: Of the file.
    """
    is_table = "table" in group and group["table"].dtype.names is not None
    columns = dict(_read_table(group["table"]) if is_table else _read_blocks(group))
    index, called, kind = _find_index(group, is_table=is_table)
    has_time = any(word in TIMES for name in columns for word, _ in split_words(name))
    if index is None or (has_time and not called) or np.array_equal(index, np.arange(index.size)):
        return columns
    name = called or _INDEX
    return columns if name in columns else {name: _as_seconds(index, kind), **columns}


def _read_blocks(group: Any) -> Iterator[tuple[str, Any]]:
    for key in group:
        block = _BLOCK.fullmatch(key)
        values = group.get(f"block{block.group(1)}_values") if block and block.group(1) else None
        if values is None or values.dtype.kind not in "buif" or values.ndim > 2:
            continue
        names = [
            one.decode() if isinstance(one, bytes) else str(one) for one in np.atleast_1d(group[key][...]).tolist()
        ]
        yield from _name_columns(names, values[...], _read_word(values.attrs, "value_type"))
    if "values" in group and group["values"].dtype.kind in "buif":
        yield _read_word(group.attrs, "name") or "values", group["values"][...]


def _read_table(table: Any) -> Iterator[tuple[str, Any]]:
    for field in table.dtype.names:
        if field == "index" or table.dtype[field].base.kind not in "buif":
            continue
        names = _list_words(table.attrs.get(f"{field}_kind", b"")) if _BLOCK.fullmatch(field) else [field]
        yield from _name_columns(names, table[field], _read_word(table.attrs, f"{field}_dtype"))


def _name_columns(names: list[str], values: Any, kind: str) -> Iterator[tuple[str, Any]]:
    """Each column of a block, of a table with one value a row too."""
    matrix = values.reshape(len(values), -1)
    if matrix.shape[1] == len(names):
        yield from ((name, _as_seconds(column, kind)) for name, column in zip(names, matrix.T, strict=True))


def _find_index(group: Any, *, is_table: bool) -> tuple[Any, str, str]:
    """The index, its name and its kind; None where it holds no numbers."""
    if is_table:
        table = group["table"]
        if "index" not in table.dtype.names or table.dtype["index"].kind not in "buif":
            return None, "", ""
        words = [*_list_words(group.attrs.get("info", b"")), ""]
        name = words[words.index("index_name") + 1] if "index_name" in words else ""
        return table["index"], "" if name.startswith("values_block") else name, _read_word(table.attrs, "index_kind")
    axis = group.get("axis1", group.get("index"))
    if axis is None or axis.dtype.kind not in "buif" or axis.ndim != 1:
        return None, "", ""
    name = _read_word(axis.attrs, "name")
    return axis[...], "" if name == "N." else name, _read_word(axis.attrs, "kind")


def _as_seconds(values: Any, kind: str) -> Any:
    """Dates as seconds since 1970; other numbers as they are."""
    date = _DATE.match(kind)
    return values * UNITS[date.group(1) or "ns"].factor if date and values.dtype.kind in "iu" else values


def _read_word(attributes: Any, key: str) -> str:
    word = attributes.get(key, b"")
    return word.decode(errors="replace") if isinstance(word, bytes) else word if isinstance(word, str) else ""


def _list_words(pickled: Any) -> list[str]:
    """The words in a pickle, which is read and not run."""
    pickled = pickled.encode() if isinstance(pickled, str) else pickled
    if not isinstance(pickled, bytes):
        return []
    return [str(word) for operation, word, _ in pickletools.genops(pickled) if operation.name in _OF_TEXT]

"""Tables of other programs in Parquet, Feather or Arrow: columns of numbers, of lists of numbers, and structures."""

from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec
import numpy as np

from fricomp.errors import MissingExtraError, RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.sources.cell import is_entry, read_number
from fricomp.recording.sources.columns import Columns, Contents
from fricomp.recording.sources.entry_names import NAMES_OF_ENTRIES
from fricomp.recording.unit import UNITS
from fricomp.recording.validity import Samples
from fricomp.untrusted import parse_json, require_filled

_INFO = Path("meta") / "info.json"
_ARROW = (".feather", ".arrow", ".ipc")
"""Suffixes of the same tables as Arrow keeps them."""
_INDEX = "__index_level_"
"""How pandas calls an index without a name."""
_TRIED = 50
"""Words of a column by which it is told whether they are numbers."""
_LEVELS = 4
"""Folders above an episode in which its data set is looked for."""


def refuse_data_set(folder: Path) -> None:
    """Refuse the folder of a LeRobot data set with one of its files, which are logs.

    Raises:
        RecordingError: It is one.
    """
    episode = min((folder / "data").rglob("*.parquet"), default=None) if (folder / _INFO).is_file() else None
    if episode is not None:
        raise RecordingError(f"{folder} is a data set of many files: give one of them, such as {episode}")


def read_table(path: Path, source: Source) -> Contents:
    """Read a Parquet file: `name` for a column of numbers or words, `name:3` for the third entry of a column of lists.

    Where the data set names the entries, as LeRobot does in meta/info.json, `name.entry` is the same; where a column of
    lists of names does, as in joint states, `entry.name`.

    Raises:
        MissingExtraError: pyarrow is not installed.
        RecordingError: The file is no Parquet file.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError as error:
        raise MissingExtraError("pyarrow", "parquet") from error
    try:
        table = _flatten(_read_arrow(path) if path.suffix.lower() in _ARROW else parquet.read_table(path))
        names = table.column_names
    except (pyarrow.ArrowException, UnicodeDecodeError) as error:
        raise RecordingError(f"{path} is no table of Parquet or Arrow: {error}") from error
    info = _read_info(path)
    named = _entry_names(info)
    columns: Columns = {}
    words: dict[str, list[str]] = {}
    said = _find_name_lists(table)
    for name in names:
        column, stamps = table.column(name), _read_stamps(table.column(name))
        if stamps is not None:
            columns["time" if name.startswith(_INDEX) and "time" not in names else name] = stamps
            continue
        values = column.to_pylist()
        columns.update(_columns_of(name, values, named.get(name, [])))
        columns.update(_columns_by_names(name, values, said.get(name.rpartition(".")[0], [])))
        if any(isinstance(value, str) for value in values):
            words[name] = [value or "" for value in values]
    rate = info.get("fps")
    if "frame_index" in columns and "timestamp" not in columns and isinstance(rate, int | float) and rate > 0:
        columns["timestamp"] = columns["frame_index"] / rate
    return Contents(columns, words)


def _find_name_lists(table: Any) -> dict[str, list[Any]]:
    """The column of lists of names, row by row, by the path that it shares with the lists beside it."""
    from pyarrow import types

    found = {}
    for field in table.schema:
        path, _, last = field.name.rpartition(".")
        is_list = types.is_list(field.type) or types.is_large_list(field.type) or types.is_fixed_size_list(field.type)
        if is_list and last.lower() in NAMES_OF_ENTRIES and _is_text(field.type.value_type):
            found[path] = table.column(field.name).to_pylist()
    return found


def _is_text(kind: Any) -> bool:
    from pyarrow import types

    return bool(types.is_string(kind) or types.is_large_string(kind))


def _columns_by_names(name: str, values: list[Any], names: list[Any]) -> Columns:
    """A column of lists as one for each of the names that stand beside them, in whatever order a row has them."""
    columns: Columns = {}
    different = {entry for entries in names for entry in entries or ()}
    require_filled(len(values), len(different), sum(len(entries or ()) for entries in names))
    for row, (entries, numbers) in enumerate(zip(names, values, strict=False)):
        if not isinstance(numbers, list) or len(entries or ()) != len(numbers):
            continue
        for entry, number in zip(entries, numbers, strict=True):
            if not isinstance(number, int | float):
                return {}
            columns.setdefault(f"{entry}.{name}", np.full(len(values), np.nan))[row] = number
    return columns


def _read_arrow(path: Path) -> Any:
    """The table of a file of Arrow or Feather."""
    from pyarrow import feather

    return feather.read_table(path)


def _flatten(table: Any) -> Any:
    """The table with a column for each field of a structure, `column.field`."""
    from pyarrow import types

    while any(types.is_struct(field.type) for field in table.schema):
        table = table.flatten()
    return table


def _read_stamps(column: Any) -> Samples | None:
    """Dates as seconds since 1970, lengths and times of day as seconds [s]; None of a column of anything else."""
    from pyarrow import types

    if types.is_date(column.type):
        column = column.cast("timestamp[ms]")
    if not (types.is_timestamp(column.type) or types.is_duration(column.type) or types.is_time(column.type)):
        return None
    whole = "int32" if types.is_time32(column.type) else "int64"
    counts = column.cast(whole).to_numpy(zero_copy_only=False).astype(np.float64)
    return np.asarray(counts * UNITS[column.type.unit].factor)


def _columns_of(name: str, values: list[Any], entries: list[str]) -> Columns:
    lists = [value for value in values if isinstance(value, list)]
    if not lists:
        if any(isinstance(value, str | bytes | dict) for value in values):
            return _read_words(name, values)
        return {name: np.array([np.nan if value is None else value for value in values], dtype=np.float64)}
    width = max(map(len, lists))
    require_filled(len(values), width, sum(map(len, lists)))
    matrix = np.full((len(values), width), np.nan)
    for row, value in zip(matrix, values, strict=True):
        numbers = [entry for entry in value or [] if isinstance(entry, int | float)]
        row[: len(numbers)] = numbers
    found: Columns = {f"{name}:{k}": column for k, column in enumerate(matrix.T, start=1)}
    return found | {f"{name}.{entry}": column for entry, column in zip(entries, matrix.T, strict=False)}


def _read_words(name: str, values: list[Any]) -> Columns:
    """A column of numbers or dates that are written as words; nothing where they are others."""
    said = [value for value in values if value]
    if not all(isinstance(value, str) for value in said) or not all(map(is_entry, said[:_TRIED])):
        return {}
    if len({value[:1] for value in said[:_TRIED]} & {"[", "("}) > 0:
        return {}
    return {name: np.array([read_number(value) if value else np.nan for value in values])}


def _entry_names(info: dict[str, Any]) -> dict[str, list[str]]:
    """What the data set calls the entries of its columns; nothing where it does not say."""
    features = info.get("features")
    features = features if isinstance(features, dict) else {}
    return {name: _flat(one.get("names")) for name, one in features.items() if isinstance(one, dict)}


def _read_info(path: Path) -> dict[str, Any]:
    """What is said of the data set that a file is of; nothing where it is of none."""
    for folder in list(path.resolve().parents)[:_LEVELS]:
        file = folder / _INFO
        if file.is_file():
            with suppress(msgspec.DecodeError, OSError):
                info = parse_json(file.read_bytes())
                return info if isinstance(info, dict) else {}
            return {}
    return {}


def _flat(names: Any) -> list[str]:
    """Names of entries, which stand in a list or under the name of an axis."""
    if isinstance(names, dict):
        names = next(iter(names.values()), [])
    return [str(name) for name in names] if isinstance(names, list) else []

"""Tables in JSON: rows or columns under names, names beside bare rows, one series a channel, and the words in them."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from fricomp.recording.sources.cell import read_number
from fricomp.recording.sources.columns import Columns, Contents, columns_of_records, flatten_arrays, flatten_structures
from fricomp.recording.sources.label_word import JOINT_LABELS, SIGNAL_LABELS
from fricomp.recording.validity import Samples
from fricomp.untrusted import require_filled

_FEWEST_ROWS = 10
"""Numbers of a column; fewer are a fact beside the rows, such as a gain a joint."""
_LEVELS = 6
"""Levels of nesting in which a table is looked for."""
_PAIRS = ("values", "datapoints", "points", "data")
"""Where the pairs of time and value of a series stand."""
_BOTH = (
    ("x", "y"),
    ("t", "y"),
    ("t", "v"),
    *((a, b) for a in ("time", "times", "timestamps") for b in ("value", "values")),
)
"""What both are called where each is a list: of the curves of plotly, of queries for metrics."""


_WHEN = ("sourcetimestamp", "source_timestamp", "timestamp", "time", "ts", "t", "servertimestamp", "date", "x")
_WHAT = ("value", "val", "v", "y")
"""What time and value of a point are called where it is an object, in small letters."""


def tabulate(content: Any) -> Contents | None:
    """The table of a document; None where it holds neither rows nor columns.

    Args:
        content: As it was parsed.
    """
    if isinstance(content, list) and not _are_series(content):
        return Contents(columns_of_records(content), _list_words(content))
    if not isinstance(content, dict | list):
        return None
    framed = _read_frame(content)
    if framed:
        return Contents(columns_of_records(framed), _list_words(framed))
    found = _find_series(content) or _find_named_rows(content)
    if found is not None or isinstance(content, list):
        return found
    flat = {name: _read_dates(value) for name, value in flatten_structures(content).items()}
    rows = [value for value in flat.values() if isinstance(value, list) and value and isinstance(value[0], dict)]
    rows = [one for one in rows if len(one) >= _FEWEST_ROWS] or rows
    columns = flatten_arrays(flat)
    said = {name: [value] for name, value in flat.items() if isinstance(value, str)}
    if len(rows) == 1 and all(column.size < _FEWEST_ROWS for column in columns.values()):
        return Contents(columns_of_records(rows[0]), said | _list_words(rows[0]))
    return Contents(columns, said)


def _read_frame(content: Any) -> list[dict[str, Any]]:
    """The rows of a data frame that was written by its index, row by row or column by column; empty of anything else.

    An index that does not count the rows is their time.
    """
    inside = list(content.values()) if isinstance(content, dict) else []
    if len(inside) < 2 or not all(isinstance(one, dict) for one in inside):
        return []
    if len(inside) >= _FEWEST_ROWS and _are_numbers(content):
        rows = [(float(key), row) for key, row in content.items()]
    elif (
        len(inside[0]) >= _FEWEST_ROWS
        and _are_numbers(inside[0])
        and all(one.keys() == inside[0].keys() for one in inside)
    ):
        rows = [(float(key), {name: column[key] for name, column in content.items()}) for key in inside[0]]
    else:
        return []
    counts = all(key == number for number, (key, _) in enumerate(rows))
    return [row if counts else {"time": key, **row} for key, row in rows]


def _are_numbers(keys: Iterable[str]) -> bool:
    return all(key.replace(".", "", 1).isdigit() for key in keys)


def _read_dates(value: Any) -> Any:
    """A list of dates, or of numbers in quotes, as numbers; anything else as it is."""
    is_said = isinstance(value, list) and bool(value) and all(isinstance(one, str) for one in value)
    numbers = np.array([_to_number(one) for one in value]) if is_said else np.empty(0)
    return numbers if np.isfinite(numbers).any() else value


def _list_words(records: Sequence[Any]) -> dict[str, list[str]]:
    """The words of each row under their path; of rows that are lists none."""
    rows = [dict(_walk_words(record)) for record in records if isinstance(record, Mapping)]
    names = dict.fromkeys(name for row in rows for name in row)
    require_filled(len(rows), len(names), sum(map(len, rows)))
    return {name: [row.get(name, "") for row in rows] for name in names}


def _walk_words(record: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, str]]:
    for name, value in record.items():
        if isinstance(value, str):
            yield f"{prefix}{name}", value
        elif isinstance(value, Mapping):
            yield from _walk_words(value, f"{prefix}{name}.")


def _walk(content: Any, level: int = 0) -> Iterator[Any]:
    """A document and all objects and lists of objects in it, down to some depth."""
    yield content
    if level < _LEVELS and isinstance(content, dict):
        for value in content.values():
            yield from _walk(value, level + 1)
    elif level < _LEVELS and isinstance(content, list) and content and isinstance(content[0], dict):
        for value in content[:_FEWEST_ROWS]:
            yield from _walk(value, level + 1)


def _find_named_rows(content: Any) -> Contents | None:
    """The only table whose names stand in a list beside its rows or its columns."""
    tables = [table for one in _walk(content) if isinstance(one, dict) and (table := _read_named_rows(one))]
    return tables[0] if len(tables) == 1 else None


def _read_named_rows(one: dict[str, Any]) -> Contents | None:
    inside = [value for sub in one.values() if isinstance(sub, dict) for value in sub.values()]
    lists = [value for value in (*one.values(), *inside) if isinstance(value, list) and len(value) > 1]
    names = next((found for value in lists if (found := _read_names(value))), [])
    tables = [rows for rows in lists if names and all(isinstance(row, list) for row in rows)]
    tables = [rows for rows in tables if len(names) in (len(rows), len(rows[0])) and len(set(map(len, rows))) == 1]
    if len(tables) != 1:
        return None  # of several, the names are those of the entries of all
    rows = tables[0]
    if len(rows) >= _FEWEST_ROWS and len(rows[0]) == len(names):
        return _make_table_of_rows(names, rows)
    return _make_table(dict(zip(names, rows, strict=True))) if len(rows[0]) >= _FEWEST_ROWS else None


def _make_table_of_rows(names: Sequence[str], rows: Sequence[list[Any]]) -> Contents:
    """The table of rows of cells, which may hold lists."""
    if any(isinstance(cell, list | dict) for cell in rows[0]):
        records = [dict(zip(names, row, strict=True)) for row in rows]
        return Contents(columns_of_records(records), _list_words(records))
    return _make_table(dict(zip(names, zip(*rows, strict=True), strict=True)))


def _read_names(values: list[Any]) -> list[str]:
    """The names that a list consists of, as words or as objects with a name; empty where it is no such list."""
    said = [one.get("name") if isinstance(one, dict) else one for one in values]
    names = [name for name in said if isinstance(name, str)]
    return names if len(names) == len(said) == len(set(names)) else []


def _make_table(cells: Mapping[str, Sequence[Any]]) -> Contents:
    columns: Columns = {name: np.array([_to_number(one) for one in own]) for name, own in cells.items()}
    words = {
        name: [one if isinstance(one, str) else "" for one in own]
        for name, own in cells.items()
        if not np.isfinite(columns[name]).any()
    }
    return Contents(columns, words)


def _to_number(value: Any) -> float:
    if isinstance(value, bool | int | float):
        return float(value)
    return read_number(value) if isinstance(value, str) else float("nan")


def _find_series(content: Any) -> Contents | None:
    """The first list of several series in a document as one table, each in rows of its own."""
    tried = (found for one in _walk(content) for found in (one, _list_named_series(one)))
    series = next((one for one in tried if _are_series(one)), None)
    if series is None:
        return None
    times, parts = [], []
    for number, one in enumerate(series, start=1):
        pairs: Samples = np.array([[_to_number(value) for value in pair] for pair in _get_pairs(one)])
        when = int(np.argmax(np.nanmean(np.diff(pairs, axis=0) > 0.0, axis=0)))
        times.append(pairs[:, when])
        parts.append((_name_series(one) or f"series_{number}", pairs[:, 1 - when]))
    starts = np.cumsum([0, *(time.size for time in times)])
    columns: Columns = {"time": np.concatenate(times)}
    for (name, values), start in zip(parts, starts[:-1], strict=True):
        column = np.full(starts[-1], np.nan)
        column[start : start + values.size] = values
        columns[name] = column
    return Contents(columns, {})


def _are_series(content: Any) -> bool:
    """Whether a list has two and more objects with pairs of time and value."""
    some = isinstance(content, list) and 1 < len(content) <= 10 * _FEWEST_ROWS
    return some and all(isinstance(one, dict) and bool(_get_pairs(one)) for one in content)


def _list_named_series(content: Any) -> list[dict[str, Any]]:
    """The series of an object that has the points of each under its name: `{"position": [{"ts": 1, "value": 2}]}`."""
    inside = content if isinstance(content, dict) else {}
    return [{"name": name, "points": points} for name, points in inside.items() if _are_points(points)]


def _are_points(points: Any) -> bool:
    return isinstance(points, list) and bool(_read_objects(points))


def _get_pairs(series: dict[str, Any]) -> list[Any]:
    lists = {key: value for key, value in series.items() if isinstance(value, list) and len(value) >= _FEWEST_ROWS}
    if len(lists) == 2 and any(set(lists) == set(both) for both in _BOTH) and len({*map(len, lists.values())}) == 1:
        return [list(pair) for pair in zip(*lists.values(), strict=True)]
    pairs: list[Any] = next((series[name] for name in _PAIRS if isinstance(series.get(name), list)), [])
    pairs = _read_objects(pairs) or pairs
    is_long = len(pairs) >= _FEWEST_ROWS
    return pairs if is_long and all(isinstance(pair, list) and len(pair) == 2 for pair in pairs) else []


def _read_objects(points: list[Any]) -> list[list[Any]]:
    """Pairs of time and value of points that are objects with both, as histories of OPC UA have them; else empty."""
    if len(points) < _FEWEST_ROWS or not all(isinstance(one, dict) for one in points):
        return []
    small = [{key.lower(): value for key, value in one.items()} for one in points]
    when = next((key for key in _WHEN if key in small[0]), "")
    what = next((key for key in _WHAT if key in small[0]), "")
    return [[one.get(when), one.get(what)] for one in small] if when and what else []


def _name_series(series: dict[str, Any]) -> str:
    """What a series is called, with its joint before it where that is said."""
    facts = [series, *(value for value in series.values() if isinstance(value, dict))]
    return "/".join(filter(None, (_find_word(facts, keys) for keys in (JOINT_LABELS, SIGNAL_LABELS))))


def _find_word(facts: Sequence[dict[str, Any]], keys: Sequence[str]) -> str:
    """The first word that stands under one of these keys, in capitals or not; empty where none does."""
    small = [{key.lower(): value for key, value in one.items()} for one in facts]
    return next((one[key] for one in small for key in keys if isinstance(one.get(key), str)), "")

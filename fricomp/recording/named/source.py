"""The columns of a file, whatever its format, by their names."""

import csv
import itertools
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.number_rows import read_head, read_number_rows
from fricomp.recording.quantity_word import says_asked_for
from fricomp.recording.sources import Contents, is_text, read_contents
from fricomp.recording.sources.can_frames import refuse_bytes, refuse_frames
from fricomp.recording.sources.cell import number_or_nan, read_number
from fricomp.recording.sources.printed.plain_table import as_table
from fricomp.recording.sources.reader import refuse_damage
from fricomp.recording.sources.robot_log import read_ros_topics, read_topics, tabulate_topics
from fricomp.recording.sources.simulation_text import refuse_simulation
from fricomp.recording.sources.text import cut_rows, find_encoding, read_lines
from fricomp.recording.sources.text_layout import FIRST_LINES, TextLayout, find_layout
from fricomp.recording.sources.text_line import part_touching
from fricomp.recording.sources.topic import Topic, is_bare
from fricomp.recording.validity import Samples
from fricomp.untrusted import require_filled

from .choice import TORQUES
from .column import read_column_name
from .entries import drop_numbered_twins, fill_spans, name_listed, number_repeated
from .long_rows import separate_long_rows
from .sparse import place_pairs, place_series
from .times.clock import find_stamps

_BAGS = (".db3", ".bag")
"""Suffixes of the files of bags."""
_UNITS = ("unit", "units")
"""Names under which a unit stands beside its numbers."""
_LONGEST_LINE = 100_000
"""Characters of a first line that are looked at."""
_PLAIN_NUMBER = re.compile(r"[+-]?[\d.]+([eE][+-]?\d+)?")
_DIGIT = re.compile(r"\d")
_MOST_UNREAD = 0.05
"""Part of the cells of a quantity that hold digits and are no numbers, above which it is refused."""


def is_bag_folder(path: Path) -> bool:
    """Whether a folder is a rosbag2."""
    return path.is_dir() and (path / "metadata.yaml").is_file()


def read_named_columns(path: Path) -> dict[str, Samples]:
    """All columns of numbers of a file that have a name.

    Args:
        path: CSV or text with a header, Parquet, MAT, NPZ, JSON, MCAP or a bag.

    Raises:
        RecordingError: The file cannot be read, or its columns have no names.
        MissingExtraError: The package that reads it is not installed.
    """
    refuse_simulation(path)
    if path.is_file() and is_text(path):
        return _read_text(path)
    topics = _read_topics(path)
    found = (
        Contents(tabulate_topics(topics, _choose_topics(topics), path), {}) if topics else read_contents(path, Source())
    )
    columns, words = found
    named = {name: np.asarray(values) for name, values in columns.items() if isinstance(name, str)}
    return separate_long_rows(_with_said_units(place_series(drop_numbered_twins(named)), words), words)


def _with_said_units(columns: dict[str, Samples], words: Mapping[str, list[str]]) -> dict[str, Samples]:
    """The columns with the unit in brackets behind their name that is said beside them.

    `{"angle": {"value": 12.3, "unit": "deg"}}`, `{"units": {"angle": "deg"}, "angle": [12.3]}`, `angle_unit`.

    Args:
        columns: By name.
        words: What is said in words, by name.
    """
    said: dict[str, str] = {}
    for name, cells in words.items():
        path, _, last = name.rpartition(".")
        units = set(cells) - {""}
        if len(units) != 1:
            continue
        if last.lower() in _UNITS:
            said[path] = units.pop()
        elif path.rpartition(".")[2].lower() in _UNITS:
            said[last] = units.pop()
        elif last.lower().endswith(tuple(f"_{one}" for one in _UNITS)):
            said[name.rpartition("_")[0]] = units.pop()
    said.pop("", None)
    owners = {name: next((one for one in _list_owners(name) if one in said), "") for name in columns}
    return {
        f"{name} [{said[owner]}]" if owner in said and "[" not in name else name: columns[name]
        for name, owner in owners.items()
    }


def _list_owners(name: str) -> tuple[str, str, str]:
    """Under which names the unit of a column may be said: its own, that of what it is in, its last part."""
    path, _, last = name.rpartition(".")
    return name, path, last


def choose_topics(path: Path) -> Source:
    """How the topics of an MCAP file are read without a mapping: that with the positions leads, others with a quantity
    are joined to it.

    Where no topic or several have positions nothing is joined, and each message is a row: these are devices of one
    kind.

    Raises:
        RecordingError: The file cannot be read.
        MissingExtraError: The package that reads it is not installed.
    """
    return _choose_topics(_read_topics(path))


def _read_topics(path: Path) -> dict[str, Topic]:
    """Messages of an MCAP file or a bag by topic; empty for any other file, and where joint states say all."""
    is_mcap = path.is_file() and path.suffix.lower() == ".mcap"
    if not (is_mcap or is_bag_folder(path) or path.suffix.lower() in _BAGS):
        return {}
    with refuse_damage(path, "mcap" if is_mcap else "rosbag2"):
        return (read_topics(path) if is_mcap else {}) or read_ros_topics(path, _is_of_joint)


def _is_of_joint(name: str, record: dict[str, Any]) -> bool:
    """Whether a topic has a position or a torque, by its name and one message."""
    return bool(_list_quantities(name, Topic([0.0], [record])) & {"position", "motor_position", *TORQUES})


def _choose_topics(topics: Mapping[str, Topic]) -> Source:
    said = {name: _list_quantities(name, topic) for name, topic in topics.items() if len(topic.records) > 1}
    for channel in ("position", "motor_position"):
        leads = [name for name, quantities in said.items() if channel in quantities]
        leads = [name for name in leads if not says_asked_for(name)] or leads
        if leads:
            break
    others = tuple(sorted(name for name, quantities in said.items() if quantities and name not in leads))
    return Source(topic=leads[0], join=others) if len(leads) == 1 and others else Source()


def _list_quantities(name: str, topic: Topic) -> set[str]:
    """What the columns of a topic are, by their names, or by its own where these say nothing; its time is none."""
    columns = [f"{name}.{key}" if is_bare(key) else str(key) for key in topic.to_columns() if key != "time"]
    meanings = [read_column_name(one) for one in columns]
    return {one.channel for one in meanings if one is not None} - {"time"}


class FirstLines(NamedTuple):
    """How a text file begins.

    Attributes:
        states_schema: Its first line says that it is a recording.
        rows: The first lines that are neither empty nor comments, each cut to 100,000 characters.
    """

    states_schema: bool
    rows: tuple[str, ...]


def read_first_lines(path: Path, count: int) -> FirstLines:
    """The first lines of a text file that hold something."""
    with path.open(encoding=find_encoding(path), errors="replace") as stream:
        first = stream.readline(_LONGEST_LINE)
        lines = (line for line in itertools.chain([first], stream) if line.strip() and not line.startswith("#"))
        rows = tuple(line[:_LONGEST_LINE] for line in itertools.islice(lines, count))
    return FirstLines(first.startswith("# fricomp.recording/"), rows)


def has_rows(path: Path) -> bool:
    """Whether a text has rows of numbers at all."""
    try:
        read_layout(path)
    except RecordingError:
        return False
    return True


def read_layout(path: Path) -> TextLayout:
    """How a text table is laid out.

    Raises:
        RecordingError: It is no text, or no line of it is a row of numbers.
    """
    with path.open(encoding=find_encoding(path), errors="replace") as stream:
        lines = [line[:_LONGEST_LINE] for line in itertools.islice(stream, FIRST_LINES)]
    with suppress(RecordingError):
        return _require_layout(path, as_table(lines))
    return _require_layout(path, [line[:_LONGEST_LINE] for line in read_lines(path)[:FIRST_LINES]])  # a channel a block


def _require_layout(path: Path, lines: Sequence[str]) -> TextLayout:
    try:
        layout = find_layout(lines)
    except csv.Error as error:
        raise RecordingError(f"{path} is no table of text: {error}") from error
    refuse_frames(path, lines)
    if layout is None:
        refuse_bytes(path, lines)
        shown = next((line.strip() for line in lines if line.strip()), "")[:60]
        if not shown:
            raise RecordingError(f"{path} is empty: give a table with one column a quantity")
        raise RecordingError(
            f"{path} has no rows of numbers below its first line {shown!r}: give a table with one column a quantity"
        )
    return layout


def _read_text(path: Path) -> dict[str, Samples]:
    """Columns of a text table with a line of names; a cell such as `[0.1, 0.2]` is several."""
    fast = _read_large_text(path)
    if fast is not None:
        return separate_long_rows(place_pairs(fast), {})
    lines = read_lines(path)
    layout = _require_layout(path, [line[:_LONGEST_LINE] for line in lines[:FIRST_LINES]])
    if not layout.names:
        raise RecordingError(explain_unnamed(path))
    rows = _cut_rows(path, lines, layout, len(layout.names))
    names = number_repeated(fill_spans(_name_index(layout.names, rows)), rows)
    require_filled(len(rows), len(names), sum(map(len, rows)))
    columns: dict[str, Samples] = {}
    words: dict[str, list[str]] = {}
    for k, name in enumerate(names):
        cells = [row[k] if k < len(row) else "" for row in rows]
        found = _read_cells(name, cells, layout.decimal)
        _require_numbers(path, name, cells, found)
        if any(one in columns and not np.array_equal(columns[one], new, equal_nan=True) for one, new in found.items()):
            continue
        columns.update(found)
        if not any(np.isfinite(values).any() for values in found.values()):
            words[name] = cells
    return separate_long_rows(name_listed(place_pairs(columns), words), words)


def _require_numbers(path: Path, name: str, cells: Sequence[str], found: Mapping[str, Samples]) -> None:
    """Refuse a quantity of whose cells with digits many are read as no number: what is left of them would be believed.

    Raises:
        RecordingError: It is such a column.
    """
    values = found.get(name)
    if values is None or read_column_name(name) is None or not np.isfinite(values).any():
        return
    unread = [cell for cell, value in zip(cells, values, strict=True) if not np.isfinite(value) and _DIGIT.search(cell)]
    if len(unread) > _MOST_UNREAD * len(cells):
        raise RecordingError(
            f"{path}: {len(unread)} of {len(cells)} cells of {name!r} are not read as numbers, such as {unread[0]!r}: "
            "write them with a point or a comma before the decimals and nothing else"
        )


def _read_large_text(path: Path) -> dict[str, Samples] | None:
    """Columns of a large table that holds nothing but numbers; None where it must be read with care."""
    head = read_head(path)
    if head is None:
        return None
    lines = head[0].splitlines(keepends=True)
    layout = find_layout(lines[:FIRST_LINES])
    if layout is None:
        return None
    names = [name.strip() for name in layout.names or ()]
    is_clear = all(names) and len(set(names)) == len(names) and len(layout.delimiter) == 1
    if not names or not is_clear:
        return None
    start = head[1] + sum(len(line.encode()) for line in lines[: layout.rows_line])
    return read_number_rows(path, start, names, delimiter=layout.delimiter, decimal=layout.decimal)


def explain_unnamed(path: Path) -> str:
    """What to do with a table that has no names."""
    return (
        f"{path} has no line of names above its numbers: write one, such as time,position,torque, or say by --mapping "
        f"which column is which ('fricomp convert {path} --inspect' shows them by their numbers, with a mapping to "
        "edit)"
    )


def _name_index(names: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """The names with that of the first column as a time where it has none and holds times, as data frames write it.

    Dates are times, and so are numbers that rise by other steps than those of rows, where no column is called as one.
    """
    first = rows[0][0] if rows and rows[0] else ""
    if names[0] or "time" in names or not np.isfinite(read_number(first)):
        return list(names)
    is_date = any(mark in first for mark in ":-") and not _PLAIN_NUMBER.fullmatch(first.strip())
    if not is_date:
        values = np.array([read_number(row[0]) for row in rows])
        counts = bool(np.all(values == np.round(values)))
        if counts or not np.all(np.diff(values) > 0.0) or find_stamps(names):
            return list(names)
    return ["time", *names[1:]]


def _cut_rows(path: Path, lines: Sequence[str], layout: TextLayout, width: int = 0) -> list[list[str]]:
    """The cells of the rows; between white space numbers may touch. Without a width that of the first rows is meant."""
    rows = [cells for _, cells in cut_rows(path, lines[layout.rows_line :], layout.delimiter, layout.rows_line + 1)]
    if layout.delimiter:
        return rows
    width = width or max(map(len, rows[:FIRST_LINES]), default=0)
    return [part_touching(row, width) for row in rows]


def read_unnamed_columns(path: Path) -> dict[str, Samples]:
    """Columns of a text table without names, by their numbers from 1.

    Raises:
        RecordingError: It is no table of numbers.
    """
    lines = read_lines(path)
    layout = _require_layout(path, [line[:_LONGEST_LINE] for line in lines[:FIRST_LINES]])
    rows = _cut_rows(path, lines, layout)
    numbers = range(max(map(len, rows), default=0))
    require_filled(len(rows), len(numbers), sum(map(len, rows)))
    return {str(k + 1): np.array([number_or_nan(row, k, layout.decimal) for row in rows]) for k in numbers}


def _read_cells(name: str, cells: list[str], decimal: str) -> dict[str, Samples]:
    """A column of numbers or of dates, or one for each entry of its lists; of words nothing but NaN."""
    if cells and cells[0][:1] in ("[", "("):
        entries = [[read_number(each) for each in cell.strip("[]()").replace(",", " ").split()] for cell in cells]
        width = max(map(len, entries))
        require_filled(len(entries), width, sum(map(len, entries)))
        matrix = np.full((len(entries), width), np.nan)
        for row, numbers in zip(matrix, entries, strict=True):
            row[: len(numbers)] = numbers
        return {f"{name}:{k}": column for k, column in enumerate(matrix.T, start=1)}
    return {name: np.array([number_or_nan((cell,), 0, decimal) for cell in cells])}

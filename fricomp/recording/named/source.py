"""The columns of a file, whatever its format, by their names."""

from __future__ import annotations

import csv
import itertools
import re
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.mapping import Source
from fricomp.recording.sources import read_columns
from fricomp.recording.sources.text import find_encoding, parse_number
from fricomp.recording.validity import Samples
from fricomp.untrusted import find_size_limit

from .column import read_column_name

__all__ = [
    "FirstLines",
    "find_delimiter",
    "is_bag_folder",
    "read_first_lines",
    "read_named_columns",
    "read_quantity_files",
]

_TEXT = (".csv", ".txt", ".dat", ".tsv")
_MARKS = ",;\t|"
_LONGEST_LINE = 10_000
"""Characters of a first line that are looked at."""
_TIME_FILE = re.compile(r"(^|[_\W])(t|time|times|stamps?|timestamps?)$", re.IGNORECASE)


def is_bag_folder(path: Path) -> bool:
    """Whether a folder is a rosbag2."""
    return path.is_dir() and (path / "metadata.yaml").is_file()


def read_named_columns(path: Path, topic: str = "") -> dict[str, Samples]:
    """All columns of numbers of a file that have a name.

    Args:
        path: CSV or text with a header, Parquet, MAT, NPZ, JSON, MCAP or a bag.
        topic: Of a bag with several.

    Raises:
        RecordingError: The file cannot be read, or its columns have no names.
        MissingExtraError: The package that reads it is not installed.
    """
    if path.is_file() and path.suffix.lower() in _TEXT:
        try:
            return _read_text(path)
        except csv.Error as error:
            raise RecordingError(f"{path} is no table of text: {error}") from error
    columns = read_columns(path, Source(topic=topic), ())
    return {name: np.asarray(values) for name, values in columns.items() if isinstance(name, str)}


class FirstLines(NamedTuple):
    """How a text file begins.

    Attributes:
        states_schema: Its first line says that it is a recording.
        rows: The first lines that are neither empty nor comments, each cut to 10,000 characters.
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


def find_delimiter(head: str) -> str:
    """The mark between the names in the first line of a text table."""
    return max(_MARKS, key=head.count)


def _read_text(path: Path) -> dict[str, Samples]:
    """Columns of a text table with a header; a cell such as `[0.1, 0.2]` is several."""
    if path.stat().st_size > find_size_limit(path):
        raise RecordingError(f"{path} is too large for a log of text: cut it, or write it as Parquet")
    with path.open(encoding=find_encoding(path), errors="replace", newline="") as stream:
        lines = (line for line in stream if line.strip() and not line.startswith("#"))
        head = next(lines, "")
        mark = find_delimiter(head)
        names = [cell.strip() for cell in next(csv.reader([head], delimiter=mark), [])]
        if all(np.isfinite(_to_number(name)) for name in names):
            raise RecordingError(
                f"{path} has no line of names above its numbers: say by --mapping which column is which "
                "(docs/recordings.md)"
            )
        rows = [row for row in csv.reader(lines, delimiter=mark) if row]
    decimal = "," if mark != "," else "."
    columns: dict[str, Samples] = {}
    for k, name in enumerate(names):
        columns.update(_read_cells(name, [row[k].strip() if k < len(row) else "" for row in rows], decimal))
    return columns


def _read_cells(name: str, cells: list[str], decimal: str) -> dict[str, Samples]:
    """A column of numbers or of dates, or one for each entry of its lists; nothing of a column of words."""
    if cells and cells[0][:1] in ("[", "("):
        entries = [[_to_number(each) for each in cell.strip("[]()").replace(",", " ").split()] for cell in cells]
        width = max(map(len, entries))
        matrix = np.full((len(entries), width), np.nan)
        for row, numbers in zip(matrix, entries, strict=True):
            row[: len(numbers)] = numbers
        return {f"{name}:{k}": column for k, column in enumerate(matrix.T, start=1)}
    values = np.array([_to_number(cell, decimal) for cell in cells])
    return {name: values} if np.isfinite(values).any() else {}


def _to_number(text: str, decimal: str = ".") -> float:
    try:
        return parse_number(text, decimal)
    except ValueError:
        return float("nan")


def read_quantity_files(folder: Path) -> dict[str, Samples]:
    """Columns of a folder that holds one quantity a file, all joints in each, without names: `q.txt`, `tau.txt`.

    A file of as many numbers as there are times, or a whole multiple, is read row by row.

    Returns:
        Named `position:1` and so on, and `time`; empty where the folder is no such.
    """
    files = [path for path in sorted(folder.iterdir()) if path.suffix.lower() in _TEXT and path.is_file()]
    times = [path for path in files if _TIME_FILE.search(path.stem)]
    meanings = {path: read_column_name(path.stem) for path in files if path not in times}
    if len(times) != 1 or not any(one is not None and one.channel == "position" for one in meanings.values()):
        return {}
    try:
        time = _load_numbers(times[0]).ravel()
        columns = {"time": time}
        for path, meaning in meanings.items():
            if meaning is None:
                continue
            values = _load_numbers(path)
            if values.size % time.size:
                raise RecordingError(f"{path} has {values.size} numbers, and {times[0].name} {time.size} times")
            for k, column in enumerate(values.reshape(time.size, -1).T, start=1):
                columns[f"{meaning.channel}:{k}"] = column
    except ValueError:
        return {}
    return columns


def _load_numbers(path: Path) -> Samples:
    with path.open(encoding="utf-8", errors="replace") as stream:
        mark = "," if "," in stream.readline() else None
    return np.asarray(np.loadtxt(path, delimiter=mark, dtype=np.float64))

"""Text tables: comma, tab or space separated, with or without a header line."""

import codecs
import re
from collections.abc import Collection
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.mapping import Column, Source
from fricomp.recording.sources.columns import Columns

_MARKED = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
_SAMPLE = 2**20
"""Bytes by which an encoding is told."""
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")


def read_text(path: Path, source: Source, keys: Collection[Column], *, skip_bad_rows: bool) -> Columns:
    """Read the wanted columns of a text table.

    Args:
        path: File to read.
        source: Delimiter, header, lines to skip.
        keys: Wanted columns, by name or number; others may hold anything.
        skip_bad_rows: Give NaN for a cell that is missing or no number, instead of an error.

    Raises:
        RecordingError: A wanted cell is missing or no number, or a column is asked for by a name that no header gives.
    """
    _refuse_names(path, source, keys)
    lines = path.read_text(encoding=find_encoding(path), errors="replace").splitlines()[source.skip_lines :]
    separator = source.delimiter or None
    decimal = source.decimal or ("." if separator == "," else ",")
    header = [cell.strip().strip('"') for cell in lines.pop(0).split(separator)] if source.header and lines else []
    if len(header) == 1 and any(mark in header[0] for mark in ";\t") and not set(header) & set(keys):
        raise RecordingError(f"{path}: the header {header[0][:60]!r} is one name; {_hint(header, 0)}")
    first_line = source.skip_lines + bool(source.header) + 1
    rows = [(number, line.split(separator)) for number, line in enumerate(lines, first_line) if line.strip()]
    if not rows:
        raise RecordingError(f"{path} holds no rows")
    indices = {key: index for key in keys if (index := _find_index(key, header)) is not None}
    if skip_bad_rows:
        return {key: np.array([_number_or_nan(cells, k, decimal) for _, cells in rows]) for key, k in indices.items()}
    return {key: _parse_column(rows, k, key, path, decimal) for key, k in indices.items()} | _names_only(
        header, indices
    )


def find_encoding(path: Path) -> str:
    """Encoding of a text file: what its byte order mark says, else UTF-8, else that of western Windows.

    Raises:
        RecordingError: It is none of them, or has bytes that no text has.
    """
    with path.open("rb") as stream:
        start = stream.read(_SAMPLE)
    for mark, encoding in _MARKED.items():
        if start.startswith(mark):
            return encoding
    for encoding in ("utf-8", "cp1252"):
        try:
            text = codecs.getincrementaldecoder(encoding)().decode(start)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return encoding
    raise RecordingError(f"{path} is no text file: name its format in a mapping, or give another file")


def _refuse_names(path: Path, source: Source, keys: Collection[Column]) -> None:
    """Without a header line columns have numbers only."""
    names = [key for key in keys if isinstance(key, str)]
    if names and not source.header:
        raise RecordingError(
            f"{path} is read without a header line, so that no column is called {names[0]!r}: set header = true under "
            "[source] of the mapping if the first line holds the names, or give the column's number, without quotes"
        )


def _find_index(key: Column, header: list[str]) -> int | None:
    if isinstance(key, int):
        return key - 1 if key > 0 else None
    return header.index(key) if key in header else None


def _names_only(header: list[str], indices: dict[Column, int]) -> Columns:
    """Columns nobody asked for, empty: so that an error about a missing one can list them."""
    return {name: np.empty(0) for name in header if name and name not in indices}


def _parse_column(
    rows: list[tuple[int, list[str]]], index: int, key: Column, path: Path, decimal: str
) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    try:
        return np.array([parse_number(cells[index], decimal) for _, cells in rows])
    except (ValueError, IndexError):
        for number, cells in rows:
            if not np.isfinite(_number_or_nan(cells, index, decimal)):
                what = f"{cells[index].strip()[:40]!r} is no number" if index < len(cells) else "the cell is missing"
                raise RecordingError(f"{path}, line {number}, column {key}: {what}; {_hint(cells, index)}") from None
        raise


def _hint(cells: list[str], index: int) -> str:
    """What to write in the mapping, by what the line looks like."""
    line = ",".join(cells)
    if ";" in line or "\t" in line:
        mark = '";"' if ";" in line else '"\\t"'
        return f'the line looks as if delimiter = {mark}, with decimal = "," where numbers have commas'
    if index < len(cells) and _DECIMAL_COMMA.fullmatch(cells[index].strip()):
        return 'write decimal = "," under [source] of the mapping'
    return "set skip_bad_rows, or header, delimiter, decimal and skip_lines in the mapping"


def parse_number(cell: str, decimal: str) -> float:
    """A number, also with a decimal comma; of a date and time by ISO 8601 the seconds since 1970 [s].

    Raises:
        ValueError: It is none.
    """
    text = cell.strip().strip('"')
    if decimal == "," and _DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    try:
        return float(text)
    except ValueError:
        stamp = datetime.fromisoformat(text)
        return (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)).timestamp()


def _number_or_nan(cells: list[str], index: int, decimal: str) -> float:
    try:
        return parse_number(cells[index], decimal)
    except (ValueError, IndexError):
        return float("nan")

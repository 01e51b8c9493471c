"""Text tables: comma, tab or space separated, with or without a header line."""

import codecs
import csv
import re
from collections.abc import Collection, Sequence
from pathlib import Path

import numpy as np

from fricomp.errors import RecordingError
from fricomp.recording.mapping import Column, Source
from fricomp.recording.number_rows import read_head, read_number_rows
from fricomp.recording.quantity_word import count_known
from fricomp.recording.sources.cell import DECIMAL_COMMA, number_or_nan, parse_number
from fricomp.recording.sources.columns import Columns
from fricomp.recording.sources.printed.plain_table import as_table
from fricomp.recording.sources.text_line import is_comment, split_cells
from fricomp.untrusted import find_size_limit

_MARKED = {codecs.BOM_UTF8: "utf-8-sig", codecs.BOM_UTF16_LE: "utf-16", codecs.BOM_UTF16_BE: "utf-16"}
_SAMPLE = 2**20
"""Bytes by which an encoding is told."""
_ENCODINGS = ("cp1252", "gb18030", "big5", "cp932", "cp949", "cp1251")
"""Those of Windows beside UTF-8: western, simplified and traditional Chinese, Japanese, Korean, Cyrillic."""
_KINDS = {
    b"PK\x03\x04": "a spreadsheet (.xlsx) or an archive (.zip, .npz)", b"\x89HDF": "HDF5 (.h5)",
    b"\x80\x03": "a pickle (.pkl)", b"\x80\x04": "a pickle (.pkl)", b"\x80\x05": "a pickle (.pkl)",
    b"\x1f\x8b": "a compressed file (.gz)", b"PAR1": "Parquet (.parquet)", b"ARROW1": "Arrow (.arrow)",
    b"SQLite format 3": "a data base (.db)", b"\xd0\xcf\x11\xe0": "a spreadsheet (.xls)", b"MATLAB 5.0": "MAT (.mat)",
    b"MATLAB 7.3": "MAT of version 7.3 (.mat)", b"\x93NUMPY": "NPY (.npy)", b"\x89MCAP": "MCAP (.mcap)",
    b"TDSm": "a LabVIEW TDMS (.tdms)",
}  # fmt: skip
"""First bytes of formats that are called as texts at times."""
_NULS = re.compile("\0{8,}")
"""What a card holds where power failed before it was written: the rows that it cuts are none."""
_HEADING = 4000
"""Characters of a text in which its names are looked for."""
_CELL = re.compile(r"[^,;\t|\r\n]+")


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
    numbers = _read_large(path, source, keys)
    if numbers is not None:
        return numbers
    lines = read_lines(path)[source.skip_lines :]
    decimal = _find_decimal(source)
    header = split_cells(lines.pop(0), source.delimiter) if source.header and lines else []
    if len(header) == 1 and any(mark in header[0] for mark in ";\t") and not set(header) & set(keys):
        raise RecordingError(f"{path}: the header {header[0][:60]!r} is one name; {_hint(header, 0)}")
    rows = cut_rows(path, lines, source.delimiter, source.skip_lines + bool(source.header) + 1)
    if not rows:
        raise RecordingError(f"{path} holds no rows")
    indices = {key: index for key in keys if (index := _find_index(key, header)) is not None}
    if skip_bad_rows:
        return {key: np.array([number_or_nan(cells, k, decimal) for _, cells in rows]) for key, k in indices.items()}
    return {key: _parse_column(rows, k, key, path, decimal) for key, k in indices.items()} | _names_only(
        header, indices
    )


def _read_large(path: Path, source: Source, keys: Collection[Column]) -> Columns | None:
    """The wanted columns of a large table of numbers; None where it must be read with care."""
    head = read_head(path)
    first = source.skip_lines + source.header
    lines = head[0].splitlines(keepends=True) if head else []
    if head is None or len(lines) <= first or len(source.delimiter) != 1:
        return None
    header = split_cells(lines[source.skip_lines], source.delimiter) if source.header else []
    numbers = [str(k) for k in range(lines[first].count(source.delimiter) + 1)]
    indices = {key: _find_index(key, header) for key in keys}
    if any(index is None or index >= len(numbers) for index in indices.values()):
        return None
    # The first column too: a row that a mark before it makes a comment is no row of numbers.
    wanted = [number for k, number in enumerate(numbers) if k == 0 or k in indices.values()]
    start = head[1] + sum(len(line.encode()) for line in lines[:first])
    columns = read_number_rows(path, start, numbers, wanted, delimiter=source.delimiter, decimal=_find_decimal(source))
    return None if columns is None else {key: columns[str(index)] for key, index in indices.items()}


def read_lines(path: Path) -> list[str]:
    """The lines of a text file, whatever its encoding.

    Raises:
        RecordingError: It is no text, or larger than any log.
    """
    if path.stat().st_size > find_size_limit(path):
        raise RecordingError(f"{path} is too large for a log of text: cut it, or write it as Parquet")
    text = path.read_text(encoding=find_encoding(path), errors="replace")
    if "\0" in text:
        text = _NULS.sub("?\n?", text)
    return as_table(text.splitlines(), is_whole=text.endswith("\n"))


def cut_rows(path: Path, lines: Sequence[str], delimiter: str, first: int) -> list[tuple[int, list[str]]]:
    """Cells of the lines that are neither empty nor comments, each with the number of its line.

    Args:
        path: Of the file, for messages.
        lines: Of a text.
        delimiter: Between cells; empty for white space.
        first: Number of the first of these lines.

    Raises:
        RecordingError: A cell never ends.
    """
    try:
        return [
            (number, split_cells(line, delimiter))
            for number, line in enumerate(lines, first)
            if line.strip() and not is_comment(line)
        ]
    except csv.Error as error:
        raise RecordingError(f"{path} is no table of text: {error}") from error


def find_encoding(path: Path) -> str:
    """Encoding of a text file: what its byte order mark says, else UTF-8, else the one by which most words are known.

    Where none of them makes words of its first lines it is that of western Windows.

    Raises:
        RecordingError: It is none of them, or has bytes that no text has.
    """
    with path.open("rb") as stream:
        start = stream.read(_SAMPLE)
    kind = next((what for mark, what in _KINDS.items() if start.startswith(mark)), "")
    if kind:
        raise RecordingError(
            f"{path} is called {path.suffix} and begins as {kind} does: give it its own suffix, or save it as CSV"
        )
    for mark, encoding in _MARKED.items():
        if start.startswith(mark):
            return encoding
    if _decode(start, "utf-8") is not None:
        return "utf-8"
    texts = {encoding: text for encoding in _ENCODINGS if (text := _decode(start, encoding)) is not None}
    if not texts:
        raise RecordingError(f"{path} is no text file: name its format in a mapping, or give another file")
    return max(texts, key=lambda encoding: _count_words(texts[encoding]))


def _decode(start: bytes, encoding: str) -> str | None:
    """The text of these bytes; None where they are none in this encoding."""
    try:
        text = codecs.getincrementaldecoder(encoding)().decode(start)
    except UnicodeDecodeError:
        return None
    return None if "\0" in text and "\0" in _NULS.sub("", text) else text


def _count_words(text: str) -> int:
    """Number of cells of the first lines of which a word is a quantity or a time."""
    return count_known(_CELL.findall(text[:_HEADING]))


def _refuse_names(path: Path, source: Source, keys: Collection[Column]) -> None:
    """Without a header line columns have numbers only."""
    names = [key for key in keys if isinstance(key, str)]
    if names and not source.header:
        raise RecordingError(
            f"{path} is read without a header line, so that no column is called {names[0]!r}: set header = true under "
            "[source] of the mapping if the first line holds the names, or give the column's number, without quotes"
        )


def _find_decimal(source: Source) -> str:
    return source.decimal or ("." if source.delimiter == "," else ",")


def _find_index(key: Column, header: list[str]) -> int | None:
    if isinstance(key, int):
        return key - 1 if key > 0 else None
    names = header if key in header else [name.partition(" [")[0] for name in header]  # with the unit of its cells
    return names.index(key) if key in names else None


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
            if not np.isfinite(number_or_nan(cells, index, decimal)):
                what = f"{cells[index].strip()[:40]!r} is no number" if index < len(cells) else "the cell is missing"
                raise RecordingError(f"{path}, line {number}, column {key}: {what}; {_hint(cells, index)}") from None
        raise


def _hint(cells: list[str], index: int) -> str:
    """What to write in the mapping, by what the line looks like."""
    line = ",".join(cells)
    if ";" in line or "\t" in line:
        mark = '";"' if ";" in line else '"\\t"'
        return f'the line looks as if delimiter = {mark}, with decimal = "," where numbers have commas'
    if index < len(cells) and DECIMAL_COMMA.fullmatch(cells[index].strip()):
        return 'write decimal = "," under [source] of the mapping'
    return "set skip_bad_rows, or header, delimiter, decimal and skip_lines in the mapping"

"""How a text table is laid out: where its names and its rows begin, and what stands between the cells."""

from __future__ import annotations

import csv
import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, time

from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import read_unit

__all__ = ["FIRST_LINES", "TextLayout", "find_layout", "is_comment", "parse_number", "split_cells"]

FIRST_LINES = 200
"""Lines by which it is told how a text is laid out."""
_MARKS = (";", "\t", "|", ",", "")
"""What may stand between cells; nothing stands for white space."""
_COMMENTS = ("#", "%", "//")
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+(?:[eE][+-]?\d+)?")
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(?:,\d{3})+(?:\.\d*)?")
_DAY_FIRST = re.compile(r"(\d{1,2})\.(\d{1,2})\.(\d{4})[ T]+(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)")
_SLASHES = re.compile(r"(\d{1,2})/(\d{1,2})/(\d{4})[ T]+(\d{1,2}:\d{2}:\d{2}(?:[.,]\d+)?)\s*([AaPp][Mm])?")
_DOTTED = re.compile(r"[+-]?\d{1,3}(?:\.\d{3})+,\d+")
"""A number with points between thousands and a decimal comma."""
_NAMES_OF_PAIRS = ("name", "signal", "variable", "symbolname")
_SPAN = re.compile(r"(-?\d+) days?,? \+?(\d{1,2}):(\d{2}):(\d{2}(?:\.\d+)?)")
_BRACKETS = re.compile(r"[\[(].*[\])]|-|–|")
_RULE = re.compile(r"[-=_+|:*~#\s,;]+")
"""A line that is drawn between names and rows."""
_UNIT_WORDS = frozenset(name.lower() for name in UNITS) | {
    "sec",
    "°",
    "°/s",
    "°c",
    "n.m",
    "deg/sec",
    "rad/sec",
    "%",
    "w",
    "unit",
    "units",
    "einheit",
    "einheiten",
}
_LEAST_NUMBERS = 0.3
"""Part of a line's cells that are numbers, from which on it is a row."""
_FEWEST_CELLS = 2
_AFTER, _LOOKED_AT = 3, 20
"""Lines below a row that are looked at, and among how many they are looked for."""
_NO_VALUE = ("null", "none", "n/a", "na", "-", "--", "#n/a", "true", "false")
"""What stands where there is no number."""


@dataclass(frozen=True)
class TextLayout:
    """How a text table is laid out.

    Attributes:
        delimiter: Between the cells; empty for white space.
        decimal: Decimal mark: a comma is one wherever it is not the delimiter.
        names: Of the columns, with the unit of a line below them in brackets; empty where no line names them.
        names_line: Lines before that of the names; that of the first row where there is none.
        rows_line: Lines before the first row.
        in_comment: Whether the names stand in a comment.
    """

    delimiter: str
    decimal: str
    names: tuple[str, ...]
    names_line: int
    rows_line: int
    in_comment: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the names stand in the line above the rows, as they are."""
        return bool(self.names) and self.rows_line == self.names_line + 1 and not self.in_comment


def is_comment(line: str) -> bool:
    """Whether a line says nothing of the table itself."""
    return line.lstrip().startswith(_COMMENTS)


def split_cells(line: str, delimiter: str) -> list[str]:
    """The cells of a line, without the marks of quotation about them.

    Raises:
        csv.Error: A cell never ends.
    """
    if not delimiter:
        return [cell.strip('"') for cell in line.split()]
    if '"' in line:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])]
    return [cell.strip() for cell in line.rstrip("\r\n").split(delimiter)]


def find_layout(lines: Sequence[str]) -> TextLayout | None:
    """Find the first row of numbers and the names above it; None where there is no row.

    A preamble, comments, and a line of units between names and rows are passed over.

    Args:
        lines: The first ones of a text.
    """
    for number, line in enumerate(lines):
        mark = None if not line.strip() or is_comment(line) or _read_pairs(line) else _find_mark(line)
        if mark is not None and _goes_on(lines[number + 1 :], mark, split_cells(line, mark)):
            return _look_above(lines, number, mark)
    return None


def _read_pairs(line: str) -> tuple[str, list[str]] | None:
    """The word and what it says of each column, of a line that repeats it: `Name;Position;Name;Torque`."""
    mark = next((one for one in ("\t", ";", ",") if one in line), "")
    cells = split_cells(line, mark) if mark else []
    words = {cell for cell in cells[::2] if cell}
    if len(cells) < 4 or len(words) != 1 or len(cells[1::2]) < len(cells[::2]) - 1 or _is_entry(next(iter(words))):
        return None
    return next(iter(words)), cells[1::2]


def _name_pairs(above: Sequence[str], width: int) -> tuple[str, ...]:
    """Names of columns that come in pairs of time and value, as a scope writes them; empty where they do not."""
    said = dict(pairs for line in above if (pairs := _read_pairs(line)) and 2 * len(pairs[1]) in (width, width - 1))
    names = next((said[word] for word in said if word.lower() in _NAMES_OF_PAIRS and all(said[word])), None)
    if names is None:
        return ()
    unit = next((match.group(1) for word in said if (match := re.search(r"time.*\[(\w+)\]", word.lower()))), "")
    first = f"time [{unit}]" if unit else "time"
    return tuple(cell for k, name in enumerate(names) for cell in (f"{name}.time" if k else first, name))


def _goes_on(below: Sequence[str], mark: str, first: Sequence[str]) -> bool:
    """Whether the next line has as many cells, or is cut short where the text ends, and numbers stay numbers.

    Lines of a header hold numbers too; below them come words in the same places.
    """
    lines = [one for one in itertools.islice(below, _LOOKED_AT) if one.strip() and not is_comment(one)][:_AFTER]
    if not lines or lines[0] is below[-1]:
        return True
    rows = [split_cells(line, mark) for line in lines if line is not below[-1]]
    places = [k for k, cell in enumerate(first) if _is_entry(cell)]
    words = any(k < len(row) and row[k] and not _is_value(row[k]) for row in rows for k in places)
    return _fits(rows[0], len(first)) and not words


def _is_value(cell: str) -> bool:
    return _is_entry(cell) or cell.lower() in _NO_VALUE


def _find_mark(line: str) -> str | None:
    """The mark that cuts a line into the most cells that are numbers; None where it is no row."""
    best: tuple[float, int, str] | None = None
    for mark in _MARKS:
        if mark and mark not in line:
            continue
        cells = [cell for cell in split_cells(line, mark) if cell]
        numbers = sum(map(_is_entry, cells))
        if len(cells) < _FEWEST_CELLS or numbers < _FEWEST_CELLS or numbers < _LEAST_NUMBERS * len(cells):
            continue
        if best is None or numbers / len(cells) > best[0]:
            best = (numbers / len(cells), len(cells), mark)
    return None if best is None else best[2]


def _look_above(lines: Sequence[str], row: int, mark: str) -> TextLayout:
    """The layout of a table whose first full row is known; rows above it may lack numbers."""
    width, decimal = len(split_cells(lines[row], mark)), "." if mark == "," else ","
    pairs = _name_pairs(lines[:row], width)
    if pairs:
        return TextLayout(mark, decimal, pairs, row, row, in_comment=True)
    units: tuple[str, ...] = ()
    first = row
    for at in range(row - 1, -1, -1):
        line = lines[at].strip()
        if not line or _RULE.fullmatch(line):
            continue
        cells = split_cells(line.lstrip("#%/ ") if is_comment(line) else line, mark)
        if not _fits(cells, width):
            if is_comment(line):
                continue
            break
        if any(_is_entry(cell) for cell in cells):
            if is_comment(line):
                continue
            first = at
        elif not units and at > 0 and all(map(_is_unit, cells)) and any(cells) and _has_names(lines[:at], mark, width):
            units = tuple(cells)
        else:
            names = tuple(_with_unit(name, unit) for name, unit in zip(cells, units or [""] * len(cells), strict=False))
            return TextLayout(mark, decimal, names, at, first, is_comment(line))
    return TextLayout(mark, decimal, (), first, first)


def _fits(cells: Sequence[str], width: int) -> bool:
    """Whether a line has a cell for each column; a mark at the end of one of them makes one more."""
    return len(cells) == width or (abs(len(cells) - width) == 1 and len(cells) > _FEWEST_CELLS)


def _has_names(above: Sequence[str], mark: str, width: int) -> bool:
    """Whether the line above one of units has names."""
    line = next((one for one in reversed(above) if one.strip()), "")
    cells = split_cells(line.lstrip("#%/ "), mark)
    return _fits(cells, width) and not any(map(_is_entry, cells))


def _is_unit(cell: str) -> bool:
    return cell.lower() in _UNIT_WORDS or bool(read_unit(cell)) or _BRACKETS.fullmatch(cell) is not None


def _with_unit(name: str, unit: str) -> str:
    bare = unit.strip("[]()")
    return f"{name} [{bare}]" if bare and bare not in "-–" else name


def _is_entry(cell: str) -> bool:
    """Whether a cell is a number, a date or a list of numbers."""
    if cell[:1] in ("[", "("):
        return any(character.isdigit() for character in cell)
    try:
        parse_number(cell, ",")
    except ValueError:
        return False
    return True


def parse_number(cell: str, decimal: str) -> float:
    """A number, also with a decimal comma or with commas between thousands, or in hexadecimal digits behind `0x`.

    Of a date and time by ISO 8601, with the day first and dots between, or with slashes (the month first, where that
    can be), it is the seconds since 1970; of a time of day those since midnight [s]; of `0 days 00:00:01.5` its length.

    Raises:
        ValueError: It is none.
    """
    text = cell.strip().strip('"')
    if "," in text:
        text = _without_commas(text, decimal)
    try:
        return float(int(text, 16)) if text[:2] in ("0x", "0X") else float(text)
    except ValueError:
        return _parse_stamp(text)


def _without_commas(text: str, decimal: str) -> str:
    if decimal == "," and _DECIMAL_COMMA.fullmatch(text):
        return text.replace(",", ".")
    if decimal == "," and _DOTTED.fullmatch(text):
        return text.replace(".", "").replace(",", ".")
    return text.replace(",", "") if _THOUSANDS.fullmatch(text) else text


def _reorder(first: str, second: str, year: str, clock: str, half: str | None) -> str:
    """A date between slashes as ISO 8601 has it; the first number is the month where it can be one."""
    day, month = (int(first), int(second)) if int(first) > 12 else (int(second), int(first))
    hours, rest = clock.split(":", 1)
    hour = int(hours) % 12 + 12 * (half.lower() == "pm") if half else int(hours)
    return f"{year}-{month:02d}-{day:02d} {hour:02d}:{rest}"


def _parse_stamp(text: str) -> float:
    span = _SPAN.fullmatch(text)
    if span:
        days, hours, minutes, seconds = span.groups()
        return 86400.0 * int(days) + 3600.0 * int(hours) + 60.0 * int(minutes) + float(seconds)
    slashes = _SLASHES.fullmatch(text)
    if slashes:
        text = _reorder(*slashes.groups())
    european = _DAY_FIRST.fullmatch(text)
    if european:
        day, month, year, clock = european.groups()
        text = f"{year}-{int(month):02d}-{int(day):02d} {clock.zfill(8)}"
    if "-" not in text and text.count(":") == 2:
        clock_time = time.fromisoformat(text.replace(",", "."))
        return 3600.0 * clock_time.hour + 60.0 * clock_time.minute + clock_time.second + 1e-6 * clock_time.microsecond
    stamp = datetime.fromisoformat(text)
    return (stamp if stamp.tzinfo else stamp.replace(tzinfo=UTC)).timestamp()

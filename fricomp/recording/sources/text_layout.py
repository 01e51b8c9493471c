"""How a text table is laid out: where its names and its rows begin, and what stands between the cells."""

import itertools
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace

from .cell import DECIMAL_COMMA, DECIMAL_POINT, DOTTED, THOUSANDS, is_entry, is_number, read_measured
from .text_heading import Heading, choose_names, list_headings, name_pairs, read_pairs, says_scales
from .text_legend import name_by_legend
from .text_line import FEWEST_CELLS, fits, is_comment, split_cells

FIRST_LINES = 200
"""Lines by which it is told how a text is laid out."""
_MARKS = (";", "\t", "|", ",", "")
"""What may stand between cells; nothing stands for white space."""
_LEAST_NUMBERS = 0.3
"""Part of a line's cells that are numbers, from which on it is a row."""
_MOST_HEADINGS = 6
"""Lines above the rows among which the names are looked for."""
_AFTER, _LOOKED_AT = 3, 20
"""Lines below a row that are looked at, and among how many they are looked for."""
_ADDRESS = re.compile(r"0[xX][0-9A-Fa-f]{4}")
"""An object of CANopen, as a name."""
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
        is_joined: Whether they are of several lines, one of units among them.
    """

    delimiter: str
    decimal: str
    names: tuple[str, ...]
    names_line: int
    rows_line: int
    in_comment: bool = False
    is_joined: bool = False

    @property
    def is_plain(self) -> bool:
        """Whether the names stand in the line above the rows, as they are."""
        is_above = self.rows_line == self.names_line + 1
        return bool(self.names) and is_above and not self.in_comment and not self.is_joined


def find_layout(lines: Sequence[str]) -> TextLayout | None:
    """Find the first row of numbers and the names above it; None where there is no row.

    A preamble, comments, and a line of units between names and rows are passed over.

    Args:
        lines: The first ones of a text.
    """
    for number, line in enumerate(lines):
        mark = None if not line.strip() or is_comment(line) or read_pairs(line) else _find_mark(line)
        if mark is not None and _goes_on(lines[number + 1 :], mark, split_cells(line, mark)):
            return _look_above(lines, number, mark)
    return None


def _goes_on(below: Sequence[str], mark: str, first: Sequence[str]) -> bool:
    """Whether the next line has as many cells, or is cut short where the text ends, and numbers stay numbers.

    Lines of a header hold numbers too; below them come words in the same places.
    """
    lines = [one for one in itertools.islice(below, _LOOKED_AT) if one.strip() and not is_comment(one)]
    if not lines or lines[0] is below[-1]:
        return True
    if _are_addresses(first, split_cells(lines[0], mark)):
        return False
    rows = [split_cells(line, mark) for line in lines[:_AFTER] if line is not below[-1]]
    places = [k for k, cell in enumerate(first) if is_number(cell)]
    words = any(k < len(row) and row[k] and not _is_value(row[k], first[k]) for row in rows for k in places)
    return fits(rows[0], len(first)) and not words and not _is_fact(first, split_cells(lines[-1], mark))


def _is_fact(cells: Sequence[str], row: Sequence[str]) -> bool:
    """Whether a line says one thing of each column, called by its first cell: `SampleTime [ms];2;2`, above numbers."""
    word = cells[0].strip() if cells else ""
    return bool(word) and word.lower() not in _NO_VALUE and not is_number(word) and bool(row) and is_entry(row[0])


def _are_addresses(cells: Sequence[str], row: Sequence[str]) -> bool:
    """Whether all numbers of a line are addresses of registers, `0x6064`, above other numbers: it has the names."""
    numbers = [(cell, below) for cell, below in zip(cells, row, strict=False) if is_entry(cell)]
    return bool(numbers) and all(_ADDRESS.match(cell) and not _ADDRESS.match(below) for cell, below in numbers)


def _is_value(cell: str, like: str) -> bool:
    """Whether a cell is a number as that above it: with a unit behind it where that has one."""
    return cell.lower() in _NO_VALUE or (is_number(cell) and bool(read_measured(cell)) == bool(read_measured(like)))


def _find_mark(line: str) -> str | None:
    """The mark that cuts a line into the most cells that are numbers; None where it is no row."""
    best: tuple[float, int, str] | None = None
    for mark in _MARKS:
        if mark and mark not in line:
            continue
        cells = [cell for cell in split_cells(line, mark) if cell]
        numbers = sum(map(is_number, cells))
        if len(cells) < FEWEST_CELLS or numbers < FEWEST_CELLS or numbers < _LEAST_NUMBERS * len(cells):
            continue
        if best is None or numbers / len(cells) > best[0]:
            best = (numbers / len(cells), len(cells), mark)
    return None if best is None else best[2]


def _look_above(lines: Sequence[str], row: int, mark: str) -> TextLayout:
    """The layout of a table whose first full row is known; rows above it may lack numbers."""
    width, decimal = len(split_cells(lines[row], mark)), _find_decimal(lines[row:], mark)
    pairs = name_pairs(lines[:row], width)
    if pairs:
        return TextLayout(mark, decimal, pairs, row, row, in_comment=True)
    headings: list[Heading] = []
    first, cells = row, split_cells(lines[row], mark)
    numbered = _count_rows(lines[row:], mark)
    scales: list[str] = []
    for line in list_headings(lines[:row], mark, width, numbered=numbered):
        if _are_addresses(line.cells, cells) or not any(map(is_entry, line.cells)):
            headings.append(line)
        elif _is_fact(line.cells, [cells[0] or "0", *cells[1:]]):  # numbers with nothing in front are rows too
            scales = line.cells if says_scales(line.cells) else scales
        elif headings:
            break
        else:
            first = line.number
    bare = TextLayout(mark, decimal, (), first, first)
    if not headings:
        return bare
    chosen = choose_names(headings[:_MOST_HEADINGS], labelled=is_entry(cells[0]), scales=scales)
    layout = replace(bare, **chosen._asdict())
    by_legend = name_by_legend(layout.names, lines[: layout.names_line])
    if by_legend != layout.names:
        layout = replace(layout, names=by_legend, is_joined=True)
    if len(layout.names) == width - 1 and cells[-1] and _count_rows(lines[first:], mark):
        return replace(layout, names=("", *layout.names), is_joined=True)
    return layout


def _count_rows(rows: Sequence[str], mark: str) -> bool:
    """Whether the first cells are the numbers of the rows, which R writes without a name above them."""
    shown = [line for line in itertools.islice(rows, _LOOKED_AT) if line.strip() and not is_comment(line)]
    firsts = [split_cells(line, mark)[0] for line in shown]
    return all(cell.isdigit() for cell in firsts) and all(int(b) == int(a) + 1 for a, b in itertools.pairwise(firsts))


def _find_decimal(rows: Sequence[str], mark: str) -> str:
    """The decimal mark: the one that stands where no mark between thousands can; a comma where nothing tells.

    Commas that are not in quotes are no decimal marks where they are the delimiter.
    """
    cells = {cell for row in rows for cell in split_cells(row, mark) if mark != "," or '"' in row}
    commas = any(DECIMAL_COMMA.fullmatch(cell) and not THOUSANDS.fullmatch(cell) for cell in cells)
    if commas or any(map(DOTTED.fullmatch, cells)):
        return "," if mark != "," or not any("." in cell for cell in cells if "," in cell) else "."
    return "." if mark == "," or any(map(DECIMAL_POINT.fullmatch, cells)) else ","

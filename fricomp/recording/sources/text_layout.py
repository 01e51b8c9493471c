"""How a text table is laid out: where its names and its rows begin, and what stands between the cells."""

import csv
import itertools
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from fricomp.recording.quantity_word import count_known
from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import UNKNOWN_UNIT, read_bracket, read_unit

from .cell import DECIMAL_COMMA, DECIMAL_POINT, DOTTED, THOUSANDS, is_entry, is_number, read_measured

FIRST_LINES = 200
"""Lines by which it is told how a text is laid out."""
_MARKS = (";", "\t", "|", ",", "")
"""What may stand between cells; nothing stands for white space."""
_COMMENTS = ("#", "%", "//")
_NAMES_OF_PAIRS = ("name", "signal", "variable", "symbolname")
_UNITS_OF_PAIRS = ("unit", "units", "einheit", "einheiten")
_BRACKETS = re.compile(r"[\[(].*[\])]|-|–|")
_WIDE = re.compile(r"\t+|\s{2,}")
_WITH_UNIT = re.compile(r"[^\s\[(]+\s*(?:[\[(][^\])]*[\])])?")
"""What stands between names with spaces in them, and a name with its unit: `torque (N m)`."""
_UNIT_LABEL = re.compile(r"^\s*(?:units?|einheit(?:en)?)\s*[:=]\s*", re.IGNORECASE)
"""What stands before each unit where a line holds several facts of the columns: `Unit: deg`."""
_RULE = re.compile(r"[-=_+|:*~#\s,;]+")
"""A line that is drawn between names and rows."""
_LABEL_OF_UNITS = re.compile(r"(?:.*[ _])?(?:units?|einheit(?:en)?)(?:[ _]label)?", re.IGNORECASE)
"""What stands before a line of units: `Units`, `Vertical Units`."""
_MOSTLY_UNITS = 0.6
"""Part of the words of a line that are units, from which on the others are units that nobody here knows."""
_UNIT_WORDS = frozenset(name.lower() for name in UNITS) | {
    "sec",
    "second",
    "seconds",
    "°",
    "°/s",
    "°c",
    "n.m",
    "deg/sec",
    "rad/sec",
    "%",
    "w",
}
_LEAST_NUMBERS = 0.3
"""Part of a line's cells that are numbers, from which on it is a row."""
_FEWEST_CELLS = 2
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


class _Heading(NamedTuple):
    """A line above the rows with as many cells as they have."""

    number: int
    cells: list[str]
    is_comment: bool


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
    if len(cells) < 4 or len(words) != 1 or len(cells[1::2]) < len(cells[::2]) - 1 or is_entry(next(iter(words))):
        return None
    return next(iter(words)), cells[1::2]


def _name_pairs(above: Sequence[str], width: int) -> tuple[str, ...]:
    """Names of columns that come in pairs of time and value, as a scope writes them; empty where they do not."""
    said = dict(pairs for line in above if (pairs := _read_pairs(line)) and 2 * len(pairs[1]) in (width, width - 1))
    names = next((said[word] for word in said if word.lower() in _NAMES_OF_PAIRS and all(said[word])), None)
    if names is None:
        return ()
    units = next((said[word] for word in said if word.lower() in _UNITS_OF_PAIRS), [])
    names = [_with_unit(name, unit) for name, unit in itertools.zip_longest(names, units[: len(names)], fillvalue="")]
    unit = next((match.group(1) for word in said if (match := re.search(r"time.*\[(\w+)\]", word.lower()))), "")
    first = f"time [{unit}]" if unit else "time"
    return tuple(cell for k, name in enumerate(names) for cell in (f"{name}.time" if k else first, name))


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
    return _fits(rows[0], len(first)) and not words and not _is_fact(first, split_cells(lines[-1], mark))


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
        if len(cells) < _FEWEST_CELLS or numbers < _FEWEST_CELLS or numbers < _LEAST_NUMBERS * len(cells):
            continue
        if best is None or numbers / len(cells) > best[0]:
            best = (numbers / len(cells), len(cells), mark)
    return None if best is None else best[2]


def _look_above(lines: Sequence[str], row: int, mark: str) -> TextLayout:
    """The layout of a table whose first full row is known; rows above it may lack numbers."""
    width, decimal = len(split_cells(lines[row], mark)), _find_decimal(lines[row:], mark)
    pairs = _name_pairs(lines[:row], width)
    if pairs:
        return TextLayout(mark, decimal, pairs, row, row, in_comment=True)
    headings: list[_Heading] = []
    first, cells = row, split_cells(lines[row], mark)
    numbered = _count_rows(lines[row:], mark)
    for line in _list_above(lines[:row], mark, width, numbered=numbered):
        if _are_addresses(line.cells, cells) or not any(map(is_entry, line.cells)):
            headings.append(line)
        elif _is_fact(line.cells, [cells[0] or "0", *cells[1:]]):
            continue  # numbers with nothing in front of them are rows too
        elif headings:
            break
        else:
            first = line.number
    bare = TextLayout(mark, decimal, (), first, first)
    if not headings:
        return bare
    layout = _choose_names(headings[:_MOST_HEADINGS], bare, labelled=is_entry(cells[0]))
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


def _list_above(above: Sequence[str], mark: str, width: int, *, numbered: bool) -> Iterator[_Heading]:
    """The lines above a row with as many cells, the nearest first, up to one that has not; no comments of numbers."""
    around = " \r\n" if mark == "\t" else None  # blank cells at an end are cells
    for number, line in reversed([(number, line.strip(around)) for number, line in enumerate(above)]):
        if not line.strip() or _RULE.fullmatch(line):
            continue
        bare = line.lstrip("#%/ ") if is_comment(line) else line
        found = _Heading(number, _split_heading(bare, mark, width, numbered=numbered), is_comment(line))
        if not found.is_comment and not _fits(found.cells, width):
            return
        if not found.is_comment or (_fits(found.cells, width) and not any(map(is_entry, found.cells))):
            yield found


def _split_heading(line: str, mark: str, width: int, *, numbered: bool) -> list[str]:
    """The cells of a line above the rows: between white space a unit in brackets belongs to the name before it, and of
    names with a space in them two spaces stand between. Numbers in front of the rows may have no name.
    """
    cells = split_cells(line, mark)
    if mark or len(cells) == width or (numbered and len(cells) == width - 1):
        return cells
    apart, joined = _WIDE.split(line.strip()), [one.strip() for one in _WITH_UNIT.findall(line)]
    tried = [(apart, width - 1), (apart, width), (joined, width), (joined, width - 1)]
    return next((one for one, count in tried if len(one) == count and (numbered or count == width)), cells)


def _choose_names(headings: Sequence[_Heading], layout: TextLayout, *, labelled: bool) -> TextLayout:
    """The layout with its names: the line with the most words for a quantity, of several the one nearest to the rows.

    Lines of units, of remarks and of numbers of channels stand above and below it. A comment has the names only where
    no other line has a word for a quantity.

    Args:
        headings: Lines above the rows, the nearest first.
        layout: Without names.
        labelled: Whether a word such as `Name` in the first place is that of the line, since numbers stand below it.
    """
    units = _find_units(headings)
    others = [one for one in headings if units is None or one.number != units.number] or headings[:1]
    known = {one.number: count_known(one.cells) for one in others}
    line = max(others, key=lambda one: (not one.is_comment and known[one.number] > 0, known[one.number]))
    said = units.cells if units is not None and units.number != line.number else []
    cells = _join_levels(line, [one for one in others if one is not line and not one.is_comment])
    if labelled and cells[0].lower() in _NAMES_OF_PAIRS:
        cells, said = ["time", *cells[1:]], ["", *said[1:]]
    pairs = itertools.zip_longest(cells, said[: len(cells)], fillvalue="")
    names = tuple(_with_unit(name, unit) for name, unit in pairs)
    is_changed = list(names) != list(line.cells)
    return replace(layout, names=names, names_line=line.number, in_comment=line.is_comment, is_joined=is_changed)


def _find_units(headings: Sequence[_Heading]) -> _Heading | None:
    """The line of units: that with a label before each, without what else it says; else that which consists of them."""
    for one in headings:
        labelled = [cell if _UNIT_LABEL.match(cell) else "" for cell in one.cells]
        if sum(map(bool, labelled)) > 1:
            return one._replace(cells=labelled)
    of_units = (one for least in (1.0, _MOSTLY_UNITS) for one in headings if _are_units(one.cells, least))
    return next(of_units, None)


def _join_levels(line: _Heading, others: Sequence[_Heading]) -> list[str]:
    """The names of columns whose words stand in two lines, as data frames and joined cells of sheets have them.

    Names that come more than once get the words of a line that tells them apart before them; what stands in front of a
    blank cell is meant there too. The first column, which such a line leaves blank or calls after itself, has the name
    that stands alone below it or that another line gives it.
    """
    said = [name for name in line.cells if name]
    joined = line.cells
    for other in others if len(set(said)) < len(said) else ():
        above = _fill_blanks(other.cells)
        both = [f"{a}/{b}" if a and b else b for a, b in zip(above, line.cells, strict=False)]
        if len(both) == len(line.cells) and len({name for name in both if name}) == len(said):
            joined = ["", *both[1:]] if count_known(both[:1]) == 0 else both
            break
    if joined[:1] != [""] and (count_known(joined[:1]) or joined[0].lower() in _NAMES_OF_PAIRS):
        return joined
    firsts = [one.cells[0] for one in others if one.cells[:1] != [""] and count_known(one.cells[:1])]
    return [*firsts[:1], *joined[1:]] if firsts else joined


def _fill_blanks(cells: Sequence[str]) -> list[str]:
    """The cells with what stands in front of a blank one in it."""
    filled: list[str] = []
    for cell in cells:
        filled.append(cell or (filled[-1] if filled else ""))
    return filled


def _fits(cells: Sequence[str], width: int) -> bool:
    """Whether a line has a cell for each column; a mark at the end of one of them makes one more."""
    return len(cells) == width or (abs(len(cells) - width) == 1 and len(cells) > _FEWEST_CELLS)


def _are_units(cells: Sequence[str], least: float = 1.0) -> bool:
    """Whether at least such a part of the cells with words are units, and the others no words of a quantity.

    Letters that are units as well are no such line unless all of them are.
    """
    said = [cell for cell in cells if cell]
    units = [cell for cell in said if _is_unit(cell)]
    if len(units) == len(said):
        return bool(said)
    return len(units) >= least * len(said) and max(map(len, units)) > 1 and count_known(list(cells)) == 0


def _is_unit(cell: str) -> bool:
    cell = _UNIT_LABEL.sub("", cell)
    known = cell.lower() in _UNIT_WORDS or _LABEL_OF_UNITS.fullmatch(cell) is not None
    return known or bool(read_unit(cell)) or _BRACKETS.fullmatch(cell) is not None


def _with_unit(name: str, unit: str) -> str:
    bare = _UNIT_LABEL.sub("", unit).strip("[]()")
    if not bare or bare in "-–" or _LABEL_OF_UNITS.fullmatch(bare):
        return name
    is_known = bare.lower() in _UNIT_WORDS or read_bracket(bare) != ""
    return f"{name} [{bare}]" if is_known else f"{name} [{UNKNOWN_UNIT} {bare}]"

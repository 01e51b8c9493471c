"""The names of the columns of a text table: which line above its rows holds them, and what else says their units."""

import itertools
import re
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from fricomp.recording.quantity_word import count_known
from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import UNKNOWN_UNIT, read_bracket, read_unit

from .cell import is_entry
from .text_line import fits, is_comment, split_cells

_NAMES_OF_PAIRS = ("name", "signal", "variable", "symbolname")
_UNITS_OF_PAIRS = ("unit", "units", "einheit", "einheiten")
_SCALE_OF_PAIRS = "scalefactor"
"""What a scope calls the size of one of a column's whole numbers."""
_UNIT_OF_NAME = re.compile(r"\s*[\[(]([^\])]*)[\])]\s*$")
_BRACKETS = re.compile(r"[\[(].*[\])]|-|–|")
_WIDE = re.compile(r"\t+|\s{2,}")
_WITH_UNIT = re.compile(r"[^\s\[(]+\s*(?:[\[(][^\])]*[\])])?")
"""What stands between names with spaces in them, and a name with its unit: `torque (N m)`."""
_UNIT_LABEL = re.compile(r"^\s*(?:units?|einheit(?:en)?)\s*[:=]\s*", re.IGNORECASE)
"""What stands before each unit where a line holds several facts of the columns: `Unit: deg`."""
_RULE = re.compile(r"[-=_+|:*~#\s,;]+")
"""A line that is drawn between names and rows."""
_SECTION = re.compile(
    r"[\[<{*#\s]*(?:(?:begin|start)[ _]?(?:of)?[ _]?)?(?:data|values|samples|rows|daten|messwerte|werte)"
    r"(?:[ _]?(?:begin|start|section|block))?[\]>}*#:;,\s]*",
    re.IGNORECASE,
)
"""A line between names and rows that says that rows begin: `[Data]`, `DATA:`, `<values>`."""
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


class Heading(NamedTuple):
    """A line above the rows with as many cells as they have."""

    number: int
    cells: list[str]
    is_comment: bool


class ColumnNames(NamedTuple):
    """The names that a line gives; see `TextLayout` for each."""

    names: tuple[str, ...]
    names_line: int
    in_comment: bool
    is_joined: bool


def read_pairs(line: str) -> tuple[str, list[str]] | None:
    """The word and what it says of each column, of a line that repeats it: `Name;Position;Name;Torque`."""
    mark = next((one for one in ("\t", ";", ",") if one in line), "")
    cells = split_cells(line, mark) if mark else []
    words = {cell for cell in cells[::2] if cell}
    if len(cells) < 4 or len(words) != 1 or len(cells[1::2]) < len(cells[::2]) - 1 or is_entry(next(iter(words))):
        return None
    return next(iter(words)), cells[1::2]


def name_pairs(above: Sequence[str], width: int) -> tuple[str, ...]:
    """Names of columns that come in pairs of time and value, as a scope writes them; empty where they do not."""
    said = dict(pairs for line in above if (pairs := read_pairs(line)) and 2 * len(pairs[1]) in (width, width - 1))
    names = next((said[word] for word in said if word.lower() in _NAMES_OF_PAIRS and all(said[word])), None)
    if names is None:
        return ()
    units = next((said[word] for word in said if word.lower() in _UNITS_OF_PAIRS), [])
    scales = next((said[word] for word in said if word.lower() == _SCALE_OF_PAIRS), [])
    facts = itertools.zip_longest(names, units[: len(names)], scales[: len(names)], fillvalue="")
    names = list(itertools.starmap(_name_scaled, facts))
    unit = next((match.group(1) for word in said if (match := re.search(r"time.*\[(\w+)\]", word.lower()))), "")
    first = f"time [{unit}]" if unit else "time"
    return tuple(cell for k, name in enumerate(names) for cell in (f"{name}.time" if k else first, name))


def _name_scaled(name: str, unit: str, scale: str) -> str:
    """A name with its unit, and with how many of it one of the numbers is where a scope scales them: `[0.001 deg]`."""
    try:
        is_one = float(scale.replace(",", ".") or 1.0) == 1.0
    except ValueError:
        is_one = True
    if is_one:
        return _with_unit(name, unit)
    scale = scale.replace(",", ".")
    own = _UNIT_OF_NAME.search(name)
    if own and not unit:
        return f"{name[: own.start()]} [{scale} {own.group(1)}]"
    return _with_unit(name, f"{scale} {unit}".strip())


def list_headings(above: Sequence[str], mark: str, width: int, *, numbered: bool) -> Iterator[Heading]:
    """The lines above a row with as many cells, the nearest first, up to one that has not; no comments of numbers."""
    nearest = True
    around = " \r\n" if mark == "\t" else None  # blank cells at an end are cells
    for number, line in reversed([(number, line.strip(around)) for number, line in enumerate(above)]):
        if not line.strip() or _RULE.fullmatch(line) or (nearest and _SECTION.fullmatch(line)):
            continue
        nearest = False
        bare = line.lstrip("#%/ ") if is_comment(line) else line
        found = Heading(number, _split_heading(bare, mark, width, numbered=numbered), is_comment(line))
        if not found.is_comment and not fits(found.cells, width):
            return
        if not found.is_comment or (fits(found.cells, width) and not any(map(is_entry, found.cells))):
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


def choose_names(headings: Sequence[Heading], *, labelled: bool, scales: Sequence[str] = ()) -> ColumnNames:
    """The names of the columns: the line with the most words for a quantity, of several the one nearest to the rows.

    Lines of units, of remarks and of numbers of channels stand above and below it. A comment has the names only where
    no other line has a word for a quantity.

    Args:
        headings: Lines above the rows, the nearest first.
        labelled: Whether a word such as `Name` in the first place is that of the line, since numbers stand below it.
        scales: Cells of a line that says how many of its unit one number of each column is; empty where none does.
    """
    units = _find_units(headings)
    others = [one for one in headings if units is None or one.number != units.number] or headings[:1]
    known = {one.number: count_known(one.cells) for one in others}
    line = max(others, key=lambda one: (not one.is_comment and known[one.number] > 0, known[one.number]))
    said = units.cells if units is not None and units.number != line.number else []
    cells = _join_levels(line, [one for one in others if one is not line and not one.is_comment])
    if labelled and cells[0].lower() in _NAMES_OF_PAIRS:
        cells, said = ["time", *cells[1:]], ["", *said[1:]]
    facts = itertools.zip_longest(cells, said[: len(cells)], ["", *scales[1:]][: len(cells)], fillvalue="")
    names = tuple(itertools.starmap(_name_scaled, facts))
    is_changed = list(names) != list(line.cells)
    return ColumnNames(names, line.number, line.is_comment, is_changed)


def says_scales(cells: Sequence[str]) -> bool:
    """Whether a line says of each column how many of its unit one of its numbers is: `ScaleFactor;0.001;1`."""
    return bool(cells) and cells[0].lower().replace(" ", "") == _SCALE_OF_PAIRS


def _find_units(headings: Sequence[Heading]) -> Heading | None:
    """The line of units: that with a label before each, without what else it says; else that which consists of them."""
    for one in headings:
        labelled = [cell if _UNIT_LABEL.match(cell) else "" for cell in one.cells]
        if sum(map(bool, labelled)) > 1:
            return one._replace(cells=labelled)
    of_units = (one for least in (1.0, _MOSTLY_UNITS) for one in headings if _are_units(one.cells, least))
    return next(of_units, None)


def _join_levels(line: Heading, others: Sequence[Heading]) -> list[str]:
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

"""A line of a text table: its cells, and whether it is a comment."""

import csv
import re
from collections.abc import Sequence

FEWEST_CELLS = 2
"""Cells of a row of a table."""
_TOUCHING = re.compile(r"(?<=[\d.])(?=[+-]\.?\d)")
"""Where a number begins that fills its place up to the one before, as the fixed places of Fortran and C leave it."""
_COMMENTS = ("#", "%", "//")


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


def fits(cells: Sequence[str], width: int) -> bool:
    """Whether a line has a cell for each column; a mark at the end of one of them makes one more."""
    return len(cells) == width or (abs(len(cells) - width) == 1 and len(cells) > FEWEST_CELLS)


def part_touching(cells: list[str], width: int) -> list[str]:
    """The cells of a row between white space, with those in two in which a number touches the one before by its sign.

    As they are where that makes no full row.

    Args:
        cells: Of a row.
        width: Number of columns.
    """
    if len(cells) >= width:
        return cells
    parted = [part for cell in cells for part in _TOUCHING.split(cell)]
    return parted if len(parted) == width else cells

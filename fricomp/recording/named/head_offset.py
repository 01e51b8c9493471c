"""A line above the rows that says an offset of each column: whether the numbers hold it already, no file says."""

from pathlib import Path

from fricomp.recording.sources.cell import is_entry, parse_number
from fricomp.recording.sources.text_heading import read_pairs
from fricomp.recording.sources.text_line import split_cells

from .head_fact import read_head

_CALLED = "offset"
_MARKS = ("\t", ";", ",")
_LONGEST = 60
"""Characters of the line that are told."""


def say_offsets(path: Path) -> list[str]:
    """A sentence on offsets that stand above the rows and were not added; none where all of them are zero.

    Args:
        path: Of the file.
    """
    for line in read_head(path):
        numbers = _read_offsets(line)
        if any(numbers):
            return [
                f"{path.name}: the line {line.strip()[:_LONGEST]!r} above the rows was not added to the numbers, since "
                "scopes write them with it and without: where they lack it, write offset = NUMBER, in SI, for its "
                "column in a mapping."
            ]
    return []


def _read_offsets(line: str) -> list[float]:
    """The numbers of a line `Offset;0.1;2` or `Offset;0.1;Offset;2`; none of any other."""
    pairs = read_pairs(line)
    mark = next((one for one in _MARKS if one in line), "")
    word, *cells = [pairs[0], *pairs[1]] if pairs else split_cells(line, mark) if mark else [""]
    if word.strip().lower() != _CALLED or not cells:
        return []
    return [parse_number(cell, ".") for cell in cells if is_entry(cell)]

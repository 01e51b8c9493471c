"""Rows that say each number behind its name and a space: `0.004 s | pos 0.1 rad | torque -1.2 Nm`."""

import re
from collections.abc import Sequence

from fricomp.recording.quantity_word import count_known
from fricomp.recording.sources.text_layout import FIRST_LINES
from fricomp.recording.unit_word import read_unit

from .labelled_rows import OF_TIME

_TOKEN = re.compile(
    r"([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|nan|[+-]?inf(?![A-Za-z]))|([A-Za-zµ°][\w°µ·./²^*-]*)|([\s|,;:()\[\]]+)",
    re.IGNORECASE,
)
"""A number, a word, or what stands between both."""
_LONGEST = 1000
"""Characters of a line that is looked at."""
_FEWEST = 2
"""Named numbers of a row, and words among the names that say a quantity or a time."""
_MOSTLY = 0.5


def mark_labels(lines: Sequence[str]) -> list[str] | None:
    """The lines with `name=number unit` in place of `name number unit`; None where most lines do not consist of such.

    In front of the first name may stand a number with its unit, when the row was written.

    Args:
        lines: Of a text.
    """
    shown = [line for line in lines[:FIRST_LINES] if line.strip()]
    first = [row for line in shown if (row := _read_row(line)) is not None]
    if not first or len(first) <= _MOSTLY * len(shown):
        return None
    if count_known([label for label, _, _ in first[-1] if label]) < _FEWEST:
        return None
    rows = (row for line in lines if (row := _read_row(line)) is not None)
    return [" ".join(_write_entry(*entry) for entry in row) for row in rows]


def _write_entry(label: str, number: str, unit: str) -> str:
    said = f"{number} {unit}".strip()
    return f"{label}={said}," if label else said


def _read_row(line: str) -> list[tuple[str, str, str]] | None:
    """Name, number and unit of each entry; None where a line does not consist of such. The first may have no name."""
    entries: list[tuple[str, str, str]] = []
    label, end = "", 0
    for token in _TOKEN.finditer(line[:_LONGEST]):
        number, word, _ = token.groups()
        if token.start() != end:
            return None
        end = token.end()
        if number is not None:
            if not label and entries:
                return None
            entries.append((label, number, ""))
            label = ""
        elif word is not None:
            if label:
                return None
            is_open = bool(entries) and not entries[-1][2]
            if is_open and _is_unit(word) and _comes_with(line, end):
                entries[-1] = (*entries[-1][:2], word)
            else:
                label = word
    named = sum(1 for entry in entries if entry[0])
    return entries if end == len(line) and not label and named >= _FEWEST else None


def _is_unit(word: str) -> bool:
    return bool(read_unit(word)) or word == "%" or word in OF_TIME


def _comes_with(line: str, end: int) -> bool:
    """Whether a word that may be a unit is none of the name of the next number: no number follows it at once."""
    following = [token.groups() for _, token in zip(range(2), _TOKEN.finditer(line, end), strict=False)]
    return not following or following[-1][0] is None or any(mark and mark.strip() for _, _, mark in following[:1])

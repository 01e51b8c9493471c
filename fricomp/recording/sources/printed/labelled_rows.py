"""Rows that label each number, as serial ports print them: `t=0.001 q=0.12`, `ms:1,pos:0.12 rad`, `{"t": 0.1, …}`."""

import re
from collections.abc import Mapping, Sequence
from itertools import pairwise

from fricomp.recording.quantity_word import TIMES
from fricomp.recording.sources.cell import parse_number
from fricomp.recording.sources.text_layout import FIRST_LINES
from fricomp.recording.unit_word import read_unit
from fricomp.untrusted import require_filled

_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_DATE = r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:[.,]\d+)?(?:Z|[+-]\d\d:?\d\d)?"
_LETTER = "A-Za-zµ°%·/²^*"
_LABELLED = re.compile(
    rf"""["']?(?<!\w)([A-Za-z_][\w./]{{0,80}}(?:\s?[\[(][^\])]{{0,40}}[\])])?)["']?\s*[:=]\s*(?:["'](?={_DATE}["']))?({_DATE}|{_NUMBER}|nan)(?:(?<=[\dZ])["'])?"""
    rf"""(?:i\b)?(?:\s?((?!x[\da-f])[{_LETTER}]+2?)(?!["'\w.]*\s*[:=]))?(?![\w.:])""",
    re.IGNORECASE,
)
"""A name, its number, which InfluxDB ends by `i` where it is whole, and a word behind it that may be its unit."""
_STAMP = r"(?:\d{4}-\d\d-\d\d[T ])?\d{1,2}:\d\d:\d\d(?:[.,]\d+)?|\d+(?:\.\d+)?"
_DAY = r"(?:(?:[A-Z][a-z]{2}\s+\d{1,2}|\d\d-\d\d)\s+(?=\d\d:))?"
"""A day without its year before a time of day, as journals and phones write it: `Mar 10 23:59:50.004 host a[8]:`."""
_UNIT_OF_TIME = r"(?:\s?(s|sec|ms|us|µs|ns)(?![\w.]))?"
_FIRST, _LAST = (
    re.compile(rf"^\s*[\[(<]?\s*{_DAY}({_STAMP}){_UNIT_OF_TIME}\s*[\])>]?(?=[\s:;,]|$)"),
    re.compile(rf"(?<=\s)(\d+(?:\.\d+)?){_UNIT_OF_TIME}\s*$"),
)
"""A number without a label at an end of the line: when it was written."""
_ASIDE = re.compile(rf"[\[(]\s*(\d+(?:\.\d+)?){_UNIT_OF_TIME}\s*[\])]")
"""The same in brackets before the first label: `I (3120) motor: pos=0.1`, `[INFO] [1710460790.25] [node]: pos: 0.1`."""
_WITHIN = re.compile(r"(?<![\w.:])(\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:[.,]\d+)?)()(?=Z|[+-]\d\d|[\s:;,\])])")
"""A date and time anywhere before the first label: `motor-1  | 2026-03-14T10:00:00.250Z INFO pos=0.1`."""
_DAY_LONG = 86400.0
"""[s]"""
_MEMBER = re.compile(r"<\w+\.(\w+): [^<>]{1,20}>")
"""A member of an enumeration as Python shows it in front of what is said of it: `<Register.POSITION: 1>: 0.1`."""
_LIST = re.compile(
    rf"""(?<!\w)([A-Za-z_][\w./]{{0,80}})(["']?\s*[:=]\s*)[\[(]((?:\s*(?:{_NUMBER}|nan|None|null)\s*(?:[,\s]|(?=[\])])))+)[\])]""",
    re.IGNORECASE,
)
"""A name with a list of numbers: `q=[0.1, -0.2]`."""
_STAMPS = "log time"
_OPENS = re.compile(r"\s::\s*$")
"""End of a frame's line, below which stands what was decoded of it."""
OF_TIME = ("s", "sec", "ms", "us", "µs", "ns")
"""Units behind the number of a time."""
_FEWEST = 2
"""Labelled numbers in a row: lines of a header have one each."""


def tabulate_labelled(lines: Sequence[str], *, is_whole: bool = True) -> list[str] | None:
    """The lines of a table with the labels as its names; None where most lines have no labels.

    Lines without labels, such as those of a boot, are left out, and so is the last one where it was cut off. A unit
    behind a number goes into the name, and numbers without a label that rise along the lines are the time.

    Args:
        lines: Of a text.
        is_whole: Whether the last one has ended.
    """
    lines = [_LIST.sub(_label_entries, _MEMBER.sub(r"\1", line)) for line in _join_messages(lines)]
    labels = [len(_LABELLED.findall(line)) for line in lines[:FIRST_LINES]]
    if sum(count >= _FEWEST for count in labels) < 0.5 * len(labels):
        return None
    labelled = [(line, _LABELLED.findall(line)) for line in (lines if is_whole else lines[:-1])]
    labelled = [(line, found) for line, found in labelled if len(found) >= _FEWEST]
    rows = [{_name_with_unit(label, unit): number for label, number, unit in found} for _, found in labelled]
    name, stamps = _read_stamps([line for line, _ in labelled])
    rows = [row | {name: stamp} for row, stamp in zip(rows, stamps, strict=True)] if stamps else rows
    return join_rows(rows)


def _label_entries(match: re.Match[str]) -> str:
    """Each entry of a list with a label of its own, counted from 1; one alone has the name of the list."""
    name, between, entries = match.groups()
    numbers = entries.replace(",", " ").split()
    labels = [name] if len(numbers) == 1 else [f"{name}_{k}" for k in range(1, 1 + len(numbers))]
    return ", ".join(f"{label}{between}{number}" for label, number in zip(labels, numbers, strict=True))


def _join_messages(lines: Sequence[str]) -> Sequence[str]:
    """The lines, with each frame and what was decoded of it in one: cantools prints that below it."""
    if not any(_OPENS.search(line) for line in lines[:FIRST_LINES]):
        return lines
    joined: list[str] = []
    is_open = False
    for line in lines:
        if is_open:
            joined[-1] += f" {line.strip()}"
        else:
            joined.append(line)
        is_open = not line.rstrip().endswith(")") if is_open else _OPENS.search(line) is not None
    return joined


def join_rows(rows: Sequence[Mapping[str, str]]) -> list[str]:
    """Lines of a table with the names of all rows above them; a row has nothing where it has no such name."""
    names = list(dict.fromkeys(name for row in rows for name in row))
    require_filled(len(rows), len(names), sum(map(len, rows)))
    header = ",".join(f'"{name}"' if "," in name else name for name in names)
    return [header, *(",".join(row.get(name, "") for name in names) for row in rows)]


def _name_with_unit(label: str, unit: str) -> str:
    of_time = unit in OF_TIME and label.lower() in TIMES
    return f"{label} [{unit}]" if unit and (unit == "%" or of_time or read_unit(unit)) else label


def _read_stamps(lines: Sequence[str]) -> tuple[str, list[str]]:
    """The number without a label of each line, where all have one and they rise, and a name for them.

    The unit that stands behind all of them alike is in the name; the numbers are empty where they do not rise.
    """
    heads = [line[: match.start()] if (match := _LABELLED.search(line)) else line for line in lines]
    for where, looked_at in ((_FIRST, lines), (_LAST, lines), (_ASIDE, heads), (_WITHIN, heads)):
        found = [where.search(line) for line in looked_at]
        stamps = [match.group(1).replace(",", ".") for match in found if match is not None]
        units = {match.group(2) for match in found if match is not None}
        if len(stamps) < len(lines) or len(units) > 1:
            continue
        numbers = [parse_number(stamp, ".") for stamp in stamps]
        over = any(":" in stamp and "-" not in stamp for stamp in stamps[:1])  # a time of day may pass midnight
        steps = [b - a + (_DAY_LONG if over and b < a - 0.5 * _DAY_LONG else 0.0) for a, b in pairwise(numbers)]
        if sum(steps) > 0.0 and min(steps) >= 0.0:
            (unit,) = units or {None}
            return f"{_STAMPS} [{unit}]" if unit else _STAMPS, stamps
    return _STAMPS, []

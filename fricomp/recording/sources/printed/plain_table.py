"""Texts that are a table but for what their program writes around each row or into each cell, made plain."""

import csv
import itertools
import re
from collections.abc import Sequence

from fricomp.recording.sources.cell import is_number, parse_number, read_measured, read_measured_si
from fricomp.recording.sources.text_layout import FIRST_LINES, TextLayout, find_layout
from fricomp.recording.sources.text_line import is_comment, split_cells
from fricomp.recording.unit_word import find_unit_words

from .dumped_rows import tabulate_dump
from .labelled_rows import join_rows, tabulate_labelled
from .matlab_text import tabulate_latex, tabulate_matrices
from .octave_text import tabulate_variables
from .proto_text import tabulate_proto
from .spaced_labels import mark_labels
from .yaml_text import tabulate_yaml

_MOSTLY = 0.5
_ARRIVED = re.compile(r"^\s*((?:\d{4}-\d\d-\d\d[T ])?\d{1,2}:\d\d:\d\d(?:[.,]\d+)?)\s*->\s?(.*)$")
"""When a line arrived, as serial monitors write before it."""
_METRIC = re.compile(r"^([A-Za-z_:][\w:]*)(\{.*\})?\s+([+-]?[\d.]+(?:[eE][+-]?\d+)?|NaN)\s+(\d+)$")
"""A sample of Prometheus' text format: name, labels, value and its time in milliseconds [prometheus]."""
_ELEMENT = re.compile(
    r"<([A-Za-z_][\w.:-]*)((?:\s+[\w.:-]+\s*=\s*\"[^\"<>]*\")*)\s*/?>(?:\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*<)?"
)
_ATTRIBUTE = re.compile(r"([\w.:-]+)\s*=\s*\"\s*([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*\"")
"""An element of XML with its attributes and the number in it, and an attribute that is a number."""
_BRACKETED = re.compile(r"^\s*\[*[\[(]\s*([^\s\[\]()]+[,\s][^\[\]()]*)[\])]\]*\s*[,;]?\s*$")
"""A row as a list or a tuple of Python, `(0.1, 0.2, 0.3)`, or as numpy shows it, `[0.1 0.2]`."""
_NAMED_LIST = re.compile(r"^\s*[\"']?([A-Za-z_][\w .]*?)[\"']?\s*[:=]\s*[\[(]([^\[\]]*)[\])]\s*[,;]?\s*$")
"""A channel a line as programs write their variables: `q = [0.1, 0.2]`."""
_PYTHON = re.compile(
    r"\b(?:(?:np|numpy|torch|jnp)\.)?(?:(?:float|u?int)\d+|array|tensor|Array)"
    r"\(([^(),]*|\[[^()\[\]]*\])(?:,\s*\w+=[^()]*)?\)"
)
"""A number or a list as Python shows it: `np.float64(0.1)`, `array([0.1, 0.2], dtype=float32)`, `tensor(0.1)`."""
_SENTENCE = re.compile(r"^\$[A-Za-z]\w*,(.*)\*[0-9A-Fa-f]{2}\s*$")
"""A row as receivers of satellites write it, and devices that took that form over."""
_NODE = re.compile(r"(?<![\"'])\bns=(\d+);(?=[isgb]=)")
"""How OPC UA begins the name of a node that stands in no quotes."""
_PUBLISHED = re.compile(r"^\s*(\d[\dT:.+Z-]*)[\s,;]+([A-Za-z/_][\w/.\[\]-]*)[\s,;]+([+-]?[\d.]+(?:[eE][+-]?\d+)?)\s*$")
"""When, on which topic and what, as a broker's client prints it: `1710460790.25 robot/elbow/position 0.1`."""
_MOST_HEADINGS = 12
"""Lines among which a name may be broken."""
_FEWEST_ENTRIES = 3
"""Numbers of a line of XML that are a row: time, position and torque."""
_MOST_CHANNELS, _LONG_ROW, _LONG_LINE = 64, 200, 400
"""Lines of a table with a channel each; marks and characters in every one of them: no table is so wide."""
_JOINT_LABEL = re.compile(r'\b(?:joint|joint_name|motor|axis)="([^"]*)"')


def as_table(lines: list[str], *, is_whole: bool = True) -> list[str]:
    """The lines as they are, or those of a table with the same numbers.

    Rows of data bases and of pages, variables of Octave, rows in brackets, rows that label each number, messages of
    ROS as they are printed, samples of Prometheus, lines behind the time at which they arrived, elements of XML, a
    channel a line, and cells with units become plain rows below one line of names.

    Args:
        lines: Of a text.
        is_whole: Whether the last one has ended.
    """
    try:
        lines = _join_quoted(_strip_checksums(_join_nodes(lines)))
        lines = tabulate_dump(lines) or tabulate_variables(lines) or tabulate_matrices(lines) or _read_python(lines)
        lines = tabulate_proto(lines) or tabulate_latex(lines) or lines
        lines = _unwrap(lines) or _join_decimals(lines) or lines
        lines = tabulate_yaml(lines) or _tabulate_metrics(lines) or _tabulate_arrived(lines) or lines
        lines = _tabulate_published(lines) or lines
        lines = _tabulate_elements(lines) or _transpose(lines) or _name_joint_states(lines) or lines
        layout = find_layout(lines[:FIRST_LINES])
        if layout is not None and layout.names:
            return _without_units(lines, layout) or lines
    except csv.Error:
        return lines  # whose reader says what is wrong with it
    return tabulate_labelled(lines, is_whole=is_whole) or _tabulate_spaced(lines, is_whole=is_whole) or lines


def _tabulate_spaced(lines: Sequence[str], *, is_whole: bool) -> list[str] | None:
    """The table of rows that say each number behind its name and a space; None where they do not."""
    marked = mark_labels(lines if is_whole else lines[:-1])
    return None if marked is None else tabulate_labelled(marked)


def _join_nodes(lines: list[str]) -> list[str]:
    """The lines with a colon within the names of nodes, where semicolons stand between cells too: `ns=3;s=Axis.Pos`."""
    if not any(_NODE.search(line) for line in lines[:FIRST_LINES]):
        return lines
    return [_NODE.sub(r"ns=\1:", line) for line in lines]


def _join_quoted(lines: list[str]) -> list[str]:
    """The lines with names in one that are broken within their quotes, as spreadsheets write them."""
    joined, begun = list[str](), ""
    for number, line in enumerate(lines[:_MOST_HEADINGS]):
        begun = f"{begun} {line}" if begun else line
        if begun.count('"') % 2 and number + 1 < min(len(lines), _MOST_HEADINGS):
            continue
        joined.append(begun)
        begun = ""
    return [*joined, *lines[_MOST_HEADINGS:]] if len(joined) < len(lines[:_MOST_HEADINGS]) else lines


def _strip_checksums(lines: list[str]) -> list[str]:
    """Rows of numbers without the word in front and the sum at the end of each: `$JNT,0.1,0.2*5A`."""
    first = [line for line in lines[:FIRST_LINES] if line.strip()]
    if not first or sum(_SENTENCE.match(line) is not None for line in first) <= _MOSTLY * len(first):
        return lines
    return [match.group(1) for line in lines if (match := _SENTENCE.match(line))]


def _read_python(lines: list[str]) -> list[str]:
    """The lines with bare numbers and lists where Python shows what made them."""
    if not any(_PYTHON.search(line) for line in lines[:FIRST_LINES]):
        return lines
    return [_PYTHON.sub(r"\1", line) for line in lines]


def _join_decimals(lines: list[str]) -> list[str] | None:
    """The table with points for decimal commas that stand between commas; None where there are no such.

    Below `time,pos,torque` each row has twice as many cells, in turns the whole part of a number and its decimals.
    """
    shown = [number for number, line in enumerate(lines[:FIRST_LINES]) if line.strip() and not is_comment(line)]
    if len(shown) < _FEWEST_ENTRIES:
        return None
    head = lines[shown[0]]
    mark = next((one for one in (";", "\t", ",") if one in head), "")
    names = split_cells(head, mark) if mark else []
    pairs = re.compile(rf"[+-]?\d+,\d+(?:[eE][+-]?\d+)?(?:,[+-]?\d+,\d+(?:[eE][+-]?\d+)?){{{len(names) - 1}}}")
    if len(names) < _FEWEST_ENTRIES or not all(pairs.fullmatch(lines[number].strip()) for number in shown[1:]):
        return None
    rows = (line.strip().split(",") for line in lines[shown[0] + 1 :] if pairs.fullmatch(line.strip()))
    joined = [",".join(f"{a}.{b}" for a, b in zip(cells[::2], cells[1::2], strict=True)) for cells in rows]
    return [_join(names, ","), *joined]


def _unwrap(lines: Sequence[str]) -> list[str] | None:
    """The lines without the brackets about each row; None where they have none."""
    first = [line for line in lines[:FIRST_LINES] if line.strip() and not is_comment(line)]
    if not first or sum(_BRACKETED.match(line) is not None for line in first) <= _MOSTLY * len(first):
        return None
    return [match.group(1) if (match := _BRACKETED.match(line)) else line for line in lines]


def _tabulate_metrics(lines: Sequence[str]) -> list[str] | None:
    """Rows of time, metric and value; None where the lines are no samples of Prometheus."""
    first = [line for line in lines[:FIRST_LINES] if line.strip() and not is_comment(line)]
    if not first or sum(_METRIC.match(line) is not None for line in first) < _MOSTLY * len(first):
        return None
    rows = ["time [ms],metric,value"]
    for line in lines:
        sample = _METRIC.match(line)
        if sample is not None:
            name, labels, value, stamp = sample.groups()
            joint = _JOINT_LABEL.search(labels or "")
            rows.append(f"{stamp},{joint.group(1) + '/' if joint else ''}{name},{value}")
    return rows


def _tabulate_published(lines: Sequence[str]) -> list[str] | None:
    """Rows of time, topic and value below their names; None where the lines are no such."""
    first = [line for line in lines[:FIRST_LINES] if line.strip() and not is_comment(line)]
    if not first or sum(_PUBLISHED.match(line) is not None for line in first) < len(first):
        return None
    return ["time,topic,value", *(",".join(match.groups()) for line in lines if (match := _PUBLISHED.match(line)))]


def _tabulate_arrived(lines: Sequence[str]) -> list[str] | None:
    """The lines behind the times at which they arrived, with these as a last column; None where they have none."""
    first = [line for line in lines[:FIRST_LINES] if line.strip()]
    if not first or sum(_ARRIVED.match(line) is not None for line in first) < _MOSTLY * len(first):
        return None
    arrived = [match.groups() for line in lines if (match := _ARRIVED.match(line))]
    layout = find_layout([rest for _, rest in arrived[:FIRST_LINES]])
    if layout is None or not layout.names:
        return None
    mark = layout.delimiter or " "
    return [
        f"{rest}{mark}{'arrived_time' if number == layout.names_line else stamp}"
        for number, (stamp, rest) in enumerate(arrived)
        if number >= layout.names_line
    ]


def _tabulate_elements(lines: Sequence[str]) -> list[str] | None:
    """A row for each line of XML with several numbers in its attributes or elements; None where there are none.

    `<Rob><AIPos A1="0.1" A2="0.2"/><IPOC>4208</IPOC></Rob>` has AIPos.A1, AIPos.A2 and IPOC.
    """
    first = [line for line in lines[:FIRST_LINES] if line.strip()]
    if sum(len(_read_elements(line)) >= _FEWEST_ENTRIES for line in first) <= _MOSTLY * len(first):
        return None
    rows = [row for line in lines if len(row := _read_elements(line)) >= _FEWEST_ENTRIES]
    return join_rows(rows)


def _read_elements(line: str) -> dict[str, str]:
    """The numbers in the elements of a line, by element and attribute."""
    if "<" not in line:
        return {}
    found: dict[str, str] = {}
    for tag, attributes, text in _ELEMENT.findall(line):
        found |= {f"{tag}.{name}": value for name, value in _ATTRIBUTE.findall(attributes)}
        found |= {tag: text} if text else {}
    return found


def _transpose(lines: Sequence[str]) -> list[str] | None:
    """The columns of a table that has a channel a line, each with its name in front; None where it has not."""
    channels = [line for line in lines if line.strip() and not is_comment(line)]
    if channels and len(channels) <= _MOST_CHANNELS and all(map(_NAMED_LIST.match, channels)):
        channels = [_NAMED_LIST.sub(r"\1,\2", line) for line in channels]
    if not 1 < len(channels) <= _MOST_CHANNELS or min(map(len, channels)) < _LONG_LINE:
        return None
    mark = next((one for one in ("\t", ";", ",") if all(line.count(one) >= _LONG_ROW for line in channels)), "")
    table = [split_cells(line, mark) for line in channels] if mark else []
    has_names = all(row[0] and not is_number(row[0]) and is_number(row[1]) for row in table)
    if not table or not has_names or len({len(row) for row in table}) > 1:
        return None
    return [_join(cells, mark) for cells in zip(*table, strict=True)]


def _name_joint_states(lines: Sequence[str]) -> list[str] | None:
    """The rows that `ros2 topic echo --csv` prints of joint states below their names; None where they are no such.

    Seconds, nanoseconds, frame, the names of all joints, and as many positions, velocities and efforts.
    """
    first = [split_cells(line, ",") for line in lines[:FIRST_LINES] if line.strip()][:_FEWEST_ENTRIES]
    joints = list(itertools.takewhile(lambda cell: cell and not is_number(cell), first[0][3:])) if first else []
    start = 3 + len(joints)
    if not joints or any(len(row) != start + 3 * len(joints) or row[3:start] != joints for row in first):
        return None
    if not all(row[0].isdigit() and row[1].isdigit() and all(map(is_number, row[start:])) for row in first):
        return None
    named = [f"{joint}/{field}" for field in ("position", "velocity", "effort") for joint in joints]
    head = ["stamp.sec", "stamp.nanosec", "frame_id", *(f"name_{k}" for k in range(1, len(joints) + 1)), *named]
    return [_join(head, ","), *lines]


def _without_units(lines: Sequence[str], layout: TextLayout) -> list[str] | None:
    """The table with bare numbers in place of cells such as `12.3°`; None where there are none.

    They are in SI where the name of the column states no unit, because programs that write the unit into the cell
    choose it by the size of the number, and that unit stands behind the name; else they are left as they are.
    """
    row = split_cells(lines[layout.rows_line], layout.delimiter) if layout.rows_line < len(lines) else []
    measured = [k for k, cell in enumerate(row) if read_measured(cell)]
    if not measured or not layout.delimiter:
        return None
    said = [bool(find_unit_words(name, -1)) for name in layout.names]
    units = {k: read_measured_si(row[k]) for k in measured if k < len(said) and not said[k]}
    names = [f"{name} [{units[k]}]" if units.get(k) else name for k, name in enumerate(layout.names)]
    plain = [_join(names, layout.delimiter)]
    for line in lines[layout.rows_line :]:
        if line.strip() and not is_comment(line):
            cells = split_cells(line, layout.delimiter)
            for k in measured:
                if k < min(len(cells), len(said)):
                    cells[k] = _as_number(cells[k], layout.decimal, as_written=said[k])
            plain.append(_join(cells, layout.delimiter))
    return plain


def _as_number(cell: str, decimal: str, *, as_written: bool) -> str:
    found = read_measured(cell)
    if found is None:
        return cell
    number, factor, offset = found
    return number if as_written else repr(factor * parse_number(number, decimal) + offset)


def _join(cells: Sequence[str], mark: str) -> str:
    """A line of these cells."""
    return mark.join('"' + cell.replace('"', '""') + '"' if '"' in cell or mark in cell else cell for cell in cells)

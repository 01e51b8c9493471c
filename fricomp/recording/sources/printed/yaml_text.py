"""Rows and columns of YAML, as programs write and ROS prints them, made plain tables."""

import re
from collections.abc import Iterable, Sequence

from fricomp.recording.sources.cell import is_entry
from fricomp.recording.sources.text_layout import FIRST_LINES

from .labelled_rows import join_rows

_ENTRY = re.compile(r"^(\s*)(?:- (?!\w+:\s)|(\w+):)\s*(.*)$")
"""A line of a printed message: an entry of a list, or a key with its value."""
_ITEM = re.compile(r"^(\s*)- (\w+:(?:\s.*)?)$")
"""The first line of an object in a list."""
_KEY = re.compile(r"^(\s*)[\"']?([A-Za-z_][\w ./]*?)[\"']?:\s*(\[.*)?$")
_NUMBER = re.compile(r"^\s*- (\S+)\s*$")
"""A key above a list or before one in brackets, and an entry of a list."""
_FEWEST_ITEMS = 3
"""Objects in a list that are rows, and lists that are the columns of a table: time, position and torque."""
_FEWEST_ENTRIES = 20
"""Numbers of a list that is a column."""


def tabulate_yaml(lines: Sequence[str]) -> list[str] | None:
    """The lines of a table with the same numbers; None where the lines are no rows or columns of YAML.

    Messages as `ros2 topic echo` prints them, objects in a list, and lists of as many numbers below their names.

    Args:
        lines: Of a text.
    """
    return _tabulate_messages(lines) or _tabulate_items(lines) or _tabulate_lists(lines)


def _tabulate_messages(lines: Sequence[str]) -> list[str] | None:
    """Rows of the messages that `ros2 topic echo` or `rostopic echo` prints; None where there are none.

    Lists beside a list `name` are `<name>/<field>`; the last message is left out where it was cut off.
    """
    first = [line.strip() for line in lines[:FIRST_LINES]]
    if "---" not in first or not any(line.startswith("position:") for line in first):
        return None
    rows: list[dict[str, str]] = []
    message: list[str] = []
    for line in lines:
        if line.strip() == "---":
            rows.append(_read_message(message))
            message = []
        else:
            message.append(line)
    return join_rows(rows)


def _tabulate_items(lines: Sequence[str]) -> list[str] | None:
    """Rows of the objects in a list, an entry a line; None where there is no such list."""
    begins = [match for line in lines[:FIRST_LINES] if (match := _ITEM.match(line))]
    if len(begins) < _FEWEST_ITEMS:
        return None
    indent = begins[0].group(1)
    items: list[list[str]] = []
    for line in lines:
        match = _ITEM.match(line)
        if match and match.group(1) == indent:
            items.append([f"{indent}  {match.group(2)}"])
        elif items and line.startswith(f"{indent}  "):
            items[-1].append(line)
    return join_rows([_read_message(item) for item in items])


def _tabulate_lists(lines: Sequence[str]) -> list[str] | None:
    """The table of all lists of numbers that are as long as the longest; None where there are not three of them."""
    listed = sum(_NUMBER.match(line) is not None or "[" in line for line in lines[:FIRST_LINES])
    if not listed or not any(_KEY.match(line) for line in lines[:FIRST_LINES]):
        return None
    columns = {name: cells for name, cells in _read_lists(lines).items() if len(cells) >= _FEWEST_ENTRIES}
    longest = max(map(len, columns.values()), default=0)
    table = {name: cells for name, cells in columns.items() if len(cells) == longest and all(map(is_entry, cells))}
    if len(table) < _FEWEST_ITEMS:
        return None
    return [",".join(table), *map(",".join, zip(*table.values(), strict=True))]


def _read_lists(lines: Iterable[str]) -> dict[str, list[str]]:
    """The cells of each list by the path of its name."""
    path: list[tuple[int, str]] = []
    lists: dict[str, list[str]] = {}
    in_brackets = False
    for line in lines:
        key, number = None if in_brackets else _KEY.match(line), _NUMBER.match(line)
        if key is not None:
            indent = len(key.group(1))
            path = [*(one for one in path if one[0] < indent), (indent, key.group(2))]
        elif number is None and not in_brackets:
            continue
        own = lists.setdefault(".".join(name for _, name in path), [])
        text = (key.group(3) or "") if key is not None else line
        if number is not None and not in_brackets:
            own.append(number.group(1))
        elif text:
            own += [cell for cell in (one.strip(" []\r\n") for one in text.split(",")) if cell]
            in_brackets = "]" not in text
    return lists


def _read_message(lines: Sequence[str]) -> dict[str, str]:
    """The entries of a printed message by their path, those of lists by the names beside them or their number."""
    path: list[tuple[int, str]] = []
    lists: dict[str, list[str]] = {}
    entries: dict[str, str] = {}
    for line in lines:
        match = _ENTRY.match(line)
        if match is None:
            continue
        indent, key, value = len(match.group(1)), match.group(2), match.group(3).strip("'\" ")
        if key is None:
            lists.setdefault(".".join(name for _, name in path), []).append(value)
            continue
        path = [*(one for one in path if one[0] < indent), (indent, key)]
        name = ".".join(one for _, one in path)
        if value.startswith("["):
            lists[name] = [one.strip("'\" ") for one in value.strip("[]").split(",")]
        elif value:
            entries[name] = value
    named = lists.pop("name", [])
    for field, values in lists.items():
        of = named if len(named) == len(values) else []
        entries |= {f"{of[k]}/{field}" if of else f"{field}:{k + 1}": value for k, value in enumerate(values)}
    return {name: value for name, value in entries.items() if "," not in value}

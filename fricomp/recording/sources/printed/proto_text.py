"""Messages in the text form of protobuf, as `gz topic -e` prints the joints of a simulation, made a plain table."""

import re
from collections.abc import Iterator, Sequence

from fricomp.recording.sources.text_layout import FIRST_LINES
from fricomp.untrusted import require_filled

_OPENS = re.compile(r"^\s*(\w+)\s*:?\s*\{$")
_FIELD = re.compile(r"^\s*(\w+)\s*:\s*(?:\"(.*)\"|(\S+))$")
_CLOSES = re.compile(r"^\s*\}$")
"""A line that begins an object, one with a word or a number, and the end of an object."""
_DEEPEST = 16
_NOT_OF_JOINTS = ("pose", "xyz", "orientation", "inertial")
"""Objects of a joint that say where it is mounted."""


def tabulate_proto(lines: Sequence[str]) -> list[str] | None:
    """The lines of a table with a row a message; None where the lines are no such messages.

    The numbers of an object with a name are `<name>.<field>`. A field that a message does not state is zero there, as
    protobuf has it; the last message is left out where it was cut off.

    Args:
        lines: Of a text.
    """
    first = [line.rstrip() for line in lines[:FIRST_LINES] if line.strip()]
    said = sum(any(one.match(line) for one in (_OPENS, _FIELD, _CLOSES)) for line in first)
    if not first or said < len(first) or not any(map(_CLOSES.match, first)) or not any(map(_FIELD.match, first)):
        return None
    rows = [row for message in _cut_messages(lines) if (row := _read_message(message))]
    names = list(dict.fromkeys(name for row in rows for name in row))
    require_filled(len(rows), len(names), sum(map(len, rows)))
    return [",".join(names), *(",".join(row.get(name, "0") for name in names) for row in rows)]


def _cut_messages(lines: Sequence[str]) -> Iterator[list[str]]:
    """The lines of each whole message: they end by an empty line, or where the first field of all begins again."""
    depth, message = 0, list[str]()
    start = next((line.split()[0] for line in lines if line.strip()), "")
    for line in lines:
        begins = not line.strip() or (not line[0].isspace() and line.split()[0] == start)
        if depth == 0 and message and begins:
            yield message
            message = []
        depth += bool(_OPENS.match(line.rstrip())) - bool(_CLOSES.match(line))
        message += [line.rstrip()] if line.strip() else []
    if depth == 0 and message:
        yield message


def _read_message(lines: Sequence[str]) -> dict[str, str]:
    """The numbers of a message by the path of their names, or below the name of the object that they are of."""
    path: list[str] = []
    numbers: dict[str, str] = {}
    for line in lines:
        opens, field = _OPENS.match(line), _FIELD.match(line)
        if opens is not None and len(path) < _DEEPEST:
            path.append(opens.group(1))
        elif field is not None and field.group(1) == "name" and path:
            path[-1] = field.group(2)
        elif field is not None and field.group(3) and not set(path) & set(_NOT_OF_JOINTS):
            numbers[".".join([*path, field.group(1)])] = field.group(3)
        elif path and opens is None and field is None:
            path.pop()
    return {name: number for name, number in numbers.items() if "," not in name + number}

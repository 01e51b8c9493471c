"""Variables as `save` of GNU Octave writes them by default: in text, each below its name, type and size."""

import itertools
import re
from collections.abc import Sequence

from fricomp.recording.sources.text_line import is_comment

_FACT = re.compile(r"^[#%] (name|type|rows|columns): (.*)$")
_MATRICES = ("matrix", "bool matrix", "float matrix", "diagonal matrix")


def tabulate_variables(lines: Sequence[str]) -> list[str] | None:
    """A table of the vectors and matrices with the most rows; None where the lines are no such file.

    The columns of a matrix are `name:1` and so on; a row vector is turned. Variables of another length are left out.

    Args:
        lines: Of a text.
    """
    first = [_FACT.match(line) for line in itertools.islice(lines, 20)]
    if not {"name", "type"} <= {match.group(1) for match in first if match}:
        return None
    columns: dict[str, list[str]] = {}
    for name, kind, rows in _list_blocks(lines):
        if kind in _MATRICES and rows:
            table = [row for row in rows if len(row) == len(rows[0])]
            table = [list(column) for column in zip(*table, strict=True)] if len(table) == 1 else table
            parts = list(zip(*table, strict=True))
            columns |= {name if len(parts) == 1 else f"{name}:{k}": list(part) for k, part in enumerate(parts, 1)}
    longest = max(map(len, columns.values()), default=0)
    kept = {name: values for name, values in columns.items() if len(values) == longest}
    if longest < 2:
        return None
    return [",".join(kept), *(",".join(cells) for cells in zip(*kept.values(), strict=True))]


def _list_blocks(lines: Sequence[str]) -> list[tuple[str, str, list[list[str]]]]:
    """Name, type and rows of cells of each variable."""
    blocks: list[tuple[str, str, list[list[str]]]] = []
    for line in lines:
        fact = _FACT.match(line)
        if fact and fact.group(1) == "name":
            blocks.append((fact.group(2).strip(), "", []))
        elif fact and fact.group(1) == "type" and blocks:
            blocks[-1] = (blocks[-1][0], fact.group(2).strip(), [])
        elif blocks and line.strip() and not is_comment(line):
            blocks[-1][2].append(line.split())
    return blocks

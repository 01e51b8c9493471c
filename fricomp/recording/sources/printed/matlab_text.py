"""Variables that a script of MATLAB or Octave sets, `x = [ … ];`, and rows that LaTeX sets between `&`, as a table."""

import re
from collections.abc import Sequence

from fricomp.recording.sources.cell import is_number
from fricomp.recording.sources.text_layout import FIRST_LINES

_SETS = re.compile(r"^[ \t]*([A-Za-z][\w.]*)\s*=\s*\[")
_MATRIX = re.compile(r"^[ \t]*([A-Za-z][\w.]*)[ \t]*=[ \t]*\[([^\[\]]*)(?:\]|\Z)\s*(['.]*)\s*;?", re.MULTILINE)
_CELLS = re.compile(r"=\s*[{\[]\s*((?:['\"][^'\"]*['\"][\s,;]*)+)[}\]]")
_WORD = re.compile(r"['\"]([^'\"]*)['\"]")
"""Beginning of a matrix; its name, numbers, which may be cut off, and what turns it; words in braces, which may be the
names of its columns."""
_COMMENT = re.compile(r"%(.*)$", re.MULTILINE)
_GOES_ON = re.compile(r"\.\.\.[^\n]*\n")
_FEWEST_ROWS, _FEWEST_COLUMNS = 10, 3
_NAMES_APART = (re.compile(r"\s*[,;|\t]\s*"), re.compile(r"\s{2,}"), re.compile(r"\s+"))
_MOSTLY = 0.5


def tabulate_matrices(lines: Sequence[str]) -> list[str] | None:
    """A table of the matrix with the most rows, or of all vectors that are as long; None where none is set.

    The columns of a matrix are called as words in braces are, or those of a comment, that are as many; else they have
    no names.

    Args:
        lines: Of a text.
    """
    if not any(map(_SETS.match, lines[:FIRST_LINES])):
        return None
    text = _GOES_ON.sub(" ", "\n".join(lines))
    names = [_WORD.findall(words) for words in _CELLS.findall(text)]
    names += [said for comment in _COMMENT.findall(text[: text.find("[")]) for said in _split_names(comment)]
    columns: dict[str, list[str]] = {}
    for name, numbers, turns in _MATRIX.findall(_COMMENT.sub("", text)):
        rows = [cells for row in re.split(r"[;\n]", numbers) if (cells := row.replace(",", " ").split())]
        rows = [list(column) for column in zip(*rows, strict=False)] if turns or len(rows) == 1 else rows
        rows = [row for row in rows if len(row) == len(rows[0])]
        width = len(rows[0]) if rows else 0
        called = next((said for said in names if len(said) == width > 1), [])
        own = [name] if width == 1 else called or [f"{name}:{k}" for k in range(1, width + 1)]
        columns |= dict(zip(own, map(list, zip(*rows, strict=True)), strict=True))
    longest = max(map(len, columns.values()), default=0)
    kept = {name: cells for name, cells in columns.items() if len(cells) == longest}
    if longest < _FEWEST_ROWS or len(kept) < _FEWEST_COLUMNS or not all(is_number(cells[0]) for cells in kept.values()):
        return None
    head = [] if all(":" in name for name in kept) else [",".join(f'"{one}"' if "," in one else one for one in kept)]
    return [*head, *(",".join(row) for row in zip(*kept.values(), strict=True))]


def _split_names(comment: str) -> list[list[str]]:
    """What may be the names of columns in a comment: `% log: t [s], q [rad], tau [Nm]`."""
    said = comment.rpartition(":")[2].strip()
    return [mark.split(said) for mark in _NAMES_APART] if said else []


def tabulate_latex(lines: Sequence[str]) -> list[str] | None:
    """The rows that stand between `&` and end in `\\\\`, between commas; None where most lines are none.

    Args:
        lines: Of a text.
    """
    first = [line for line in lines[:FIRST_LINES] if line.strip() and not line.lstrip().startswith("%")]
    if not first or sum(bool(_cut_row(line)) for line in first) < _MOSTLY * len(first):
        return None
    rows = [[_strip_marks(cell) for cell in row] for line in lines if (row := _cut_row(line))]
    return [",".join(f'"{cell}"' if "," in cell else cell for cell in row) for row in rows]


def _cut_row(line: str) -> list[str]:
    """The cells of a row; none of any other line."""
    row, end, _ = line.partition("\\\\")
    return row.split("&") if end and "&" in row else []


def _strip_marks(cell: str) -> str:
    """A cell without the marks of formulas and fonts: `$-0.5$`, `\\textbf{Time}`."""
    return re.sub(r"\\(?:text\w*|math\w*|si|unit|num|hline|toprule|midrule)\b|[${}]|\\,", "", cell).strip()

"""Rows of a data base or of a page as programs write them out: `INSERT INTO log VALUES (…)`, `COPY`, `<tr><td>`."""

import csv
import html
import io
import re
from collections.abc import Sequence

from fricomp.recording.sources.text_layout import FIRST_LINES

_INSERT = re.compile(
    r"""\bINSERT\s+(?:OR\s+\w+\s+|IGNORE\s+)?INTO\s+([^\s(]+)\s*(?:\(([^()]*)\)\s*)?VALUES\s*"""
    r"""((?:\((?:'[^']*'|[^()'])*+\)\s*+(?:,\s*+)?)++)""",
    re.IGNORECASE,
)
"""Rows that go into a table: its name, the names of its columns where they are said, and the rows."""
_ROW = re.compile(r"\(((?:'[^']*'|[^()'])*+)\)")
_CREATE = re.compile(
    r"\bCREATE\s+TABLE\s+(?:IF\s+NOT\s+EXISTS\s+)?([^\s(]+)\s*\(((?:[^();]|\([^()]*\))*+)\)", re.IGNORECASE
)
_COPY = re.compile(r"^COPY\s+([^\s(]+)\s*\(([^()]*)\)\s+FROM\s+stdin;[^\n]*\n((?:(?!\\\.).*\n)*)", re.IGNORECASE | re.M)
"""Rows between tabs, as PostgreSQL dumps them."""
_OF_TABLE = ("primary", "unique", "key", "constraint", "foreign", "index", "check")
"""First words of what a table is told beside its columns."""
_BEGINS = re.compile(r"^\s*(?:INSERT\s.*INTO|COPY\s|CREATE\s+TABLE)\b", re.IGNORECASE)
_TAG, _TABLE_ROW = re.compile(r"<[^<>]*>"), re.compile(r"<(?:tr|row|table:table-row)\b[^<>]*>", re.IGNORECASE)
_CELL = r"(?:t[dh]|cell|table:table-cell)\b"
_TABLE_CELL = re.compile(rf"<{_CELL}[^<>]*(?:/>|>(.*?)(?=</?{_CELL}|</?tr\b|</row|$))", re.IGNORECASE | re.S)
"""Rows and cells of a page, and of a spreadsheet that is kept as XML."""
_MARKS = "`\"[] '"
"""What may stand about a name."""


def tabulate_dump(lines: Sequence[str]) -> list[str] | None:
    """The lines of the table with the most rows of a dump or a page, its names above them; None of any other text.

    Args:
        lines: Of a text.
    """
    if any(_BEGINS.match(line) for line in lines[:FIRST_LINES]):
        return _write(_read_statements("\n".join(lines)))
    if any(_TABLE_ROW.search(line) for line in lines[:FIRST_LINES]) or _begins_page(lines):
        return _write(_read_page("\n".join(lines)))
    return None


def _begins_page(lines: Sequence[str]) -> bool:
    """Whether a text is a page or XML, whose table may stand behind what it looks like."""
    return any(line.lstrip().lower().startswith(("<!doctype html", "<html", "<?xml")) for line in lines[:3])


def _write(table: Sequence[Sequence[str]]) -> list[str] | None:
    """The lines of a table; None where it has no rows."""
    if len(table) < 2:
        return None
    written = io.StringIO()
    csv.writer(written, lineterminator="\n").writerows(table)
    return written.getvalue().splitlines()


def _read_statements(text: str) -> list[list[str]]:
    """Names and rows of the table that most rows go into."""
    said = {name.strip(_MARKS): _read_names(columns) for name, columns in _CREATE.findall(text)}
    tables = dict[str, list[list[str]]]()
    for name, columns, rows in _INSERT.findall(text):
        table = tables.setdefault(name.strip(_MARKS), [])
        if not table:
            table.append(_read_names(columns) or said.get(name.strip(_MARKS), []))
        table += (next(csv.reader([row], quotechar="'", skipinitialspace=True), []) for row in _ROW.findall(rows))
    for name, columns, rows in _COPY.findall(text):
        tables[name] = [_read_names(columns), *(row.split("\t") for row in rows.splitlines())]
    return max(tables.values(), key=len, default=[])


def _read_names(columns: str) -> list[str]:
    """Names of the columns of a table, from what is said of them between commas."""
    named = [words[0].strip(_MARKS) for one in columns.split(",") if (words := one.split())]
    return [name for name in named if name.lower() not in _OF_TABLE]


def _read_page(text: str) -> list[list[str]]:
    """Cells of the rows of the largest table of a page."""
    tables = [
        [
            [html.unescape(_TAG.sub("", cell)).strip() for cell in _TABLE_CELL.findall(row)]
            for row in _TABLE_ROW.split(table)[1:]
        ]
        for table in re.split(r"</table\s*>", text, flags=re.IGNORECASE)
    ]
    return [row for row in max(tables, key=len, default=[]) if row]

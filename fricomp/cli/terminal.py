"""What commands share on the terminal: a console, tables that fit it, a progress bar that is quiet when nobody watches.

Where `--quiet` or `--json` is given, the console that would write to stdout writes nothing, and what it is told is kept
for the answer. What is piped is never wrapped.
"""

import os
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rich.table
from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.segment import Segment
from rich.text import Text

from fricomp.cli.output import hearing, say_interrupted

_CONTROL = {code: f"\\x{code:02x}" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in "\n\t"}
_CONTROL |= {
    code: f"\\u{code:04x}" for code in (*range(0x202A, 0x202F), *range(0x2066, 0x206A), *range(0xD800, 0xE000))
}
"""What a terminal would obey, what turns the direction of writing, and what no encoding has, by what is shown."""

_PIPED = 100_000
"""Columns of a place that is no terminal: nothing is wrapped there, so that a line is what `grep` should find."""


def plain(text: str) -> str:
    """Text from a file, in which nothing is left that a terminal would obey."""
    return text.translate(_CONTROL)


class Table(rich.table.Table):
    """A table whose cells are folded, never cut; where not even its words fit, each row becomes a list of its cells."""

    def add_column(self, header: RenderableType = "", *arguments: Any, **settings: Any) -> None:
        super().add_column(header, *arguments, **{"overflow": "fold", **settings})

    def __init__(self, *headers: rich.table.Column | str, **settings: Any) -> None:
        super().__init__(**{"title_justify": "left", **settings})
        for header in headers:
            self.add_column(header) if isinstance(header, str) else self.columns.append(header)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        if self._set_widths(options.max_width):
            yield from super().__rich_console__(console, options)
            return
        if self.title:
            yield Text(str(self.title), "italic")
        for cells in self._rows():
            for number, (column, cell) in enumerate(zip(self.columns, cells, strict=True)):
                if cell.strip():
                    yield Text(f"{'- ' if number == 0 else '  '}{column.header}: {cell}".replace(" : ", " ", 1))

    def _set_widths(self, width: int) -> bool:
        """Give each column its longest word, then its longest line or an even part of the room; whether that fits.

        Rich narrows columns in proportion, and would break a word in one to leave another its spaces.
        """
        cells = [[str(cell) for cell in (column.header, *column.cells)] for column in self.columns]
        words = [max((len(word) for cell in one for word in cell.split()), default=1) for one in cells]
        lines = [max(len(line) for cell in one for line in (cell.splitlines() or [""])) for one in cells]
        room = width - sum(words) - 2 * len(words) - (len(words) + 1 if self.box else 0)
        if room < 0:
            return False
        wanted = sorted(zip(self.columns, words, lines, strict=True), key=lambda each: each[2] - each[1])
        for left, (column, word, line) in zip(range(len(wanted), 0, -1), wanted, strict=True):
            more = min(room // left, line - word)
            column.width, room = word + more, room - more
        return True

    def _rows(self) -> list[tuple[str, ...]]:
        return list(zip(*(map(str, column.cells) for column in self.columns), strict=True))

    def to_builtins(self) -> dict[str, Any]:
        """Title, columns and rows."""
        columns = [str(column.header) for column in self.columns]
        return {"title": str(self.title or ""), "columns": columns, "rows": self._rows()}


def make_table(heads: Iterable[str], rows: Iterable[Iterable[str]], **settings: Any) -> Table:
    """A table of these rows; settings are those of `rich.table.Table`."""
    table = Table(*heads, **settings)
    for row in rows:
        table.add_row(*row)
    return table


class _PlainConsole(Console):
    """A console that shows control characters of names and messages instead of sending them to the terminal."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=plain(segment.text))


class _KeptConsole(_PlainConsole):
    """A console that keeps what it is told for an answer in JSON."""

    def print(self, *objects: Any, **settings: Any) -> None:
        said = hearing()
        for one in objects:
            if isinstance(one, Table):
                said.tables.append(one.to_builtins())
            elif str(one).strip():
                said.sentences.append(plain(str(one)).strip())


def console(*, stderr: bool = False) -> Console:
    """Where commands print tables and sentences; brackets in them, as of an extra or a folder, are no markup."""
    said = hearing()
    if said.as_json and not stderr:
        return _KeptConsole(markup=False)
    stream = sys.stderr if stderr else sys.stdout
    piped = not stream.isatty() and "COLUMNS" not in os.environ
    width = _PIPED if piped else None
    return _PlainConsole(stderr=stderr, highlight=False, markup=False, width=width, quiet=said.quiet)


def progress(*, quiet: bool = False) -> Progress:
    """A progress bar with the time left; on stderr, and silent when that is not a terminal or quiet is asked for."""
    errors = console(stderr=True)
    return Progress(
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TaskProgressColumn(),
        TimeRemainingColumn(),
        console=errors,
        transient=True,
        disable=quiet or hearing().quiet or not errors.is_terminal,
    )


@contextmanager
def resumable(out: Path, way: str = "--resume goes on") -> Iterator[None]:
    """Work whose finished parts are in a folder: on Ctrl-C it says so, and how to go on.

    Args:
        out: The folder.
        way: How to go on.
    """
    try:
        yield
    except KeyboardInterrupt:
        say_interrupted(f"; what is finished is in {out}: {way}")
        raise

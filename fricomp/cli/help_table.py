"""Options in `--help`: beside their descriptions, or above them where a terminal is narrow; names are never cut.

A flag has no type behind its name: `--quiet <bool>` reads as if a value had to be given.
"""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType, RenderResult
from rich.padding import Padding
from rich.table import Table
from rich.text import Text
from typer import rich_utils

_LEAST = 24
"""Columns that a description needs beside its option: some three words."""

_FLAG = "<bool>"
"""What typer shows as the type of a flag."""

_INDENT = 4
"""By how much a description stands in below its option [columns]."""


class HelpTable(Table):
    """Typer's table of options, which rich would narrow by cutting the longest words of every column."""

    def add_row(self, *cells: RenderableType | None, **settings: Any) -> None:
        """A row, without the type of a flag."""
        super().add_row(*(None if _as_text(cell or "").plain == _FLAG else cell for cell in cells), **settings)

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        *names, _ = self.columns
        rows = [list(row) for row in zip(*(column.cells for column in self.columns), strict=True)]
        widths = [max((console.measure(cell).maximum for cell in column.cells), default=0) for column in names]
        if len(names) < 2 or sum(width + 2 for width in widths) + _LEAST <= options.max_width:
            yield from super().__rich_console__(console, options)
            return
        for *head, said in rows:
            text = Text(" ", overflow="fold").join(cell for cell in map(_as_text, head) if cell)
            yield text
            yield Padding(said, (0, 0, 0, _INDENT))


def _as_text(cell: RenderableType) -> Text:
    return cell if isinstance(cell, Text) else Text(str(cell))


@contextmanager
def whole_names() -> Iterator[None]:
    """While it lasts, typer draws its tables of options as a `HelpTable`."""
    module: Any = rich_utils  # which has no setting for it
    kept = module.Table
    module.Table = HelpTable
    try:
        yield
    finally:
        module.Table = kept

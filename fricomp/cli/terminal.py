"""What commands share on the terminal: a console, and a progress bar that is quiet when nobody watches."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from rich.console import Console, ConsoleOptions, RenderableType
from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn
from rich.segment import Segment

__all__ = ["console", "plain", "progress", "resumable"]


_CONTROL = {code: f"\\x{code:02x}" for code in (*range(0x20), *range(0x7F, 0xA0)) if chr(code) not in "\n\t"}
_CONTROL |= {
    code: f"\\u{code:04x}" for code in (*range(0x202A, 0x202F), *range(0x2066, 0x206A), *range(0xD800, 0xE000))
}
"""What a terminal would obey, what turns the direction of writing, and what no encoding has, by what is shown."""


def plain(text: str) -> str:
    """Text from a file, in which nothing is left that a terminal would obey."""
    return text.translate(_CONTROL)


class _PlainConsole(Console):
    """A console that shows control characters of names and messages instead of sending them to the terminal."""

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        for segment in super().render(renderable, options):
            yield segment if segment.control else segment._replace(text=plain(segment.text))


def console(*, stderr: bool = False) -> Console:
    """Where commands print tables and sentences; brackets in them, as of an extra or a folder, are no markup."""
    return _PlainConsole(stderr=stderr, highlight=False, markup=False)


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
        disable=quiet or not errors.is_terminal,
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
        print(f"\nInterrupted; what is finished is in {out}: {way}", file=sys.stderr)
        raise

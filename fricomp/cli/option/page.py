"""Pages that a command opens: its report with `--open`, and with `--live` the page of a joint that moves."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from fricomp.cli.option.panel import output_option

if TYPE_CHECKING:
    from fricomp.live.feed import LiveFeed

OpenPage = Annotated[bool, output_option("--open", help="Open the page that is written in the browser.")]
"""The option; its default is False."""
OpenPages = Annotated[bool, output_option("--open", help="Open the report in the browser, and the page of --live.")]
"""The option of commands with `--live`; its default is False."""
Live = Annotated[
    bool,
    output_option(
        "--live",
        help="Watch the joint on a page in the browser of this machine, with a button that stops it; a simulated joint "
        "then moves in real time.",
    ),
]
"""The option; its default is False."""


def open_page(page: Path | str, *, wanted: bool) -> None:
    """Open a page where that is wanted; where there is no browser, its address is said.

    Args:
        page: File, or address.
        wanted: Whether `--open` was given.
    """
    if not wanted:
        return
    import webbrowser

    address = page.resolve().as_uri() if isinstance(page, Path) else page
    if not webbrowser.open(address):
        print(f"No browser was found to open {address}", file=sys.stderr)


@contextmanager
def watching(title: str, *, live: bool, opened: bool) -> Iterator[LiveFeed | None]:
    """The live page of a command, whose address is said on stderr; None where nobody asked for it.

    Args:
        title: Heading of the page.
        live: Whether `--live` was given.
        opened: Whether `--open` was.

    Raises:
        AdapterError: The page cannot be served.
    """
    if not live:
        yield None
        return
    from fricomp.live.feed import LiveFeed

    with LiveFeed(title) as feed:
        print(f"Live page, with a stop: {feed.address}", file=sys.stderr, flush=True)
        open_page(feed.address, wanted=opened)
        yield feed

"""An answer for a program: one JSON value on stdout, and everything else on stderr."""

from __future__ import annotations

from typing import Annotated, Any

from fricomp.cli.option.panel import output_option
from fricomp.cli.output import hearing, print_json

__all__ = ["AsJson", "answer", "print_json"]

AsJson = Annotated[bool, output_option("--json", help="Print the answer as JSON, and nothing else on stdout.")]
"""The option, for commands that say something else where it is given; every other command has it all the same."""


def answer(value: Any) -> None:
    """Print the answer of a command where `--json` asks for it; in its place, what the command said would be printed.

    Args:
        value: As of `print_json`.
    """
    if hearing().as_json:
        print_json(value)

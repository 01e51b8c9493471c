"""An answer for a program: one JSON value on stdout, and everything else on stderr."""

from __future__ import annotations

from typing import Annotated, Any

import typer

__all__ = ["AsJson", "print_json"]

AsJson = Annotated[
    bool, typer.Option("--json", rich_help_panel="Output", help="Print the answer as JSON, and nothing else on stdout.")
]
"""The option; its default is False."""


def print_json(answer: Any) -> None:
    """Print a value as JSON on stdout; a number that is not finite is null, as JSON has none.

    Args:
        answer: Mappings, sequences, dataclasses, msgspec structs, numbers, texts, paths.
    """
    import msgspec

    print(msgspec.json.format(msgspec.json.encode(answer, enc_hook=_encode)).decode())


def _encode(value: Any) -> Any:
    """Arrays and numbers of numpy as Python's own, anything else as its text."""
    return value.tolist() if hasattr(value, "tolist") else str(value)

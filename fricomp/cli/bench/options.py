"""Options that several benchmarks share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["LOG", "ExecutorOption", "LogOption", "WorkersOption"]

ExecutorOption = Annotated[str, typer.Option(help="processes://N, serial or dask://host:port.")]
WorkersOption = Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")]
LogOption = Annotated[Path, typer.Option(help="Log of the scored runs, their data beside it.")]
LOG = Path("docs/proof/runs.jsonl")
"""Where the log of the scored runs is in a checkout."""

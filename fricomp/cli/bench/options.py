"""Options that several benchmarks share."""

from __future__ import annotations

from typing import Annotated

import typer

ExecutorOption = Annotated[str, typer.Option(help="processes://N, serial or dask://host:port.")]
WorkersOption = Annotated[int | None, typer.Option(min=1, help="Processes; one a core by default.")]

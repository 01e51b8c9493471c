"""Finished draws on disk, so that a long run can go on where it stopped."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

__all__ = ["Ledger"]


class Ledger:
    """A file of JSON lines, one a finished draw, read once and kept in memory.

    Attributes:
        path: The file.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        self._torn = bool(text) and not text.endswith("\n")
        self._rows = [row for row in map(_parse, text.splitlines()) if row is not None]

    def rows(self, **wanted: object) -> list[dict[str, Any]]:
        """The lines whose fields equal `wanted`, ordered by seed."""
        rows = [row for row in self._rows if all(row.get(k) == v for k, v in wanted.items())]
        return sorted(rows, key=lambda row: int(row["seed"]))

    def missing(self, seeds: Sequence[int], **wanted: object) -> Iterator[int]:
        """The seeds without a line."""
        done = {row["seed"] for row in self.rows(**wanted)}
        return iter([seed for seed in seeds if seed not in done])

    def append(self, row: dict[str, Any]) -> None:
        """Add a finished draw."""
        line = json.dumps(row, default=lambda a: np.asarray(a).tolist())
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(("\n" if self._torn else "") + line + "\n")
        self._torn = False
        self._rows.append(json.loads(line))


def _parse(line: str) -> dict[str, Any] | None:
    """The row, or None for the half line that a killed run leaves."""
    try:
        row = json.loads(line)
    except json.JSONDecodeError:
        return None
    return row if isinstance(row, dict) else None

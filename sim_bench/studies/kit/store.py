"""Finished cases on disk, so that a run that was stopped can go on."""

import json
import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

Row = dict[str, Any]


class RowStore:
    """A file of JSON lines, one for each finished case or draw. It is only ever appended to.

    The file is read once and kept in memory. Lines are on the disk when `append` returns; the half line that a killed
    run leaves is skipped.

    Attributes:
        path: The file; it is made with the first row.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        text = path.read_text(encoding="utf-8") if path.exists() else ""
        self._torn = bool(text) and not text.endswith("\n")
        self._rows = [row for row in map(_parse, text.splitlines()) if row is not None]

    def rows(self, **wanted: object) -> list[Row]:
        """The rows whose fields equal `wanted`, ordered by seed where they have one."""
        rows = [row for row in self._rows if all(row.get(name) == value for name, value in wanted.items())]
        return sorted(rows, key=lambda row: int(row.get("seed", 0)))

    def find_missing(self, seeds: Sequence[int], **wanted: object) -> Iterator[int]:
        """The seeds for which there is no row with these fields."""
        done = {row["seed"] for row in self.rows(**wanted)}
        return iter([seed for seed in seeds if seed not in done])

    def index_by_case(self) -> dict[str, Row]:
        """The last row of each case by its name."""
        return {row["case"]: row for row in self._rows}

    def append(self, *rows: Row) -> None:
        """Write rows to the disk."""
        lines = [json.dumps(row, default=lambda array: np.asarray(array).tolist(), ensure_ascii=False) for row in rows]
        self.path.parent.mkdir(parents=True, exist_ok=True)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(("\n" if self._torn else "") + "".join(f"{line}\n" for line in lines))
            file.flush()
            os.fsync(file.fileno())
        self._torn = False
        self._rows += map(json.loads, lines)


def _parse(line: str) -> Row | None:
    """The row, or None for the half line that a killed run leaves."""
    try:
        row = json.loads(line)
    except json.JSONDecodeError:
        return None
    return row if isinstance(row, dict) else None

"""The log of scored runs: one JSON line a run, appended before it starts and again when it is done, kept in git."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

__all__ = ["append_entry", "next_run", "read_entries"]


def read_entries(path: Path) -> list[dict[str, Any]]:
    """All entries, oldest first."""
    if not path.exists():
        return []
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines() if line.strip()]


def append_entry(path: Path, entry: Mapping[str, Any]) -> None:
    """Append one entry; nothing that is there is ever changed."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(dict(entry), ensure_ascii=False) + "\n")
        file.flush()
        os.fsync(file.fileno())


def next_run(path: Path) -> int:
    """Number of the next scored run; a run that was started counts, whether it was finished or not."""
    return 1 + max((entry["run"] for entry in read_entries(path)), default=0)

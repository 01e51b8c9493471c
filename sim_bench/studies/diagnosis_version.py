"""Which diagnosis is at work, without git: a hash of its source files.

It imports nothing of the diagnosis, so that what must not know it can say which one it asked.
"""

from __future__ import annotations

import hashlib
from functools import cache
from pathlib import Path

__all__ = ["diagnosis_version", "imported_diagnosis"]


def imported_diagnosis() -> Path:
    """The folder of the diagnosis that `import` finds."""
    return Path(__file__).resolve().parents[2] / "fricomp" / "diagnosis"


@cache
def diagnosis_version(folder: Path | None = None) -> str:
    """Hash over names and contents of the modules in `folder`, by default of the imported diagnosis; 12 digits."""
    digest, place = hashlib.sha256(), folder or imported_diagnosis()
    for path in sorted(place.rglob("*.py")):
        digest.update(f"{path.relative_to(place).as_posix()}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:12]

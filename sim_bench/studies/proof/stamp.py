"""Of which diagnosis and which day a table is that stays in the page while the diagnosis goes on."""

from __future__ import annotations

from datetime import date
from pathlib import Path

from fricomp.errors import DiagnosisError

from ..diagnosis_version import diagnosis_version
from .seeds import diagnosis_tree

__all__ = ["format_stamp"]


def format_stamp(day: date, repository: Path, tree: str = "") -> str:
    """One sentence for such a table.

    Args:
        day: Of the measurement.
        repository: Whose diagnosis was measured.
        tree: Git's hash of the diagnosis where it is known already; else that of the repository, or where it is not
            committed, a hash of its source.
    """
    if not tree:
        try:
            tree = diagnosis_tree(repository)
        except DiagnosisError:
            return f"Measured on {day.isoformat()}, diagnosis with source hash {diagnosis_version()}, not committed."
    return f"Measured on {day.isoformat()}, diagnosis with tree {tree[:12]}."

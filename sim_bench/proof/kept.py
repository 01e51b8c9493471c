"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from __future__ import annotations

import shutil
from pathlib import Path

from .run import REFUSED, write_score
from .score import Score

__all__ = ["keep_data", "restore_data"]

_SETTINGS, _SCORES = "run.json", "scores.parquet"
_COPIED = (_SETTINGS, "seals.jsonl", REFUSED, "baselines.md")


def keep_data(out: Path, folder: Path) -> None:
    """Keep settings, seals, refused cases, scored answers and baselines of the run in `out` in `folder`."""
    from pyarrow import concat_tables, parquet

    folder.mkdir(parents=True, exist_ok=True)
    tables = [parquet.read_table(path) for path in sorted((out / "scores").glob("*.parquet"))]
    parquet.write_table(concat_tables(tables), folder / _SCORES)
    _copy(out, folder)


def restore_data(folder: Path, out: Path) -> None:
    """Make `out` the run that `keep_data` kept in `folder`; nothing happens where it holds a run or none was kept.

    Only what follows scores is there: answers and diagnoses of the cases that are done are not.
    """
    from pyarrow import parquet

    if (out / _SETTINGS).exists() or not (folder / _SETTINGS).exists():
        return
    (out / "scores").mkdir(parents=True, exist_ok=True)
    for row in parquet.read_table(folder / _SCORES).to_pylist():
        write_score(Score(**row), out / "scores" / f"{row['case']}.parquet")
    _copy(folder, out)


def _copy(source: Path, target: Path) -> None:
    for name in _COPIED:
        if (source / name).exists():
            shutil.copyfile(source / name, target / name)

"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from __future__ import annotations

import shutil
from pathlib import Path

from fricomp.recording.whole_file import whole_file

from .run import REFUSED, SEALS
from .settings import SETTINGS

__all__ = ["BASELINES", "keep_data", "restore_data"]

BASELINES = "baselines.md"
"""File of a run that holds the table of the other methods."""

_SCORES = "scores.parquet"
_COPIED = (SEALS, REFUSED, BASELINES, SETTINGS)  # settings last: a folder without them is no run yet


def keep_data(out: Path, folder: Path) -> None:
    """Keep settings, seals, refused cases, scored answers and baselines of the run in `out` in `folder`."""
    from pyarrow import concat_tables, parquet

    folder.mkdir(parents=True, exist_ok=True)
    tables = [parquet.read_table(path) for path in sorted((out / "scores").glob("*.parquet"))]
    with whole_file(folder / _SCORES) as part:
        parquet.write_table(concat_tables(tables), part)
    _copy(out, folder)


def restore_data(folder: Path, out: Path) -> None:
    """Make `out` the run that `keep_data` kept in `folder`; nothing happens where it holds a run or none was kept.

    Only what follows scores is there: answers and diagnoses of the cases that are done are not.
    """
    from pyarrow import parquet

    if (out / SETTINGS).exists() or not (folder / SETTINGS).exists():
        return
    (out / "scores").mkdir(parents=True, exist_ok=True)
    table = parquet.read_table(folder / _SCORES)
    for index, case in enumerate(table["case"].to_pylist()):
        parquet.write_table(table.slice(index, 1), out / "scores" / f"{case}.parquet")
    _copy(folder, out)


def _copy(source: Path, target: Path) -> None:
    if source.resolve() == target.resolve():  # a page beside its run
        return
    for name in _COPIED:
        if (source / name).exists():
            shutil.copyfile(source / name, target / name)

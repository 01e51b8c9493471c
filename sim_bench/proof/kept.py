"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from __future__ import annotations

import shutil
from pathlib import Path

from fricomp.errors import DiagnosisError
from fricomp.recording.whole_file import whole_file

from .run import REFUSED, SEALS
from .settings import SETTINGS, read_settings

__all__ = ["BASELINES", "KEPT", "find_kept", "keep_data", "restore_data"]

BASELINES = "baselines.md"
"""File of a run that holds the table of the other methods."""

_SCORES = "scores.parquet"
KEPT = (SEALS, REFUSED, _SCORES, SETTINGS)
"""Files that are a run's own; settings last, as a folder without them holds no run."""

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


def find_kept(folder: Path, run: int) -> Path:
    """Where the settings and seals of a scored run are kept: in `folder` while it is the last one, then in run-N.

    Raises:
        DiagnosisError: They are not kept.
    """
    for place in (folder, folder / f"run-{run}"):
        settings = place / SETTINGS
        if settings.exists() and read_settings(settings).run == run:
            return place
    raise DiagnosisError(f"no {SETTINGS} of scored run {run} is kept in {folder} or {folder / f'run-{run}'}")


def _copy(source: Path, target: Path) -> None:
    if source.resolve() == target.resolve():  # a page beside its run
        return
    for name in _COPIED:
        if (source / name).exists():
            shutil.copyfile(source / name, target / name)

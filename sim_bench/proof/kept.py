"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path

from fricomp.errors import DiagnosisError
from fricomp.whole_file import whole_file

from .run import ANSWERS, DIAGNOSES, REFUSED, SEALS, read_opened, read_scores
from .score import brief_diagnosis
from .settings import SETTINGS, read_settings

__all__ = ["BASELINES", "KEPT", "find_kept", "keep_data", "restore_data"]

BASELINES = "baselines.md"
"""File of a run that holds the table of the other methods."""

_SCORES, _OPENED = "scores.parquet", "answers.parquet"
KEPT = (SEALS, REFUSED, _SCORES, _OPENED, SETTINGS)
"""Files that are a run's own; settings last, as a folder without them holds no run."""

_COPIED = (SEALS, REFUSED, BASELINES, SETTINGS)  # settings last: a folder without them is no run yet


def keep_data(out: Path, folder: Path) -> None:
    """Keep settings, seals, refused cases, scores, opened answers and baselines of the run in `out` in `folder`.

    An answer stands beside what the diagnosis said of its case, so that anybody can hold it against its seal and score
    it by other rules.
    """
    from pyarrow import Table, binary, parquet, schema, string

    folder.mkdir(parents=True, exist_ok=True)
    scores = read_scores(out)
    with whole_file(folder / _SCORES) as part:
        parquet.write_table(Table.from_pylist([asdict(score) for score in scores]), part)
    found = ((score.case, read_opened(out, score.case)) for score in scores)
    rows = [{"case": case, "answer": one[0], "diagnosis": brief_diagnosis(one[1])} for case, one in found if one]
    table = Table.from_pylist(rows, schema=schema([("case", string()), ("answer", binary()), ("diagnosis", binary())]))
    with whole_file(folder / _OPENED) as part:
        parquet.write_table(table, part, compression="zstd", compression_level=19)
    _copy(out, folder)


def restore_data(folder: Path, out: Path) -> None:
    """Make `out` the run that `keep_data` kept in `folder`; nothing happens where it holds a run or none was kept."""
    from pyarrow import parquet

    if (out / SETTINGS).exists() or not (folder / SETTINGS).exists():
        return
    for name in ("scores", ANSWERS, DIAGNOSES):
        (out / name).mkdir(parents=True, exist_ok=True)
    table = parquet.read_table(folder / _SCORES)
    for index, case in enumerate(table["case"].to_pylist()):
        parquet.write_table(table.slice(index, 1), out / "scores" / f"{case}.parquet")
    opened = parquet.read_table(folder / _OPENED).to_pylist() if (folder / _OPENED).exists() else []
    for row in opened:
        (out / ANSWERS / f"{row['case']}.json").write_bytes(row["answer"])
        (out / DIAGNOSES / f"{row['case']}.json").write_bytes(row["diagnosis"])
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

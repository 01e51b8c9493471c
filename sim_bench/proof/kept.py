"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

from fricomp.errors import DiagnosisError
from fricomp.whole_file import whole_file

from .run import ANSWERS, DIAGNOSES, REFUSED, SEALS, read_scores
from .score import brief_diagnosis
from .settings import SETTINGS, read_settings

if TYPE_CHECKING:
    import pyarrow

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
    from pyarrow import Table, parquet

    folder.mkdir(parents=True, exist_ok=True)
    scores = read_scores(out)
    with whole_file(folder / _SCORES) as part:
        parquet.write_table(Table.from_pylist([asdict(score) for score in scores]), part)
    opened = [row for score in scores if (row := _opened(out, score.case))]
    with whole_file(folder / _OPENED) as part:
        parquet.write_table(
            Table.from_pylist(opened, schema=_opened_schema()), part, compression="zstd", compression_level=19
        )
    _copy(out, folder)


def _opened(out: Path, case: str) -> dict[str, str | bytes]:
    """A row of the opened answers; empty where the run has no answer of the case, or no diagnosis."""
    answer, diagnosis = (out / name / f"{case}.json" for name in (ANSWERS, DIAGNOSES))
    if not (answer.exists() and diagnosis.exists()):
        return {}
    return {"case": case, "answer": answer.read_bytes(), "diagnosis": brief_diagnosis(diagnosis.read_bytes())}


def _opened_schema() -> pyarrow.Schema:
    import pyarrow

    return pyarrow.schema({"case": pyarrow.string(), "answer": pyarrow.binary(), "diagnosis": pyarrow.binary()})


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

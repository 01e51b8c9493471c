"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from __future__ import annotations

import shutil
from dataclasses import asdict
from pathlib import Path

from fricomp.errors import DiagnosisError
from fricomp.whole_file import whole_file

from .run import ANSWERS, DIAGNOSES, FOLLOW_UPS, REFUSED, SEALS, read_opened, read_scores
from .score import brief_diagnosis
from .settings import SETTINGS, read_settings

__all__ = ["BASELINES", "KEPT", "find_kept", "keep_data", "read_kept_answers", "restore_data"]

BASELINES = "baselines.md"
"""File of a run that holds the table of the other methods."""

_SCORES, _OPENED = "scores.parquet", "answers.parquet"
_FOLDERS = {"answer": ANSWERS, "diagnosis": DIAGNOSES, "follow_up": FOLLOW_UPS}
"""Folder of each column of the opened answers."""
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
    with whole_file(folder / _SCORES, DiagnosisError) as part:
        parquet.write_table(Table.from_pylist([asdict(score) for score in scores]), part)
    columns = schema([("case", string()), *((name, binary()) for name in _FOLDERS)])
    table = Table.from_pylist([_row(out, score.case) for score in scores], schema=columns)
    with whole_file(folder / _OPENED, DiagnosisError) as part:
        parquet.write_table(table, part, compression="zstd", compression_level=19)
    _copy(out, folder)


def _row(out: Path, case: str) -> dict[str, str | bytes]:
    """A case of the table of opened answers; its follow-up is empty where there is none."""
    opened = read_opened(out, case)
    assert opened  # else it would have no score
    answer, diagnosis, follow_up = opened
    return {
        "case": case,
        "answer": answer,
        "diagnosis": brief_diagnosis(diagnosis),
        "follow_up": brief_diagnosis(follow_up),
    }


def restore_data(folder: Path, out: Path) -> None:
    """Make `out` the run that `keep_data` kept in `folder`; nothing happens where it holds a run or none was kept."""
    from pyarrow import parquet

    if (out / SETTINGS).exists() or not (folder / SETTINGS).exists():
        return
    for name in ("scores", *_FOLDERS.values()):
        (out / name).mkdir(parents=True, exist_ok=True)
    table = parquet.read_table(folder / _SCORES)
    for index, case in enumerate(table["case"].to_pylist()):
        parquet.write_table(table.slice(index, 1), out / "scores" / f"{case}.parquet")
    opened = parquet.read_table(folder / _OPENED).to_pylist() if (folder / _OPENED).exists() else []
    for row in opened:
        for column in row.keys() & _FOLDERS.keys():
            (out / _FOLDERS[column] / f"{row['case']}.json").write_bytes(row[column])
    _copy(folder, out)


def read_kept_answers(folder: Path) -> dict[str, bytes]:
    """Opened answers by case, as they were sealed; none where a run of an earlier version kept none."""
    from pyarrow import parquet

    if not (folder / _OPENED).exists():
        return {}
    table = parquet.read_table(folder / _OPENED, columns=["case", "answer"])
    return dict(zip(table["case"].to_pylist(), table["answer"].to_pylist(), strict=True))


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

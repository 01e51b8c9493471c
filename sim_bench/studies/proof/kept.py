"""What is kept of a run as data beside its page, and a run that goes on from it in another checkout."""

from dataclasses import asdict
from pathlib import Path

from fricomp.errors import DiagnosisError
from fricomp.whole_file import whole_file, write_whole

from ..kit.store import RowStore
from .run import ANSWERS, REFUSED, SCORES, SEALS, read_scores
from .settings import SETTINGS

BASELINES = "baselines.md"
"""File of a run that holds the table of the other methods."""

_SCORES, _ANSWERS = "scores.parquet", "answers.parquet"

_COPIED = (SEALS, REFUSED, BASELINES, SETTINGS)
"""Settings come last, as a folder without them is no run yet."""

_LARGEST = 4096
"""Size up to which an opened answer is kept [byte]: one of many pushes or spans in time has ten times as much."""


def keep_data(out: Path, folder: Path) -> None:
    """Keep settings, seals, refused cases, scores, small opened answers and baselines of the run in `out` in `folder`.

    An answer is kept as it was sealed, so that anybody can hold it against its seal.
    """
    from pyarrow import Table, parquet

    folder.mkdir(parents=True, exist_ok=True)
    scores = read_scores(out)
    answers = [(score.case, out / ANSWERS / f"{score.case}.json") for score in scores]
    small = [(case, path.read_bytes()) for case, path in answers if path.exists() and path.stat().st_size <= _LARGEST]
    tables = {
        _SCORES: Table.from_pylist([asdict(score) for score in scores]),
        _ANSWERS: Table.from_pydict({"case": [case for case, _ in small], "answer": [answer for _, answer in small]}),
    }
    for name, table in tables.items():
        with whole_file(folder / name, DiagnosisError) as part:
            parquet.write_table(table, part, compression="zstd", compression_level=19)
    _copy(out, folder)


def restore_data(folder: Path, out: Path) -> None:
    """Make `out` the run that `keep_data` kept in `folder`; nothing happens where it holds a run or none was kept."""
    from pyarrow import parquet

    if (out / SETTINGS).exists() or not (folder / SETTINGS).exists():
        return
    RowStore(out / SCORES).append(*parquet.read_table(folder / _SCORES).to_pylist())
    (out / ANSWERS).mkdir(parents=True, exist_ok=True)
    for row in parquet.read_table(folder / _ANSWERS).to_pylist():
        write_whole(out / ANSWERS / f"{row['case']}.json", row["answer"])
    _copy(folder, out)


def _copy(source: Path, target: Path) -> None:
    if source.resolve() == target.resolve():  # a page beside its run
        return
    for name in _COPIED:
        if (source / name).exists():
            write_whole(target / name, (source / name).read_bytes())

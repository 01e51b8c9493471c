"""Whether a file is a recording of this package, or called as one."""

from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

from fricomp.recording.parquet_file import KEY
from fricomp.recording.recording import CHANNELS
from fricomp.recording.sources.cell import read_number

from .source import read_first_lines

_NO_SECONDS = 1e11
"""Stamp that is no second of this or the next millennium [s]."""
_LONGEST_STEP = 2.0
"""Step of stamps from which on they are no seconds [s]: no joint is logged so slowly."""


def is_native(path: Path) -> bool:
    """Whether a file is a recording of one joint: its columns are called as channels are, and hold one number a row."""
    if path.suffix.lower() in (".parquet", ".pq"):
        return _is_native_parquet(path)
    if path.suffix.lower() not in (".csv", ".txt") or not path.is_file():
        return path.suffix.lower() in (".csv", ".txt")
    lines = read_first_lines(path, 3)
    if lines.states_schema or not lines.rows:
        return True
    listed = [cell.strip() for cell in lines.rows[0].split(",")]
    cells = set(listed)
    if (
        not cells <= set(CHANNELS)
        or len(cells) < len(listed)
        or ("time" in cells and "position" not in cells and "velocity" in cells)
    ):
        return False
    if any("[" in row or not any(map(str.isdigit, row)) for row in lines.rows[1:]):  # lists, or a line of units
        return False
    stamps = [row.split(",")[listed.index("time")] for row in lines.rows[1:]] if "time" in cells else []
    return not _are_foreign_stamps([read_number(stamp) for stamp in stamps])


def _are_foreign_stamps(stamps: Sequence[float]) -> bool:
    """Whether the first stamps cannot be seconds of a recording: parts of them since 1970, or steps of 2 and more.

    Steps of 1 may be the numbers of the rows.
    """
    return len(stamps) == 2 and (stamps[0] >= _NO_SECONDS or stamps[1] - stamps[0] >= _LONGEST_STEP)


def _is_native_parquet(path: Path) -> bool:
    from pyarrow import ArrowException, parquet, types

    try:
        schema = parquet.read_schema(path)
        names = set(schema.names)
    except (OSError, ArrowException, UnicodeDecodeError):
        return True  # whose reader says what is wrong with it
    if not names <= set(CHANNELS) or not all(types.is_floating(one) or types.is_integer(one) for one in schema.types):
        return False
    if "time" not in names or KEY in (schema.metadata or {}):
        return True
    with suppress(OSError, ArrowException, StopIteration):
        first = next(parquet.ParquetFile(path).iter_batches(batch_size=2, columns=["time"]))
        return not _are_foreign_stamps([float(one) for one in first.column(0).to_pylist() if one is not None])
    return True

"""Rows of numbers of a large CSV file, read by pyarrow: as fast as the disk, with memory for the numbers alone.

It takes plain files only. Whatever it stumbles on is left to the careful reader, which says what is wrong.
"""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fricomp.reading import tell_reading

_LARGE = 1_000_000
"""Size from which a file is read this way [byte]: pyarrow takes a tenth of a second to be imported."""
_HEAD = 65_536
"""Most bytes before the rows: metadata, comments and header."""
_BYTE_ORDER_MARK = b"\xef\xbb\xbf"


def read_head(path: Path) -> tuple[str, int] | None:
    """Read the first lines of a large file and how many bytes stand before them; None where it is read carefully.

    Its last line has ended: where a writer was stopped in a line, somebody has to look at it.
    """
    try:
        if path.stat().st_size < _LARGE:
            return None
        with path.open("rb") as file:
            head = file.read(_HEAD)
            file.seek(-1, 2)
            ended = file.read(1) == b"\n"
        mark = len(_BYTE_ORDER_MARK) if head.startswith(_BYTE_ORDER_MARK) else 0
        return (head[mark : head.rfind(b"\n") + 1].decode(), mark) if ended else None
    except (OSError, UnicodeDecodeError):
        return None


def read_number_rows(
    path: Path, start: int, names: Sequence[str], wanted: Sequence[str] | None = None, *, delimiter: str = ","
) -> dict[str, NDArray[np.float64]] | None:
    """Read the columns of a file whose rows are numbers, finite or not; None where they are not, or pyarrow is missing.

    Args:
        path: The file.
        start: Bytes before the first row.
        names: Of its columns.
        wanted: Those that are read; None for all.
        delimiter: One character between two cells.
    """
    try:
        import pyarrow
        from pyarrow import csv
    except ImportError:
        return None
    kept = list(names if wanted is None else wanted)
    options = csv.ConvertOptions(
        column_types=dict.fromkeys(kept, pyarrow.float64()), include_columns=kept, null_values=[]
    )
    parsing = csv.ParseOptions(delimiter=delimiter, quote_char=False, invalid_row_handler=_skip_comment)
    try:
        with tell_reading(path.name) as tell, _WatchedFile(path, tell) as file:
            file.seek(start)
            table = csv.read_csv(
                pyarrow.PythonFile(file, "r"),
                read_options=csv.ReadOptions(column_names=list(names)),
                parse_options=parsing,
                convert_options=options,
            )
    except (pyarrow.ArrowException, OSError):
        return None
    if not table.num_rows:
        return None
    chunks = {name: table.column(name).chunks for name in kept}
    del table  # a column is freed as soon as its chunks are joined
    return {name: _join(chunks.pop(name)) for name in kept}


def _join(chunks: Sequence[Any]) -> NDArray[np.float64]:
    """Chunks of numbers, none missing, as one array; `to_numpy` would import pandas where that is installed.

    It is read-only, so that a recording takes it as it is.
    """
    parts = [np.frombuffer(one.buffers()[1])[one.offset : one.offset + len(one)] for one in chunks]
    joined = np.concatenate(parts)
    joined.flags.writeable = False
    return joined


class _WatchedFile(io.FileIO):
    """A file that tells which share of it has been read."""

    def __init__(self, path: Path, tell: Callable[[float], None]) -> None:
        super().__init__(path)
        self._size, self._tell_share = path.stat().st_size, tell

    def read(self, size: int | None = -1) -> bytes:
        block = super().read(-1 if size is None else size)
        self._tell_share(self.tell() / self._size)
        return block


def _skip_comment(row: Any) -> str:
    return "skip" if row.text.startswith("#") else "error"

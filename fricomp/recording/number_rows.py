"""Rows of numbers of a large CSV file, read by pyarrow: as fast as the disk, with memory for the numbers alone.

It takes plain files only. Whatever it stumbles on is left to the careful reader, which says what is wrong.
"""

import io
import re
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
_DATE = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d:\d\d(?:\.\d{1,9})?(Z|[+-]\d\d:?\d\d)?")
"""A date and time by ISO 8601, and its distance from UTC where it states one."""
_NANOSECONDS = 1_000_000_000


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
    path: Path,
    start: int,
    names: Sequence[str],
    wanted: Sequence[str] | None = None,
    *,
    delimiter: str = ",",
    decimal: str = ".",
) -> dict[str, NDArray[np.float64]] | None:
    """Read the columns of a file whose rows are numbers, finite or not; None where they are not, or pyarrow is missing.

    Dates by ISO 8601 are seconds since 1970.

    Args:
        path: The file.
        start: Bytes before the first row.
        names: Of its columns.
        wanted: Those that are read; None for all.
        delimiter: One character between two cells.
        decimal: Decimal mark; where it is a comma, a table without commas may have points.
    """
    try:
        import pyarrow
        from pyarrow import csv
    except ImportError:
        return None
    kept = list(names if wanted is None else wanted)
    first, has_commas = _look_at_rows(path, start)
    cells = dict(zip(names, first.split(delimiter), strict=False))
    options = csv.ConvertOptions(
        column_types={name: _find_type(cells.get(name, "")) for name in kept},
        include_columns=kept,
        null_values=[],
        decimal_point=decimal if has_commas else ".",
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
                memory_pool=pyarrow.system_memory_pool(),
            )
    except (pyarrow.ArrowException, OSError):
        return None
    if not table.num_rows:
        return None
    chunks = {name: table.column(name).chunks for name in kept}
    del table  # a column is freed as soon as its chunks are joined
    return {name: _join(chunks.pop(name)) for name in kept}


def _look_at_rows(path: Path, start: int) -> tuple[str, bool]:
    """The first row from there on that is no comment, and whether there are commas in the first ones."""
    with path.open("rb") as file:
        file.seek(start)
        lines = file.read(_HEAD).decode(errors="replace").splitlines()
    rows = [line for line in lines if line.strip() and not line.startswith("#")]
    return (rows[0] if rows else "", any("," in row for row in rows))


def _find_type(cell: str) -> Any:
    """The type of a column of pyarrow that has such cells."""
    import pyarrow

    date = _DATE.fullmatch(cell.strip())
    return pyarrow.timestamp("ns", "UTC" if date.group(1) else None) if date else pyarrow.float64()


def _join(chunks: Sequence[Any]) -> NDArray[np.float64]:
    """Chunks of numbers or dates, none missing, as one array; `to_numpy` would import pandas where that is installed.

    It is read-only, so that a recording takes it as it is.
    """
    is_date = chunks[0].type.id != _find_type("").id
    kind = np.int64 if is_date else np.float64
    parts = [np.frombuffer(one.buffers()[1], kind)[one.offset : one.offset + len(one)] for one in chunks]
    joined: NDArray[Any] = np.concatenate(parts)
    if is_date:
        joined = joined // _NANOSECONDS + joined % _NANOSECONDS / _NANOSECONDS
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

"""A table of friction points: velocity, torque and, where known, the normal load."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording.number_rows import read_head, read_number_rows

__all__ = ["FrictionTable", "is_friction_table", "read_friction_table"]

_REQUIRED = ("velocity", "torque")


class FrictionTable(NamedTuple):
    """Friction points.

    Attributes:
        velocity: [rad/s] or [m/s]. Shape (n,).
        torque: [N·m] or [N]. Shape (n,).
        normal_load: Shape (n,), or None.
    """

    velocity: FloatArray
    torque: FloatArray
    normal_load: FloatArray | None


def is_friction_table(path: str | os.PathLike[str]) -> bool:
    """Whether the file is a CSV whose header names velocity and torque, and no time.

    Raises:
        RecordingError: The file cannot be read, or its header is neither that of a table nor of a recording.
    """
    if Path(path).suffix.lower() not in (".csv", ".txt"):
        return False
    columns = _read_header(Path(path)) or _rows(path)[0]
    if "time" in columns:
        return False
    if not set(_REQUIRED) <= set(columns):
        raise RecordingError(_explain_header(path, columns))
    return True


def read_friction_table(path: str | os.PathLike[str]) -> FrictionTable:
    """Read a table; lines that begin with # are comments.

    Raises:
        RecordingError: A column is missing or there twice, a row is too short, or a cell is not a finite number.
    """
    fast = _read_fast(Path(path))
    if fast is not None:
        return fast
    header, *rows = _rows(path)
    missing = [name for name in _REQUIRED if name not in header]
    if missing:
        raise RecordingError(f"{path} needs the columns velocity and torque; it has {', '.join(header)}")
    twice = [name for name in (*_REQUIRED, "normal_load") if header.count(name) > 1]
    if twice:
        raise RecordingError(f"{path} has the column {twice[0]} twice: remove or rename one")
    if not rows:
        raise RecordingError(f"{path} has a header and no rows")
    values = {name: _column(path, rows, header, name) for name in (*_REQUIRED, "normal_load") if name in header}
    return FrictionTable(values["velocity"], values["torque"], values.get("normal_load"))


def _read_header(path: Path) -> list[str]:
    """The columns of a large file; empty where it is small or has to be read with care."""
    text, _ = read_head(path) or ("", 0)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return [cell.strip() for cell in lines[0].split(",")] if lines and '"' not in lines[0] else []


def _read_fast(path: Path) -> FrictionTable | None:
    """A large table that holds nothing but finite numbers; None where it has to be read with care."""
    header, head = _read_header(path), read_head(path)
    wanted = [name for name in (*_REQUIRED, "normal_load") if name in header]
    if head is None or not set(_REQUIRED) <= set(header) or len(set(header)) < len(header):
        return None
    text, before = head
    skipped = 0
    for line in text.splitlines(keepends=True):
        skipped += len(line.encode())
        if line.strip() and not line.startswith("#"):
            break
    values = read_number_rows(path, before + skipped, header, wanted)
    if values is None or not all(np.all(np.isfinite(one)) for one in values.values()):
        return None
    return FrictionTable(values["velocity"], values["torque"], values.get("normal_load"))


def _explain_header(path: str | os.PathLike[str], columns: list[str]) -> str:
    """What a header lacks that is neither a table's nor a recording's."""
    advice = "rename or add columns, or bring a recording in with 'fricomp convert SOURCE --mapping FILE'"
    if len(columns) == 1 and any(sign in columns[0] for sign in ";\t"):
        advice = "separate the columns by commas"
    elif {"time", *_REQUIRED} & {name.lower() for name in columns}.difference(columns):
        advice = "write the names in lower case"
    return (
        f"{path} has the header {','.join(columns)[:80]!r}: a table of friction points has velocity,torque, a "
        f"recording time,position,torque; {advice}"
    )


def _rows(path: str | os.PathLike[str]) -> list[list[str]]:
    try:
        text = Path(path).read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        raise RecordingError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    if not lines:
        raise RecordingError(f"{path} is empty")
    return [[cell.strip() for cell in row] for row in csv.reader(lines)]


def _column(path: str | os.PathLike[str], rows: list[list[str]], header: list[str], name: str) -> FloatArray:
    at, values = header.index(name), np.empty(len(rows))
    for k, row in enumerate(rows):
        try:
            values[k] = float(row[at])
        except (ValueError, IndexError):
            values[k] = np.nan
        if not np.isfinite(values[k]):
            cell = row[at] if at < len(row) else "missing"
            raise RecordingError(
                f"{path}: row {k + 1}, column {name} is {cell!r}, not a finite number; repair or remove it"
            )
    return values

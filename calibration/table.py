"""A table of friction points: velocity, torque and, where known, the normal load."""

import os
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording.named.choice import choose_columns
from fricomp.recording.named.column import RAW_UNIT, ColumnMeaning, read_column_name
from fricomp.recording.named.head_fact import read_head_facts
from fricomp.recording.named.source import explain_unnamed, read_layout, read_named_columns
from fricomp.recording.named.times.clock import find_stamps
from fricomp.recording.number_rows import read_head, read_number_rows
from fricomp.recording.quantity_word import count_known
from fricomp.recording.sources.text import cut_rows, read_lines
from fricomp.recording.sources.text_line import split_cells
from fricomp.recording.unit import find_unit
from fricomp.recording.unit_word import UNKNOWN_UNIT

_REQUIRED = ("velocity", "torque")


class FrictionTable(NamedTuple):
    """Friction points.

    Attributes:
        velocity: [rad/s] or [m/s]. Shape (n,).
        torque: [N·m] or [N]. Shape (n,).
        normal_load: Shape (n,), or None.
        torque_unit: N·m, N or A, as the column's name says.
    """

    velocity: FloatArray
    torque: FloatArray
    normal_load: FloatArray | None
    torque_unit: str = "N·m"


def is_friction_table(path: str | os.PathLike[str]) -> bool:
    """Whether the file is a text whose columns are called as velocity and torque, and none as time or position.

    Raises:
        RecordingError: The file cannot be read, or its header is neither that of a table nor of a recording.
    """
    if Path(path).suffix.lower() not in (".csv", ".txt"):
        return False
    columns = _read_header(Path(path)) or _read_rows(path)[0]
    if "time" in columns:
        return False
    if set(_REQUIRED) <= set(columns) and "position" not in columns and not find_stamps(columns):
        return True
    layout = read_layout(Path(path))
    names = layout.names
    if not names:
        named = count_known(columns) > 0 and layout.rows_line > 0  # a header that does not fit its rows
        raise RecordingError(_explain_header(path, columns) if named else explain_unnamed(Path(path)))
    said = {meaning.channel for meaning in map(read_column_name, names) if meaning is not None}
    if find_stamps(names) or "position" in said or "motor_position" in said:
        return False
    if "velocity" in said and said & {"torque", "current"}:
        return True
    if "rate" in read_head_facts(Path(path)):
        return False
    raise RecordingError(_explain_header(path, list(names) or columns))


def read_friction_table(path: str | os.PathLike[str]) -> FrictionTable:
    """Read a table; lines that begin with # are comments.

    Raises:
        RecordingError: A column is missing or there twice, a row is too short, or a cell is not a finite number.
    """
    fast = _read_fast(Path(path))
    if fast is not None:
        return fast
    header, *rows = _read_rows(path)
    if not set(_REQUIRED) <= set(header):
        return _read_named(Path(path))
    twice = [name for name in (*_REQUIRED, "normal_load") if header.count(name) > 1]
    if twice:
        raise RecordingError(f"{path} has the column {twice[0]} twice: remove or rename one")
    if not rows:
        raise RecordingError(f"{path} has a header and no rows")
    values = {name: _read_column(path, rows, header, name) for name in (*_REQUIRED, "normal_load") if name in header}
    return FrictionTable(values["velocity"], values["torque"], values.get("normal_load"))


def _read_named(path: Path) -> FrictionTable:
    """A table whose columns are called otherwise: their names say what they hold, in which unit."""
    columns = read_named_columns(path)
    own: dict[str, tuple[str, ColumnMeaning]] = next(iter(choose_columns(path, columns, {}).values()), {})
    torque = own.get("torque", own.get("current"))
    if "velocity" not in own or torque is None:
        raise RecordingError(f"{path} needs the columns velocity and torque; it has {', '.join(columns)}")
    velocity, values = (_convert_to_si(path, columns, one) for one in (own["velocity"], torque))
    load = columns.get("normal_load")
    use = np.isfinite(velocity) & np.isfinite(values) & (True if load is None else np.isfinite(load))
    unit = find_unit(torque[1].unit).si if torque[1].unit else "A" if "torque" not in own else "N·m"
    return FrictionTable(velocity[use], values[use], None if load is None else load[use], unit)


def _convert_to_si(path: Path, columns: Mapping[str, FloatArray], one: tuple[str, ColumnMeaning]) -> FloatArray:
    name, meaning = one
    if meaning.unit in (RAW_UNIT, UNKNOWN_UNIT):
        raise RecordingError(f"{path}: {name!r} is in units of a device, or in one that is not known: write it in SI")
    return columns[name] * (find_unit(meaning.unit).factor if meaning.unit else 1.0)


def _read_header(path: Path) -> list[str]:
    """The columns of a large file; empty where it is small or has to be read with care."""
    text, _ = read_head(path) or ("", 0)
    lines = [line for line in text.splitlines() if line.strip() and not line.startswith("#")]
    return split_cells(lines[0], ",") if lines else []


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
    advice = (
        f"rename or add columns, look at them with 'fricomp convert {path} --inspect', or bring a recording in with "
        "'fricomp convert SOURCE --mapping FILE'"
    )
    if len(columns) == 1 and any(sign in columns[0] for sign in ";\t"):
        advice = "separate the columns of the rows by the same mark as the names"
    elif {"time", *_REQUIRED} & {name.lower() for name in columns}.difference(columns):
        advice = "write the names in lower case"
    elif any(meaning is not None for meaning in map(read_column_name, columns)):
        advice += (
            f"; where its rows come at an even rate, say it: 'fricomp convert {path} --row-rate 500 --out joint.csv'"
        )
    return (
        f"{path} has the header {','.join(columns)[:80]!r}: a table of friction points has velocity,torque, a "
        f"recording time,position,torque; {advice}"
    )


def _read_rows(path: str | os.PathLike[str]) -> list[list[str]]:
    try:
        rows = [cells for _, cells in cut_rows(Path(path), read_lines(Path(path)), ",", 1)]
    except OSError as error:
        raise RecordingError(f"cannot read {path}: {error.strerror or error}") from error
    if not rows:
        raise RecordingError(f"{path} is empty")
    return rows


def _read_column(path: str | os.PathLike[str], rows: list[list[str]], header: list[str], name: str) -> FloatArray:
    at, values = header.index(name), np.empty(len(rows))
    for k, row in enumerate(rows):
        try:
            values[k] = float(row[at])
        except (ValueError, IndexError):
            values[k] = np.nan
        if len(row) > len(header):
            raise RecordingError(
                f"{path}: row {k + 1} has {len(row)} cells where the header has {len(header)}: numbers with decimal "
                "commas need another mark between columns, such as ';'"
            )
        if not np.isfinite(values[k]):
            cell = row[at] if at < len(row) else "missing"
            raise RecordingError(
                f"{path}: row {k + 1}, column {name} is {cell!r}, not a finite number; repair or remove it"
            )
    return values

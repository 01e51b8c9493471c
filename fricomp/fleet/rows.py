"""The rows of a fleet on disk, one Parquet file a joint, and its settings beside them."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec

from fricomp.errors import RecordingError
from fricomp.untrusted import parse_json, read_whole
from fricomp.whole_file import whole_file, write_whole

from .joint import FleetJoint

FleetRow = dict[str, Any]

_SETTINGS = "fleet.json"


def read_rows(out: Path) -> list[FleetRow]:
    """The rows that are in the folder of a fleet so far; one that is damaged counts as missing."""
    rows = [_read_row(path) for path in sorted((out / "rows").glob("*.parquet"))]
    return [row for row in rows if row is not None]


def _read_row(path: Path) -> FleetRow | None:
    from pyarrow import ArrowException, parquet

    try:
        rows: list[FleetRow] = parquet.read_table(path).to_pylist()
    except (ArrowException, OSError):
        return None
    return rows[0] if len(rows) == 1 and {"name", "error"} <= set(rows[0]) else None


def begin_fleet(out: Path, settings: Mapping[str, Any], resume: bool) -> dict[str, FleetRow]:
    """Make the folder of a fleet, or find the rows that are in it, by name.

    Raises:
        RecordingError: The folder holds a run and is not to be resumed, or with other settings, or with damaged ones.
    """
    path, wanted = out / _SETTINGS, json.loads(json.dumps(settings))
    if path.exists():
        if not resume:
            raise RecordingError(f"{out} holds a fleet: give --resume to go on with it, or another --out")
        _require_settings(path, wanted)
    (out / "rows").mkdir(parents=True, exist_ok=True)
    if not path.exists():
        write_whole(path, json.dumps(wanted, indent=1) + "\n", RecordingError)
    return {row["name"]: row for row in read_rows(out)}


def _require_settings(path: Path, wanted: Mapping[str, Any]) -> None:
    try:
        found = parse_json(read_whole(path))
    except msgspec.DecodeError as error:
        raise RecordingError(f"the settings {path} of this fleet are damaged: give another --out") from error
    if found == wanted:
        return
    if not isinstance(found, dict):
        raise RecordingError(f"{path} holds no settings of a fleet: give another --out")
    other = [name for name in {**found, **wanted} if found.get(name) != wanted.get(name)]
    had, asked = ({name: each.get(name) for name in other} for each in (found, wanted))
    raise RecordingError(f"{path.parent} holds a fleet with {had}, not with {asked}: give another --out")


def has_row(joint: FleetJoint, out: Path) -> bool:
    """Whether a row of a joint is on disk, be it a damaged one."""
    return _row_file(joint.name, out).exists()


def _row_file(name: str, out: Path) -> Path:
    return out / "rows" / f"{name}.parquet"


def write_row(row: FleetRow, out: Path) -> None:
    """Put a joint's row on disk: where it is, the joint is finished."""
    write_rows([row], _row_file(row["name"], out))


def write_rows(rows: Sequence[FleetRow], path: Path) -> None:
    """Write rows as a Parquet file, whole or not at all; what a row does not have is empty there."""
    import pyarrow
    from pyarrow import parquet

    columns = list(dict.fromkeys(key for row in rows for key in row))
    with whole_file(path, RecordingError) as part:
        parquet.write_table(pyarrow.Table.from_pylist([{c: row.get(c) for c in columns} for row in rows]), part)


def collect_rows(joints: Sequence[FleetJoint], out: Path) -> list[FleetRow]:
    """All rows in the order of the joints, and in one file."""
    rows = {row["name"]: row for row in read_rows(out)}
    wanted = [rows[joint.name] for joint in joints]
    write_rows(wanted, out / "fleet.parquet")
    return wanted

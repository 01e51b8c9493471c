"""Which joints a fleet consists of: files, folders, patterns, or a table with one joint a row."""

import csv
import os
import tomllib
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from glob import glob
from itertools import count
from pathlib import Path
from typing import Any

from fricomp.errors import RecordingError
from fricomp.recording.named.quantity_files import is_log_folder
from fricomp.recording.sources.table import refuse_data_set
from fricomp.result_kinds import FLEET
from fricomp.untrusted import parse_toml, read_whole

_SUFFIXES = (".csv", ".parquet", ".pq")
_MAGIC = "*?["
_HEAD = 2**16  # of a table, in which its header ends [letters]
_LONGEST_NAME = 200  # [bytes]; file systems take 255, and numbers and suffixes are added to it


@dataclass(frozen=True)
class FleetJoint:
    """One joint of a fleet.

    Attributes:
        name: Also that of its folder.
        recordings: Its recordings, or its table of velocity and torque.
        simulation: MJCF or URDF of it.
        joint: Its name in the simulation.
        friction: Friction model of the simulation.
    """

    name: str
    recordings: tuple[Path, ...]
    simulation: Path | None = None
    joint: str | None = None
    friction: Path | None = None


_COLUMNS = ("name", "recording", *(each.name for each in fields(FleetJoint)[2:]))


def find_recordings(sources: Sequence[str]) -> list[Path]:
    """Files that are meant by files, folders and patterns, in the order given.

    Of a folder these are CSV and Parquet files. Tables of joints, and the rows of a fleet, are no recordings there.

    Raises:
        RecordingError: A source matches no recording.
    """
    found: list[Path] = []
    for source in sources:
        path = Path(source)
        if path.is_dir() and not is_log_folder(path):
            matches = sorted(p for p in path.iterdir() if p.suffix.lower() in _SUFFIXES and not _is_other_table(p))
        elif any(character in source for character in _MAGIC) and not path.exists():
            matches = sorted(p for p in map(Path, glob(source, recursive=True)) if not _is_other_table(p))
        else:
            matches = [path]
        if not matches:
            refuse_data_set(path)
            raise RecordingError(
                f"{source} holds no recording: give .csv or .parquet files; fricomp convert makes them"
            )
        found += matches
    return list(dict.fromkeys(found))


def _is_other_table(path: Path) -> bool:
    """Whether it is a table of joints, or one that a fleet has written."""
    folder = path.parent if path.name == "fleet.parquet" else path.parent.parent if path.parent.name == "rows" else None
    return is_joint_table(str(path)) or (folder is not None and (folder / "fleet.json").exists())


def is_joint_table(source: str) -> bool:
    """Whether it is a TOML file, or a CSV file with a column called recording."""
    path = Path(source)
    if path.suffix.lower() == ".toml":
        return True
    if path.suffix.lower() != ".csv" or not path.is_file():
        return False
    try:
        with path.open(encoding="utf-8-sig", errors="replace") as stream:
            lines = stream.read(_HEAD).splitlines()  # what is no text may be one endless line
    except OSError:
        return False
    header = next((line for line in lines if line.strip() and not line.startswith("#")), "")
    return "recording" in _cells(header[:9999])


def _cells(header: str) -> list[str]:
    return [cell.strip() for cell in next(csv.reader([header], skipinitialspace=True), [])]


def list_joints(sources: Sequence[str], defaults: FleetJoint) -> list[FleetJoint]:
    """One joint for each row of a table, and for each recording elsewhere.

    Args:
        sources: Tables of joints, recordings, folders, patterns.
        defaults: Simulation, joint and friction of those that say nothing else.

    Raises:
        RecordingError: A source matches nothing, a table cannot be read, or a name cannot be that of a folder.
    """
    joints: list[FleetJoint] = []
    for source in sources:
        if is_joint_table(source):
            joints += read_joint_table(Path(source), defaults)
        else:
            joints += [replace(defaults, name="", recordings=(path,)) for path in find_recordings([source])]
    return _with_names(joints)


def read_joint_table(path: Path, defaults: FleetJoint) -> list[FleetJoint]:
    """The joints of a table; its paths count from its own folder.

    CSV has the column recording and may have name, simulation, joint and friction; several recordings of one joint
    stand between semicolons. TOML has the same as tables `[[joint]]`, several recordings as a list. A recording that
    is not there stays in its row, whose joint cannot be read then.

    Raises:
        RecordingError: The file cannot be read, a column is unknown or there twice, or a row names no recording.
    """
    try:
        rows = _read_toml(path) if path.suffix.lower() == ".toml" else _read_csv(path)
    except (OSError, UnicodeDecodeError, csv.Error, tomllib.TOMLDecodeError) as error:
        raise RecordingError(f"cannot read the table of joints {path}: {error}") from error
    unknown = sorted({key for row in rows for key in row} - set(_COLUMNS))
    if unknown or not rows:
        what = f"has the column {unknown[0]!r}" if unknown else "has no joint"
        raise RecordingError(f"{path} {what}: a table of joints has {', '.join(_COLUMNS)}, one joint a row")
    return [_joint(row, number, path, defaults) for number, row in enumerate(rows, start=1)]


def _read_csv(path: Path) -> list[dict[str, Any]]:
    lines = [line for line in read_whole(path).decode("utf-8-sig").splitlines() if line.strip() and line[0] != "#"]
    twice = [name for name, often in Counter(_cells(lines[0]) if lines else ()).items() if name and often > 1]
    if twice:
        raise RecordingError(f"{path} has the column {twice[0]!r} twice: several recordings stand between semicolons")
    rows = csv.DictReader(lines, skipinitialspace=True, restkey="", restval="")
    return [{(key or "").strip(): value for key, value in row.items() if value} for row in rows]


def _read_toml(path: Path) -> list[dict[str, Any]]:
    content = parse_toml(read_whole(path).decode("utf-8-sig"))
    rows = content.get("joint")
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise RecordingError(f"{path} is no table of joints: it needs tables [[joint]] with a recording each")
    return rows


def _joint(row: Mapping[str, Any], number: int, table: Path, defaults: FleetJoint) -> FleetJoint:
    given = row.get("recording") or ""
    sources = given.split(";") if isinstance(given, str) else given
    if not isinstance(sources, list) or not all(isinstance(source, str) for source in sources):
        raise RecordingError(f"{table}, joint {number}: recording is {given!r}: give a path, or a list of paths")
    sources = [str(table.parent / source.strip()) for source in sources if source.strip()]
    if not sources:
        raise RecordingError(f"{table}, joint {number}, names no recording")
    paths = {key: table.parent / str(row[key]).strip() for key in ("simulation", "friction") if row.get(key)}
    return replace(
        defaults,
        name=str(row.get("name") or "").strip(),
        recordings=tuple(dict.fromkeys(path for source in sources for path in _find_or_miss(source))),
        simulation=paths.get("simulation", defaults.simulation),
        friction=paths.get("friction", defaults.friction),
        joint=str(row.get("joint") or "").strip() or defaults.joint,
    )


def _find_or_miss(source: str) -> list[Path]:
    """Its recordings, or where nothing is there the source itself, which nobody can read."""
    try:
        return find_recordings([source])
    except RecordingError:
        return [Path(source)]


def _with_names(joints: Sequence[FleetJoint]) -> list[FleetJoint]:
    """A name of its own for each: as given, that of its first recording, with its folder where that repeats.

    Names are made fit for a folder first, because two that differ may be the same as a folder.

    Raises:
        RecordingError: A name cannot be made fit.
    """
    first = [_folder_name(joint.name or joint.recordings[0].stem) for joint in joints]
    often = Counter(first)
    wide = [
        name if often[name] == 1 else _folder_name(f"{joint.recordings[0].parent.name}-{name}")
        for name, joint in zip(first, joints, strict=True)
    ]
    taken: set[str] = set()
    named = []
    for name, joint in zip(wide, joints, strict=True):
        numbered = (name if number == 1 else f"{name}-{number}" for number in count(1))
        unique = next(one for one in numbered if one not in taken)
        taken.add(unique)
        named.append(replace(joint, name=unique))
    return named


def _folder_name(name: str) -> str:
    fit = name.replace("/", "-").strip(".") or "joint"
    if fit in FLEET.files or not fit.isprintable() or len(os.fsencode(fit)) > _LONGEST_NAME:
        raise RecordingError(
            f"no folder can be called after the joint {fit[:60]!r}: give it a name in a table of joints, of printable "
            f"characters, at most {_LONGEST_NAME} bytes, and none of {', '.join(FLEET.files)}"
        )
    return fit

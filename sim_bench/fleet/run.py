"""Running one call for each joint of a fleet, on any executor; what is finished is on disk at once.

A worker gets the files of its joint as bytes and works in a folder of its own, so that it needs neither this machine's
files nor its folders. What it writes comes back as bytes and lands in the joint's folder, and its row as a Parquet
file in `rows/`, last of all: where a row is, the joint is finished.
"""

from __future__ import annotations

import hashlib
import json
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from fricomp.errors import FricompError, RecordingError
from fricomp.whole_file import whole_file

from .executor import stream
from .joint import FleetJoint

__all__ = [
    "FleetRow",
    "Parcel",
    "Work",
    "at_home",
    "begin_fleet",
    "collect_rows",
    "failed_row",
    "pack",
    "read_rows",
    "run_fleet",
    "write_row",
    "write_rows",
]

FleetRow = dict[str, Any]
Work = Callable[[FleetJoint, Path], FleetRow]
"""Does one joint: gets it and the folder to write into, and gives its row. A module's function, so that it travels."""

_SETTINGS = "fleet.json"


@dataclass(frozen=True)
class Parcel:
    """A joint with its files: where they are here, and what is in them."""

    joint: FleetJoint
    files: Mapping[Path, bytes]

    @property
    def origin(self) -> FleetRow:
        """What a row was made from: the recordings' paths, and a hash over all files, their paths and their content."""
        digest = hashlib.sha256(f"{self.joint.joint}\n{self.joint.simulation}\n{self.joint.friction}\n".encode())
        for content in self.files.values():
            digest.update(hashlib.sha256(content).digest())
        return {"recordings": _sources(self.joint), "sha256": digest.hexdigest()}

    def gave(self, row: FleetRow | None) -> bool:
        """Whether a row is the finished one of these very files."""
        return row is not None and not row["error"] and all(row.get(k) == v for k, v in self.origin.items())


class _Answer(NamedTuple):
    """What came back: the row, and the files that were written, by their path in the folder."""

    row: FleetRow
    files: dict[str, bytes]


def run_fleet(
    joints: Sequence[FleetJoint],
    work: Work,
    out: Path,
    executor: tuple[Executor, int],
    *,
    settings: Mapping[str, Any],
    resume: bool = False,
    progress: Callable[[FleetRow | None], None] = lambda row: None,
) -> list[FleetRow]:
    """Do all joints; one that fails has its error in its row and stops no other.

    Args:
        joints: With names that differ.
        work: What runs for each.
        out: Folder; each joint gets one in it.
        executor: With the number of its workers, as `open_executor` gives it.
        settings: What the rows depend on beside the joints; a run with others is not gone on with.
        resume: Keep what is finished, and do what failed, is missing, or was done from other files.
        progress: Called with the row of each joint, and with None for each that was finished before.

    Returns:
        The rows of all joints, in their order; `fleet.parquet` holds them too.

    Raises:
        RecordingError: The folder holds a run and is not to be resumed, or with other settings.
    """
    joints = [at_home(joint) for joint in joints]
    before = begin_fleet(out, settings, resume)
    for joint, future in stream(_pack_all(joints, work, out, before, progress), _work_in_folder, executor):
        row, files = _take(joint, future)
        _replace_files(files, out / joint.name, before.get(joint.name))
        write_row(row | {"written": ";".join(sorted(files))}, out)
        progress(row)
    return collect_rows(joints, out)


def at_home(joint: FleetJoint) -> FleetJoint:
    """The joint with whole paths: they say which file is meant wherever the next call is made."""
    return replace(
        joint,
        recordings=tuple(path.absolute() for path in joint.recordings),
        simulation=joint.simulation and joint.simulation.absolute(),
        friction=joint.friction and joint.friction.absolute(),
    )


def read_rows(out: Path) -> list[FleetRow]:
    """The rows that are in the folder of a fleet so far."""
    from pyarrow import parquet

    return [parquet.read_table(path).to_pylist()[0] for path in sorted((out / "rows").glob("*.parquet"))]


def begin_fleet(out: Path, settings: Mapping[str, Any], resume: bool) -> dict[str, FleetRow]:
    """Make the folder of a fleet, or find the rows that are in it, by name.

    Raises:
        RecordingError: The folder holds a run and is not to be resumed, or with other settings.
    """
    path, wanted = out / _SETTINGS, json.loads(json.dumps(settings))
    if path.exists():
        if not resume:
            raise RecordingError(f"{out} holds a fleet: give --resume to go on with it, or another --out")
        found = json.loads(path.read_text(encoding="utf-8"))
        if found != wanted:
            raise RecordingError(f"{out} holds a fleet with {found}, not with {wanted}: give another --out")
    (out / "rows").mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(wanted, indent=1) + "\n", encoding="utf-8")
    return {row["name"]: row for row in read_rows(out)}


def pack(joint: FleetJoint) -> Parcel:
    """A joint with the content of its files.

    Raises:
        OSError: A file cannot be read.
    """
    paths = [*joint.recordings, *(path for path in (joint.simulation, joint.friction) if path is not None)]
    return Parcel(joint, {path.absolute(): path.read_bytes() for path in paths})


def _pack_all(
    joints: Sequence[FleetJoint],
    work: Work,
    out: Path,
    before: Mapping[str, FleetRow],
    progress: Callable[[FleetRow | None], None],
) -> Iterator[tuple[FleetJoint, tuple[Work, Parcel]]]:
    """Each joint that is still to do with its files, read when it is its turn.

    One whose files cannot be read has failed already, unless they were read and done before.
    """
    for joint in joints:
        row = before.get(joint.name)
        try:
            parcel = pack(joint)
        except OSError as error:
            if row is not None and not row["error"] and row["recordings"] == _sources(joint):
                progress(None)
                continue
            row = failed_row(joint, f"cannot read {error.filename}: {error.strerror}")
            write_row(row, out)
            progress(row)
            continue
        if parcel.gave(row):
            progress(None)
        else:
            yield joint, (work, parcel)


def _work_in_folder(work: Work, parcel: Parcel) -> _Answer:
    """On a worker: unpack, do the joint, and pack up what it wrote."""
    start = time.perf_counter()
    with TemporaryDirectory() as place:
        out = Path(place) / "out"
        out.mkdir()
        try:
            row = {"error": "", **work(_unpack(parcel, Path(place)), out)}
        except (FricompError, OSError) as error:
            row = {"error": str(error)}
        files = {str(path.relative_to(out)): path.read_bytes() for path in out.rglob("*") if path.is_file()}
    row |= {"name": parcel.joint.name, "seconds": time.perf_counter() - start}
    return _Answer(row | parcel.origin, files)


def _unpack(parcel: Parcel, place: Path) -> FleetJoint:
    """The joint with its files here: the original where this machine has it, so that a mesh beside it is found."""
    where: dict[Path, Path] = {}
    for number, (path, content) in enumerate(parcel.files.items()):
        same = path.is_file() and path.stat().st_size == len(content) and path.read_bytes() == content
        where[path] = path if same else place / str(number) / path.name
        if not same:
            where[path].parent.mkdir()
            where[path].write_bytes(content)
    joint = parcel.joint

    def here(path: Path | None) -> Path | None:
        return None if path is None else where[path.absolute()]

    recordings = tuple(where[path.absolute()] for path in joint.recordings)
    return replace(joint, recordings=recordings, simulation=here(joint.simulation), friction=here(joint.friction))


def _take(joint: FleetJoint, future: Future[Any]) -> _Answer:
    """What a worker gave; an error that nobody foresaw fails this joint and no other."""
    try:
        answer: _Answer = future.result()
    except BrokenExecutor:
        raise
    except Exception as error:  # of numerics on a strange recording, or of a cluster that gave up on it
        return _Answer(failed_row(joint, f"{type(error).__name__}: {error}"), {})
    return answer


def failed_row(joint: FleetJoint, error: str) -> FleetRow:
    """The row of a joint that gave nothing."""
    return {"error": error, "name": joint.name, "seconds": 0.0, "recordings": _sources(joint)}


def _sources(joint: FleetJoint) -> str:
    return ";".join(map(str, joint.recordings))


def _replace_files(files: Mapping[str, bytes], folder: Path, before: FleetRow | None) -> None:
    """Write what a joint gave; what it had given from other files and does not now is no longer true."""
    written = (before or {}).get("written") or ""
    for name in set(filter(None, written.split(";"))).difference(files):
        (folder / name).unlink(missing_ok=True)
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)


def write_row(row: FleetRow, out: Path) -> None:
    """Put a joint's row on disk: where it is, the joint is finished."""
    write_rows([row], out / "rows" / f"{row['name']}.parquet")


def write_rows(rows: Sequence[FleetRow], path: Path) -> None:
    """Write rows as a Parquet file, whole or not at all; what a row does not have is empty there."""
    import pyarrow
    from pyarrow import parquet

    columns = list(dict.fromkeys(key for row in rows for key in row))
    with whole_file(path) as part:
        parquet.write_table(pyarrow.Table.from_pylist([{c: row.get(c) for c in columns} for row in rows]), part)


def collect_rows(joints: Sequence[FleetJoint], out: Path) -> list[FleetRow]:
    """All rows in the order of the joints, and in one file."""
    rows = {row["name"]: row for row in read_rows(out)}
    wanted = [rows[joint.name] for joint in joints]
    write_rows(wanted, out / "fleet.parquet")
    return wanted

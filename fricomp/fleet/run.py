"""Running one call for each joint of a fleet, on any executor; what is finished is on disk at once.

A worker gets the files of its joint as bytes and works in a folder of its own, so that it needs neither this machine's
files nor its folders. What it writes comes back as bytes and lands in the joint's folder, and its row as a Parquet
file in `rows/`, last of all: where a row is, the joint is finished.
"""

import hashlib
import os
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from fricomp.errors import FricompError
from fricomp.folder_lock import FolderLock
from fricomp.result_kinds import FLEET
from fricomp.results import make_folder
from fricomp.whole_file import write_whole

from .executor import stream
from .joint import FleetJoint
from .rows import FleetRow, begin_fleet, collect_rows, has_row, write_row

Work = Callable[[FleetJoint, Path], FleetRow]
"""Does one joint: gets it and the folder to write into, and gives its row. A module's function, so that it travels."""


@dataclass(frozen=True)
class Parcel:
    """A joint with its files: where they are here, and what is in them."""

    joint: FleetJoint
    files: Mapping[Path, bytes]

    @property
    def origin(self) -> FleetRow:
        """What a row was made from: paths, the joint's name, and a hash over them and the content of all files."""
        digest = hashlib.sha256(f"{self.joint.joint}\n{self.joint.simulation}\n{self.joint.friction}\n".encode())
        for content in self.files.values():
            digest.update(hashlib.sha256(content).digest())
        return {**_given(self.joint), "sha256": digest.hexdigest()}

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
    check: Callable[[FleetJoint, Path], None] = lambda joint, folder: None,
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
        check: Called here with each joint that is to do and its folder; one that it refuses with a `FricompError` has
            failed, and its folder stays as it is.

    Returns:
        The rows of all joints, in their order; `fleet.parquet` holds them too.

    Raises:
        RecordingError: The folder holds a run and is not to be resumed, or with other settings.
        OutputError: Another process writes there.
    """
    joints = [at_home(joint) for joint in joints]
    make_folder(out)
    with FolderLock.take(out) as lock:
        lock.note(FLEET.kind)
        return _run_all(joints, work, out, executor, settings, resume=resume, progress=progress, check=check)


def _run_all(
    joints: Sequence[FleetJoint],
    work: Work,
    out: Path,
    executor: tuple[Executor, int],
    settings: Mapping[str, Any],
    *,
    resume: bool,
    progress: Callable[[FleetRow | None], None],
    check: Callable[[FleetJoint, Path], None],
) -> list[FleetRow]:
    before = begin_fleet(out, settings, resume)
    todo = _pack_all(joints, out, before, progress, check)
    items = ((parcel.joint, (work, parcel)) for parcel in todo)
    for joint, future in stream(items, _work_in_folder, executor):
        row, files = _take(joint, future)
        row = land(joint, row, files, before.get(joint.name), out)
        progress(row)
    return collect_rows(joints, out)


def land(joint: FleetJoint, row: FleetRow, files: Mapping[str, bytes], before: FleetRow | None, out: Path) -> FleetRow:
    """Put the files of a joint into its folder, then its row; gives the row.

    A first row says which files are about to be written, so that those of a process that was killed meanwhile are
    known as the fleet's own. A joint that would replace what is not has failed.

    Args:
        joint: Whose files they are.
        row: What is said of it.
        files: What was made, by path in the folder.
        before: Its row of an earlier run.
        out: Folder of the fleet.
    """
    folder, own = out / joint.name, _written(before)
    is_known = before is not None or not has_row(joint, out)  # of a row that is damaged the files were the fleet's
    foreign = sorted(name for name in files if is_known and name not in own and os.path.lexists(folder / name))
    if foreign or folder.is_symlink():
        what = f"holds {', '.join(foreign)} of something else" if foreign else "is a link, which is not followed"
        row = failed_row(joint, f"{folder} {what}: choose another --out, or move it away")
        write_row(row | {"written": ";".join(sorted(own))}, out)
        return row
    begun = failed_row(joint, "its files were not written to the end: --resume goes on")
    write_row(begun | {"written": ";".join(sorted(own.union(files)))}, out)
    _replace_files(files, folder, before)
    write_row(row | {"written": ";".join(sorted(files))}, out)
    return row


def _written(row: FleetRow | None) -> set[str]:
    """Files that an earlier run of the fleet has put into the folder of a joint."""
    return set(filter(None, ((row or {}).get("written") or "").split(";")))


def at_home(joint: FleetJoint) -> FleetJoint:
    """The joint with whole paths: they say which file is meant wherever the next call is made."""
    return replace(
        joint,
        recordings=tuple(path.absolute() for path in joint.recordings),
        simulation=joint.simulation and joint.simulation.absolute(),
        friction=joint.friction and joint.friction.absolute(),
    )


def pack(joint: FleetJoint) -> Parcel:
    """A joint with the content of its files.

    Raises:
        OSError: A file cannot be read.
    """
    paths = [*joint.recordings, *(path for path in (joint.simulation, joint.friction) if path is not None)]
    return Parcel(joint, {path.absolute(): path.read_bytes() for path in paths})


def _pack_all(
    joints: Sequence[FleetJoint],
    out: Path,
    before: Mapping[str, FleetRow],
    progress: Callable[[FleetRow | None], None],
    check: Callable[[FleetJoint, Path], None],
) -> Iterator[Parcel]:
    """Each joint that is still to do with its files, read when it is its turn.

    One whose files cannot be read has failed already, unless its recordings alone are out of reach and it was finished.
    """
    for joint in joints:
        row = before.get(joint.name)
        try:
            parcel = pack(joint)
        except OSError as error:
            progress(None if is_kept(row, joint, error) else write_failed(joint, error, row, out))
            continue
        if parcel.gave(row):
            progress(None)
            continue
        try:
            check(joint, out / joint.name)
        except FricompError as error:
            failed = failed_row(joint, str(error)) | {"written": (row or {}).get("written")}
            write_row(failed, out)
            progress(failed)
            continue
        yield parcel


def is_kept(row: FleetRow | None, joint: FleetJoint, error: OSError) -> bool:
    """Whether a joint stays as it was finished: from the same paths, of which only a recording is out of reach."""
    same = row is not None and not row["error"] and all(row.get(k) == v for k, v in _given(joint).items())
    return same and error.filename in map(str, joint.recordings)


def write_failed(joint: FleetJoint, error: FricompError | OSError, before: FleetRow | None, out: Path) -> FleetRow:
    """Write the row of a joint that gives nothing now, remove what it had given before, and return the row."""
    _replace_files({}, out / joint.name, before)
    said = f"cannot read {error.filename}: {error.strerror}" if isinstance(error, OSError) else str(error)
    row = failed_row(joint, said)
    write_row(row, out)
    return row


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
    return {"error": error, "name": joint.name, "seconds": 0.0, **_given(joint)}


def _given(joint: FleetJoint) -> FleetRow:
    """Where a joint's files are, and its name in the simulation."""
    names = {"simulation": joint.simulation, "joint": joint.joint, "friction": joint.friction}
    return {"recordings": ";".join(map(str, joint.recordings)), **{k: str(v or "") for k, v in names.items()}}


def _replace_files(files: Mapping[str, bytes], folder: Path, before: FleetRow | None) -> None:
    """Write what a joint gave; what it had given from other files and does not now is no longer true."""
    for name in _written(before).difference(files):
        (folder / name).unlink(missing_ok=True)
    for name, content in files.items():
        write_whole(folder / name, content)

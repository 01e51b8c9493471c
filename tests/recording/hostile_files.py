"""Damaged and hostile recordings without end: every reader answers each with a result or an error of its own.

    python tests/recording/hostile_files.py --count 100000 --formats csv parquet --seed 0

A child process reads the files, with a limit on its memory and on the time of each: what kills it, such as a fault in
a parser written in C, is told with the file that did.
"""

from __future__ import annotations

import argparse
import resource
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fricomp.errors import FricompError
from fricomp.recording import Recording, RecordingMetadata, read_recording, write_recording
from fricomp.recording.mapping import Source
from fricomp.recording.sources import read_columns

__all__ = ["FORMATS", "Outcome", "read_hostile", "write_seed_file"]

MEMORY = 3 * 2**30  # of a reader [bytes]; content of 1 GiB, twice, and the libraries
SECONDS = 20  # for one file; a usual one takes a hundredth of a second
BATCH = 2000  # files that one child reads

Outcome = Counter[str]
"""How many files were read, refused, and each kind of fault, by name."""


class TooSlow(BaseException):
    """A file that takes longer than any other would."""


def _columns() -> dict[str, np.ndarray]:
    time = np.arange(60) * 0.01
    return {"time": time, "position": np.sin(time), "torque": np.cos(time)}


def _recording() -> Recording:
    return Recording.from_channels(_columns(), RecordingMetadata(joint="elbow"))


def _write_mat(path: Path) -> None:
    from scipy.io import savemat

    savemat(path, {**_columns(), "about": {"joint": "elbow", "gains": np.eye(3)}}, do_compression=True)


def _write_npz(path: Path) -> None:
    arrays: dict[str, Any] = _columns()
    np.savez_compressed(path, **arrays)


def _write_json(path: Path) -> None:
    import msgspec

    rows = [dict(zip(_columns(), row, strict=True)) for row in np.column_stack(list(_columns().values())).tolist()]
    path.write_bytes(msgspec.json.encode({"about": {"joint": "elbow"}, "rows": rows}))


def _write_mcap(path: Path) -> None:
    import msgspec
    from mcap.writer import CompressionType, Writer

    with path.open("wb") as stream:
        writer: Any = Writer(stream, chunk_size=512, compression=CompressionType.ZSTD)
        writer.start()
        schema = writer.register_schema("joint", "jsonschema", b"{}")
        channel = writer.register_channel("/joint", "json", schema)
        for number in range(60):
            data = msgspec.json.encode({"position": 0.1 * number, "torque": 1.0})
            writer.add_message(channel, number * 10_000_000, data, number * 10_000_000)
        writer.finish()


def _write_rosbag(path: Path) -> None:
    from rosbags.rosbag2 import Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    stamp, header, state = (
        store.types[f"{name}"]
        for name in ("builtin_interfaces/msg/Time", "std_msgs/msg/Header", "sensor_msgs/msg/JointState")
    )
    with Writer(path, version=9) as bag:
        connection = bag.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for number in range(20):
            head = header(stamp=stamp(sec=number, nanosec=0), frame_id="")
            values = np.array([0.1 * number])
            message = state(header=head, name=["elbow"], position=values, velocity=values, effort=values)
            bag.write(connection, number * 10**9, store.serialize_cdr(message, state.__msgtype__))


def _read_text(path: Path) -> object:
    return read_columns(path, Source(header=True), ["time", "torque"], skip_bad_rows=True)


def _read_array(path: Path) -> object:
    return read_columns(path, Source(records="rows" if path.suffix == ".json" else ""), [1])


FORMATS: dict[str, tuple[str, Callable[[Path], None], tuple[Callable[[Path], object], ...]]] = {
    "csv": ("a.csv", lambda path: write_recording(_recording(), path), (read_recording, _read_text)),
    "parquet": ("a.parquet", lambda path: write_recording(_recording(), path), (read_recording,)),
    "mat": ("a.mat", _write_mat, (_read_array,)),
    "npy": ("a.npy", lambda path: np.save(path, np.column_stack(list(_columns().values()))), (_read_array,)),
    "npz": ("a.npz", _write_npz, (_read_array,)),
    "json": ("a.json", _write_json, (_read_array,)),
    "mcap": ("a.mcap", _write_mcap, (_read_array,)),
    "rosbag2": ("bag", _write_rosbag, (_read_array,)),
}
"""Name of a file of each format, what writes a whole one, and what reads it."""


def write_seed_file(name: str, folder: Path) -> Path:
    """Write the whole file of a format that is damaged afterwards; gives the file, for a bag its folder."""
    file, write, _ = FORMATS[name]
    write(folder / file)
    return folder / file


def _damage(data: bytes, rng: np.random.Generator) -> bytes:
    """A copy with a few bytes changed, cut, repeated, inserted, or replaced by extreme numbers."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 6))):
        at, length = int(rng.integers(0, max(len(changed), 1))), int(rng.integers(1, 17))
        match int(rng.integers(0, 6)):
            case 0:
                changed[at : at + length] = rng.bytes(length)
            case 1:
                del changed[at : at + length * int(rng.integers(1, 40))]
            case 2:
                changed[at:at] = changed[at : at + length] * int(rng.integers(1, 60))
            case 3:
                changed[at : at + 8] = _SIZES[int(rng.integers(0, len(_SIZES)))]
            case 4:
                changed[at : at + 1] = bytes([changed[at] ^ (1 << int(rng.integers(0, 8)))]) if changed else b"x"
            case _:
                changed[at:at] = _EXTREMES[int(rng.integers(0, len(_EXTREMES)))]
    return bytes(changed)


_SIZES = tuple(size.to_bytes(8, "little") for size in (0, 2**31 - 1, 2**32 - 1, 2**63 - 1, 2**64 - 1))
_EXTREMES = (
    *(b"nan", b"1e999", b"-", b"9" * 5000, b"[" * 2000, b'{"a":' * 2000, b"\xff\xfe", b"\x00", b",,,", b"\r\n\r\n"),
    b'"',
)


def _expire(*_: object) -> None:
    raise TooSlow


def read_hostile(name: str, count: int, seed: int, *, first: int = 0) -> Outcome:
    """Read damaged copies of one file in this process.

    Args:
        name: Of the format.
        count: Copies.
        seed: Of the damage; copy k of a seed is always the same.
        first: Number of the first copy.

    Returns:
        What came of them; a fault is named by its kind and the number of the copy that showed it first.
    """
    outcome: Outcome = Counter()
    before = signal.signal(signal.SIGALRM, _expire)
    try:
        with tempfile.TemporaryDirectory() as folder:
            source = write_seed_file(name, Path(folder))
            files = sorted(source.iterdir()) if source.is_dir() else [source]
            whole = {file: file.read_bytes() for file in files}
            for number in range(first, first + count):
                rng = np.random.default_rng([seed, number])
                hit = files[int(rng.integers(0, len(files)))]
                hit.write_bytes(_damage(whole[hit], rng))
                for read in FORMATS[name][2]:
                    outcome[_try(read, source, number)] += 1
                hit.write_bytes(whole[hit])
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, before)
    return outcome


def _try(read: Callable[[Path], object], path: Path, number: int) -> str:
    signal.setitimer(signal.ITIMER_REAL, SECONDS)
    try:
        read(path)
    except FricompError:
        return "refused"
    except TooSlow:
        return f"slow, copy {number}"
    except BaseException as error:
        return f"{type(error).__name__}: {str(error)[:100]}, copy {number}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
    return "read"


def _read_in_child(name: str, count: int, seed: int, first: int) -> Outcome:
    command = [sys.executable, __file__, "--child", "--formats", name, "--count", str(count), "--seed", str(seed)]
    done = subprocess.run([*command, "--first", str(first)], check=False, capture_output=True, text=True)
    found: Outcome = Counter()
    for line in done.stdout.splitlines():
        often, _, what = line.partition(" ")
        found[what] += int(often)
    if done.returncode:
        found[f"the reader died with {done.returncode} between copies {first} and {first + count}"] += 1
    return found


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--formats", nargs="+", choices=FORMATS, default=list(FORMATS))
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--child", action="store_true", help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.child:
        resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
        for what, often in read_hostile(asked.formats[0], asked.count, asked.seed, first=asked.first).items():
            sys.stdout.write(f"{often} {' '.join(what.split())}\n")
        return
    for name in asked.formats:
        total: Outcome = Counter()
        for first in range(asked.first, asked.first + asked.count, BATCH):
            total += _read_in_child(name, min(BATCH, asked.first + asked.count - first), asked.seed, first)
        told = ", ".join(f"{what}: {often}" for what, often in total.most_common(12))
        sys.stdout.write(f"{name}: {asked.count} files; {told}\n")
        sys.stdout.flush()


if __name__ == "__main__":
    _main()

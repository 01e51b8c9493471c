"""Damaged and hostile recordings, models, configurations and mappings without end: every reader answers each with a
result or an error of its own.

    python tests/recording/hostile_files.py --count 100000 --formats csv parquet --seed 0

A child process reads the files, with a limit on its memory and on the time of each: what kills it, such as a fault in
a parser written in C, is told with the file that did. MATLAB files, each of which is read by a process of its own, are
read by copies of that child, which have scipy already.
"""

from __future__ import annotations

import argparse
import os
import re
import resource
import signal
import subprocess
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, NoReturn
from unittest.mock import patch

import numpy as np

import fricomp.recording
from fricomp.adapters import open_adapter
from fricomp.adapters.configuration import choose_adapter
from fricomp.calibration.network.architecture import Layer, TanhNetwork
from fricomp.calibration.network.onnx_file import save_network
from fricomp.control import NetworkCompensator
from fricomp.errors import FricompError
from fricomp.export import stack_networks
from fricomp.laws import FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel, Validity, load_model, save_model
from fricomp.recording import Recording, RecordingMetadata, load_mapping, read_recording, write_recording
from fricomp.recording.mapping import Source
from fricomp.recording.sources import mat_file, read_columns

__all__ = ["FORMATS", "Outcome", "read_hostile", "write_seed_file"]

MEMORY = 3 * 2**30  # of a reader [bytes]; content of 1 GiB, twice, and the libraries
MAPPING = Path(fricomp.recording.__file__).parent / "mappings" / "emps.toml"
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


def _write_mat(path: Path, *, packed: bool = True) -> None:
    from scipy.io import savemat

    savemat(path, {**_columns(), "about": {"joint": "elbow", "gains": np.eye(3)}}, do_compression=packed)


def _write_npz(path: Path) -> None:
    arrays: dict[str, Any] = _columns()
    np.savez_compressed(path, **arrays)


def _write_json(path: Path) -> None:
    import msgspec

    rows = [dict(zip(_columns(), row, strict=True)) for row in np.column_stack(list(_columns().values())).tolist()]
    path.write_bytes(msgspec.json.encode({"about": {"joint": "elbow"}, "rows": rows}))


def _write_mcap(path: Path, *, packed: bool = True) -> None:
    import msgspec
    from mcap.writer import CompressionType, Writer

    with path.open("wb") as stream:
        compression = CompressionType.ZSTD if packed else CompressionType.NONE
        writer: Any = Writer(stream, chunk_size=512, compression=compression, enable_crcs=packed)
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


_CONFIG = """
backend = "mit"
watchdog = 0.1
stale_after = 0.02
allow_no_watchdog = false
[bus]
interface = "slcan-chunked"
channel = "usb:FT6S4DSP"
bitrate = 1000000
options = {}
[[joints]]
name = "elbow"
id = 1
model = "damiao/DM4310"
limits = { torque = 4.0, torque_rate = 200.0, velocity = 8.0, position = [-2.0, 2.0], breakaway = 1.0 }
transmission = { gear_ratio = 6.0, sign = -1, zero = 0.1 }
"""


def _write_model(path: Path) -> None:
    law = FrictionLaw((Stribeck(StribeckCurve(0.2, 0.5, 0.05, 0.1)),))
    save_model(FrictionModel(law, validity=Validity(velocity=(-1.0, 1.0))), path)


def _write_network(path: Path) -> None:
    rng = np.random.default_rng(1)
    layers = tuple(Layer(rng.normal(size=(n, m)) / m, rng.normal(size=n)) for m, n in ((2, 8), (8, 8), (8, 1)))
    save_network(TanhNetwork(layers, 1.3, 1.0, 0.5, 0.7), path, {"velocity_range": "-1 1"})


def _stack_network(path: Path) -> object:
    return stack_networks([path, path], any_status=True)


def _use_network(path: Path) -> object:
    return NetworkCompensator(path, any_status=True, period=1000.0)  # not how fast a busy machine is


def _write_config(path: Path) -> None:
    path.write_text(_CONFIG)


def _write_mapping(path: Path) -> None:
    path.write_bytes(MAPPING.read_bytes())


def _read_mapping(path: Path) -> object:
    return load_mapping(path)


def _read_config(path: Path) -> object:
    return open_adapter(*choose_adapter(None, path))


def _read_text(path: Path) -> object:
    return read_columns(path, Source(header=True), ["time", "torque"], skip_bad_rows=True)


def _read_array(path: Path) -> object:
    return read_columns(path, Source(records="rows" if path.suffix == ".json" else ""), [1])


FORMATS: dict[str, tuple[str, Callable[[Path], None], tuple[Callable[[Path], object], ...]]] = {
    "csv": ("a.csv", lambda path: write_recording(_recording(), path), (read_recording, _read_text)),
    "parquet": ("a.parquet", lambda path: write_recording(_recording(), path), (read_recording,)),
    "mat": ("a.mat", _write_mat, (_read_array,)),
    "mat-bare": ("a.mat", partial(_write_mat, packed=False), (_read_array,)),
    "npy": ("a.npy", lambda path: np.save(path, np.column_stack(list(_columns().values()))), (_read_array,)),
    "npz": ("a.npz", _write_npz, (_read_array,)),
    "json": ("a.json", _write_json, (_read_array,)),
    "mcap": ("a.mcap", _write_mcap, (_read_array,)),
    "mcap-bare": ("a.mcap", partial(_write_mcap, packed=False), (_read_array,)),
    "rosbag2": ("bag", _write_rosbag, (_read_array,)),
    "model": ("friction.json", _write_model, (load_model,)),
    "network": ("friction.onnx", _write_network, (_stack_network, _use_network)),
    "config": ("drive.toml", _write_config, (_read_config,)),
    "mapping": ("log.toml", _write_mapping, (_read_mapping,)),
}
"""Name of a file of each format, what writes a whole one, and what reads it; a bare one has no checksums, which find
most damage before a parser does."""


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


def _flip(data: bytes, rng: np.random.Generator) -> bytes:
    """A copy with a few bytes changed in their places, so that lengths stay true."""
    changed = bytearray(data)
    for _ in range(int(rng.integers(1, 4))):
        changed[int(rng.integers(0, len(changed)))] = int(rng.integers(0, 256))
    return bytes(changed)


def _exchange(data: bytes, rng: np.random.Generator) -> bytes:
    """A copy of a text that is well formed but for its meaning: one or two of its values are others."""
    for _ in range(int(rng.integers(1, 3))):
        values = list(_VALUE.finditer(data))
        if not values:
            return data
        found = values[int(rng.integers(0, len(values)))]
        data = data[: found.start()] + _VALUES[int(rng.integers(0, len(_VALUES)))] + data[found.end() :]
    return data


_VALUE = re.compile(rb'"[^"\n]*"(?!\s*:)|(?<![\w"])-?\d+\.?\d*(?:[eE][-+]?\d+)?|\btrue\b|\bfalse\b|\bnull\b')
_VALUES = (
    *(b"0", b"-1", b"-0.0", b"1e308", b"-1e308", b"1e-320", b"nan", b"inf", b"99999999999999999999", b"true", b"null"),
    *(b'""', b'"x"', b'"nan"', b'"../../x"', b'"\\u0000"', b"[]", b"{}", b"[1, 2]", b"[[1]]", b'{"a": 1}', b"{a = 1}"),
)
_IN_PLACE = dict.fromkeys(("model", "config", "mapping", "json", "csv"), _exchange) | {"network": _flip}
"""Formats of which every second copy is well formed, or nearly so, and means something else."""

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
                spoil = _damage if number % 2 == 0 else _IN_PLACE.get(name, _damage)
                hit.write_bytes(spoil(whole[hit], rng))
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


def _call_in_copy(call: Sequence[str], **_options: object) -> subprocess.CompletedProcess[bytes]:
    """What the reader of MATLAB files asks of a new interpreter, by a copy of this process."""
    with tempfile.TemporaryFile() as told, tempfile.TemporaryFile() as complained:
        copy = os.fork()
        if copy == 0:
            _write_and_leave(call[-1], told.fileno(), complained.fileno())
        try:
            status = os.waitpid(copy, 0)[1]
        except BaseException:
            os.kill(copy, signal.SIGKILL)
            os.waitpid(copy, 0)
            raise
        texts = [os.pread(file.fileno(), os.fstat(file.fileno()).st_size, 0) for file in (told, complained)]
    return subprocess.CompletedProcess(call, os.waitstatus_to_exitcode(status), *texts)


def _write_and_leave(path: str, told: int, complained: int) -> NoReturn:
    status = 1
    try:
        os.dup2(told, 1)
        os.dup2(complained, 2)
        warnings.simplefilter("ignore")
        sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
        mat_file._write_variables(path)
        status = 0
    except SystemExit as end:
        status = int(end.code or 0)
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


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
        with patch.object(subprocess, "run", _call_in_copy):
            outcome = read_hostile(asked.formats[0], asked.count, asked.seed, first=asked.first)
        for what, often in outcome.items():
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

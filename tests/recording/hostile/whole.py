"""Whole files of every format that is read, what reads them, and what else may be made of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import fricomp.recording
from fricomp.adapters import open_adapter
from fricomp.adapters.configuration import choose_adapter
from fricomp.calibration.network.architecture import Layer, TanhNetwork
from fricomp.calibration.network.onnx_file import save_network
from fricomp.control import NetworkCompensator
from fricomp.export import stack_networks
from fricomp.laws import FrictionLaw, Stribeck, StribeckCurve
from fricomp.model import FrictionModel, Validity, load_model, save_model
from fricomp.recording import Recording, RecordingMetadata, convert, load_mapping, read_recording, write_recording
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.mapping import Source
from fricomp.recording.sources import read_columns

from .damage import exchange, flip
from .ros import write_bag
from .strange import STRANGE

_MAPPING = Path(fricomp.recording.__file__).parent / "mappings" / "emps.toml"


class Format(NamedTuple):
    """A format of files.

    Attributes:
        file: Name of a file, or of a folder.
        write: Writes a whole one.
        readers: What reads it.
        exchange: Makes a copy that is well formed, or nearly so; damage does where there is none.
        strange: Writes a well-formed one of another schema, if there are such.
    """

    file: str
    write: Callable[[Path], None]
    readers: tuple[Callable[[Path], object], ...]
    exchange: Callable[[bytes, np.random.Generator], bytes] | None = None
    strange: Callable[[Path, np.random.Generator], None] | None = None


def _columns() -> dict[str, np.ndarray]:
    time = np.arange(60) * 0.01
    return {"time": time, "position": np.sin(time), "torque": np.cos(time)}


def _recording() -> Recording:
    return Recording.from_channels(_columns(), RecordingMetadata(joint="elbow"))


def _write_hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        group = file.create_group("observations")
        for name, values in _columns().items():
            group.create_dataset(name, data=values, compression="gzip" if name == "torque" else None)
        group.attrs["unit"] = "rad"
        file["names"] = ["elbow", "wrist"]


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
    path.write_bytes(_MAPPING.read_bytes())


def _read_mapping(path: Path) -> object:
    return load_mapping(path)


def _read_config(path: Path) -> object:
    return open_adapter(*choose_adapter(None, path))


def _read_text(path: Path) -> object:
    return read_columns(path, Source(header=True), ["time", "torque"], skip_bad_rows=True)


def _read_array(path: Path) -> object:
    return read_columns(path, Source(records="rows" if path.suffix == ".json" else ""), [1])


def _convert(path: Path) -> object:
    mapping = path.parent / "map.toml"
    if not mapping.exists():
        mapping.write_text('[channels]\ntime.column = "time"\nposition.column = "position"\ntorque.column = "torque"\n')
    return convert(path, load_mapping(mapping))


def _log(
    file: str,
    write: Callable[[Path], None],
    strange: str = "",
    exchange: Callable[[bytes, np.random.Generator], bytes] | None = None,
    *more: Callable[[Path], object],
) -> Format:
    """A format of logs, read as `convert --inspect`, `identify` and `convert --mapping` do."""
    return Format(file, write, (*more, inspect_log, read_recording, _convert), exchange, STRANGE.get(strange))


def _write_text(path: Path) -> None:
    write_recording(_recording(), path)


def _write_feather(path: Path) -> None:
    import pyarrow
    from pyarrow import feather

    feather.write_feather(pyarrow.table(_columns()), str(path))


def _write_lines(path: Path) -> None:
    rows = np.column_stack(list(_columns().values())).tolist()
    path.write_text("\n".join(f'{{"time": {t}, "position": {q}, "torque": {u}}}' for t, q, u in rows))


FORMATS: dict[str, Format] = {
    "csv": _log("a.csv", _write_text, "csv", exchange, _read_text),
    "parquet": _log("a.parquet", _write_text, "parquet"),
    "feather": _log("a.feather", _write_feather, "feather"),
    "mat": _log("a.mat", _write_mat, "mat"),
    "hdf5": _log("a.h5", _write_hdf5),
    "mat-bare": Format("a.mat", partial(_write_mat, packed=False), (_read_array,)),
    "npy": _log(
        "a.npy", lambda path: np.save(path, np.column_stack(list(_columns().values()))), "npy", None, _read_array
    ),
    "npz": _log("a.npz", _write_npz, "npz"),
    "json": _log("a.json", _write_json, "json", exchange, _read_array),
    "jsonl": _log("a.jsonl", _write_lines, "jsonl", exchange),
    "mcap": _log("a.mcap", _write_mcap, "mcap"),
    "mcap-bare": _log("a.mcap", partial(_write_mcap, packed=False), "protobuf"),
    "rosbag2": _log("bag", partial(write_bag, storage="sqlite3"), "rosbag2"),
    "rosbag2-mcap": _log("bag", partial(write_bag, storage="mcap"), "rosbag2-mcap"),
    "model": Format("friction.json", _write_model, (load_model,), exchange),
    "network": Format("friction.onnx", _write_network, (_stack_network, _use_network), flip),
    "config": Format("drive.toml", _write_config, (_read_config,), exchange),
    "mapping": Format("log.toml", _write_mapping, (_read_mapping,), exchange),
}
"""By name; a bare one has no checksums, which find most damage before a parser does."""


def write_seed_file(name: str, folder: Path) -> Path:
    """Write the whole file of a format that is damaged afterwards; gives the file, for a bag its folder."""
    found = FORMATS[name]
    found.write(folder / found.file)
    return folder / found.file

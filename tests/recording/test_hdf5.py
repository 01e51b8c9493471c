"""HDF5 as ALOHA writes it, with units beside its data sets, and as MATLAB 7.3; what is damaged is one clear error."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording, convert, load_mapping
from fricomp.recording.intake import Intake, read_source
from fricomp.recording.named.log import read_named_log
from fricomp.recording.sources import own_process
from fricomp.sim_bench.studies.logs.good_log import joint_log

h5py = pytest.importorskip("h5py")
LOG = joint_log(8.0, 50.0, 7)


def _only(path: Path) -> Recording:
    (recording,) = read_named_log(path).recordings
    return recording


def _write_aloha(file: Any) -> None:
    rest = np.full(len(LOG), 0.3)
    observations = file.create_group("observations")
    for name, values in (("qpos", LOG.position), ("qvel", LOG.velocity), ("effort", LOG.torque)):
        observations[name] = np.stack([rest, np.asarray(values)], axis=1)
    observations["images/cam_high"] = np.zeros((4, 6, 8, 3), np.uint8)
    file["action"] = np.stack([rest, np.asarray(LOG.position)], axis=1)


def test_the_rate_of_an_episode_without_times_is_asked_for_and_taken(tmp_path: Path) -> None:
    path = tmp_path / "episode_0.hdf5"
    with h5py.File(path, "w") as file:
        _write_aloha(file)
    with pytest.raises(RecordingError, match="--row-rate"):
        read_named_log(path)
    rest, moved = (one.recording for one in read_source(path, Intake(row_rate=50.0)))
    assert np.ptp(rest.position) == 0.0
    assert moved.position == pytest.approx(LOG.position)
    assert moved.torque == pytest.approx(LOG.torque)
    assert moved.duration == pytest.approx(LOG.duration)


def _write_units(file: Any) -> None:
    file["time"] = LOG.time
    file["angle"], file["torque"] = np.rad2deg(LOG.position), 1e3 * np.asarray(LOG.torque)
    file["angle"].attrs["units"], file["torque"].attrs["unit"] = "deg", "mNm"


def _write_period(file: Any) -> None:
    file.attrs["dt"] = 0.02
    file["joint_1/q"], file["joint_1/tau"] = LOG.position, LOG.torque


def _write_rows(file: Any) -> None:
    rows = np.empty(len(LOG), [("t", "f8"), ("q", "f8"), ("tau", "f8")])
    rows["t"], rows["q"], rows["tau"] = LOG.time, LOG.position, LOG.torque
    file.create_dataset("log", data=rows, compression="gzip", chunks=(50,))


@pytest.mark.parametrize("write", [_write_units, _write_period, _write_rows])
def test_data_sets_attributes_and_rows_are_read_by_their_names(write: Callable[[Any], None], tmp_path: Path) -> None:
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        write(file)
    recording = _only(path)
    assert recording.position == pytest.approx(LOG.position)
    assert recording.torque == pytest.approx(LOG.torque)
    assert recording.sample_period == pytest.approx(0.02)


def test_a_file_of_matlab_7_3_is_read_as_one_of_version_7(tmp_path: Path) -> None:
    path = tmp_path / "log.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in (("t", LOG.time), ("q", LOG.position), ("tau", LOG.torque)):
            file[f"log/{name}"] = np.asarray(values)[None, :]
            file[f"log/{name}"].attrs["MATLAB_class"] = np.bytes_("double")
        file["note"] = np.array([[104], [105]], np.uint16)
        file["note"].attrs["MATLAB_class"] = np.bytes_("char")
    data = path.read_bytes()
    path.write_bytes(b"MATLAB 7.3 MAT-file" + data[19:])
    assert _only(path).position == pytest.approx(LOG.position)


def test_a_mapping_reads_a_data_set_by_its_path(tmp_path: Path) -> None:
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        file["robot/joints"] = np.column_stack([LOG.position, LOG.torque])
    (tmp_path / "map.toml").write_text(
        '[channels]\ntime = { rate = 50.0 }\nposition = { column = "robot.joints:1" }\n'
        'torque = { column = "robot.joints:2" }\n'
    )
    (found,) = convert(path, load_mapping(tmp_path / "map.toml"))
    assert found.recording.torque == pytest.approx(LOG.torque)


@pytest.mark.parametrize("damage", ["cut", "text", "claim"])
def test_what_is_damaged_or_claims_too_much_is_one_clear_error(damage: str, tmp_path: Path) -> None:
    path = tmp_path / "log.h5"
    with h5py.File(path, "w") as file:
        _write_units(file)
        if damage == "claim":
            file.create_dataset("position", shape=(10**12,), dtype="f8", chunks=(1000,), compression="gzip")
    data = path.read_bytes()
    path.write_bytes({"cut": data[: len(data) // 2], "text": b"t,q,tau\n1,2,3\n", "claim": data}[damage])
    with pytest.raises(RecordingError, match="unpacks into" if damage == "claim" else "no HDF5 file"):
        read_named_log(path)


def test_a_file_that_leads_its_reader_in_circles_is_one_clear_error(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "log.h5"
    path.write_bytes(b"")
    monkeypatch.setattr(own_process, "_PATIENCE", 0.2)
    monkeypatch.setattr(own_process, "_CHILD", "{module!r}; import threading; threading.Event().wait(60)")
    with pytest.raises(RecordingError, match="its reader came to no end"):
        own_process.read_in_process("", path, "HDF5")


def _words(*words: str) -> bytes:
    """A list of words as pandas pickles it into an attribute."""
    return pickle.dumps(list(words), 0)


def _write_fixed(group: Any, index: np.ndarray, name: str = "N.", kind: str = "float") -> None:
    """As `DataFrame.to_hdf(path, key="log")`."""
    group.attrs.update({"pandas_type": np.bytes_("frame"), "nblocks": 2, "ndim": 2})
    group["axis0"] = np.array([b"q", b"tau", b"n"])
    group["axis1"] = index
    group["axis1"].attrs.update({"name": np.bytes_(name), "kind": np.bytes_(kind), "transposed": np.uint8(1)})
    group["block0_items"], group["block1_items"] = np.array([b"q", b"tau"]), np.array([b"n"])
    group["block0_values"] = np.stack([LOG.position, LOG.torque], axis=1)
    group["block1_values"] = np.arange(len(LOG))[:, None]


def _write_table(group: Any, index: np.ndarray, name: str) -> None:
    """As `DataFrame.to_hdf(path, key="log", format="table")`, with the index of a query beside it."""
    group.attrs.update({"pandas_type": np.bytes_("frame_table"), "info": _words("index_name", name), "levels": 1})
    table = np.empty(len(LOG), dtype=[("index", "f8"), ("values_block_0", "f8", 2), ("n", "i8")])
    table["index"], table["n"] = index, np.arange(len(LOG))
    table["values_block_0"] = np.stack([LOG.position, LOG.torque], axis=1)
    group["table"] = table
    group["table"].attrs.update({"values_block_0_kind": _words("q", "tau"), "index_kind": np.bytes_("float")})
    group["_i_table/q/indicesLR"] = np.arange(4 * len(LOG), dtype="u4")


@pytest.mark.parametrize("form", ["fixed", "dates", "unnamed", "table"])
def test_data_frames_have_the_names_of_their_columns_and_their_index(form: str, tmp_path: Path) -> None:
    path, time = tmp_path / "log.h5", np.asarray(LOG.time)
    with h5py.File(path, "w") as file:
        group = file.create_group("log")
        if form == "table":
            _write_table(group, time, "t")
        elif form == "dates":
            _write_fixed(group, (1.71e18 + 1e9 * time).astype("i8"), kind="datetime64[ns]")
        else:
            _write_fixed(group, time, "seconds" if form == "fixed" else "N.")
    recording = _only(path)
    assert recording.time - recording.time[0] == pytest.approx(time - time[0], abs=1e-6)
    assert recording.position == pytest.approx(LOG.position)
    assert recording.torque == pytest.approx(LOG.torque)


def test_words_of_a_frame_are_read_and_not_run(tmp_path: Path) -> None:
    path, mark = tmp_path / "log.h5", tmp_path / "ran"
    with h5py.File(path, "w") as file:
        _write_table(file.create_group("log"), np.asarray(LOG.time), "t")
        harm = f"cbuiltins\nopen\n(V{mark}\nVw\ntR.".encode()
        file["log/table"].attrs["values_block_0_kind"] = np.bytes_(harm)
    with pytest.raises(RecordingError):
        _only(path)
    assert not mark.exists()

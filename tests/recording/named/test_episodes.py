"""Episodes in groups of one file, words that are numbers, names beside a matrix, and blocks of zeros in a text."""

from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording
from fricomp.recording.intake import Intake, read_source
from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.episodes import join_episodes
from fricomp.recording.named.source import read_named_columns
from fricomp.recording.named.vendor import with_vendor_unit
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(12.0, 100.0, 7)
LENGTHS = (500, 400, 300)


def _read(path: Path, row_rate: float | None = None) -> Recording:
    (named,) = read_source(path, Intake(row_rate=row_rate))
    return named.recording


def _write_episodes(path: Path, *, timed: bool) -> Path:
    h5py = pytest.importorskip("h5py")
    start = 0
    with h5py.File(path, "w") as file:
        for number, length in enumerate(LENGTHS):
            rows = slice(start, start + length)
            own = file.create_group(f"data/demo_{number + 9}/obs")  # that 10 comes after 9
            own["joint_pos"], own["joint_torque"] = LOG.position[rows, None], LOG.torque[rows, None]
            own.attrs["num_samples"] = length
            if timed:
                own["time"] = LOG.time[rows] - LOG.time[start]
            start += length
    return path


@pytest.mark.parametrize("timed", [False, True])
def test_episodes_of_a_file_are_one_recording_in_their_order_with_gaps(tmp_path: Path, timed: bool) -> None:
    read = _read(_write_episodes(tmp_path / "demos.hdf5", timed=timed), None if timed else 100.0)
    np.testing.assert_allclose(read.position, LOG.position)
    np.testing.assert_allclose(read.torque, LOG.torque)
    steps = np.diff(read.time)
    assert np.flatnonzero(steps > 0.05).tolist() == [499, 899]
    np.testing.assert_allclose(np.delete(steps, [499, 899]), 0.01, atol=1e-9)


def test_episodes_without_times_ask_for_the_rate_of_their_rows(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="--row-rate"):
        _read(_write_episodes(tmp_path / "demos.hdf5", timed=False))


def test_groups_that_hold_other_columns_stay_apart() -> None:
    columns = {"demo_0.q": np.zeros(5), "demo_1.tau": np.zeros(5), "trial_time": np.zeros(5)}
    assert join_episodes(columns, None).keys() == columns.keys()


def test_numbers_and_dates_that_are_words_in_parquet_are_read(tmp_path: Path) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    stamps = [f"2026-03-14T10:11:{12.0 + t:09.6f}+01:00" for t in LOG.time]
    words = {"stamp": stamps, "q": [f"{x:.6f}" for x in LOG.position], "tau": [f"{x:.6f}" for x in LOG.torque]}
    parquet.write_table(pyarrow.table(words | {"state": ["[1]"] * len(LOG)}), tmp_path / "log.parquet")
    read = _read(tmp_path / "log.parquet")
    np.testing.assert_allclose(read.time - read.time[0], LOG.time, atol=1e-5)
    np.testing.assert_allclose(read.position, LOG.position, atol=1e-6)
    np.testing.assert_allclose(read.torque, LOG.torque, atol=1e-6)


@pytest.mark.parametrize("called", ["names", "columns", "legend"])
def test_a_matrix_is_named_by_the_quantities_beside_it_and_not_by_joints(tmp_path: Path, called: str) -> None:
    matrix = np.column_stack([LOG.time, LOG.position, LOG.torque])
    np.savez(tmp_path / "log.npz", data=matrix, **{called: np.array(["time", "position", "torque"])})  # type: ignore[arg-type]
    np.testing.assert_array_equal(_read(tmp_path / "log.npz").torque, LOG.torque)
    np.savez(tmp_path / "arm.npz", q=matrix, names=np.array(["hip", "knee", "toe"]))
    assert "hip.q" in read_named_columns(tmp_path / "arm.npz")


def test_a_block_of_zeros_in_a_text_costs_the_rows_that_it_cuts(tmp_path: Path) -> None:
    rows = "".join(f"{t:.4f},{q:.6f},{tau:.5f}\n" for t, q, tau in zip(LOG.time, LOG.position, LOG.torque, strict=True))
    text = f"t,q,tau\n{rows}".encode()
    (tmp_path / "log.csv").write_bytes(text[:9003] + bytes(512) + text[9515:])
    read = _read(tmp_path / "log.csv")
    assert len(LOG) - 30 < len(read) < len(LOG) - 20
    np.testing.assert_allclose(read.torque, np.interp(read.time, LOG.time, LOG.torque), atol=1e-5)


@pytest.mark.parametrize(
    ("name", "unit"), [("Phoenix6/TalonFX-1/Position", "turns"), ("TalonFX-3/Velocity", "turns/s")]
)
def test_positions_of_phoenix_are_in_rotations(name: str, unit: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert with_vendor_unit(name, meaning, {name: np.zeros(3)}).unit == unit

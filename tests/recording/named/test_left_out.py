"""Columns that nobody understands are named; counts of a turn beside the arrays are told where they are asked for."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(8.0, 50.0, 4)
COUNTS = np.round((np.asarray(LOG.position) + 9.0) / (2.0 * np.pi) * 16384)


def _write(path: Path, **more: np.ndarray) -> Path:
    columns = {"t": LOG.time, "angle_rad": LOG.position, "torque_Nm": LOG.torque, **more}
    np.savetxt(path, np.column_stack(list(columns.values())), delimiter=",", header=",".join(columns), comments="")
    return path


@pytest.mark.parametrize("name", ["vel_xyz", "w_unfiltered_x", "foo7"])
def test_a_column_that_is_not_used_is_named(name: str, tmp_path: Path) -> None:
    log = read_named_log(_write(tmp_path / "log.csv", **{name: np.asarray(LOG.velocity)}))
    assert any("not used" in note and repr(name) in note for note in log.notes)


def test_one_that_is_called_as_a_quantity_stands_first_and_the_others_are_counted(tmp_path: Path) -> None:
    others = {f"foo{k}": np.asarray(LOG.time) + k for k in range(9)}
    log = read_named_log(_write(tmp_path / "log.csv", **others, vel_xyz=np.asarray(LOG.velocity)))
    (said,) = [note for note in log.notes if "not used" in note]
    assert "not used: 'vel_xyz'" in said
    assert "4 more" in said


def test_nothing_is_said_of_what_never_changes(tmp_path: Path) -> None:
    log = read_named_log(_write(tmp_path / "log.csv", humidity=np.full(len(LOG), 3.0)))
    assert not any("not used" in note for note in log.notes)


@pytest.mark.parametrize("position", ["position", "enc_counts"])
@pytest.mark.parametrize("fact", ["cpr", "encoder_cpr", "counts_per_rev"])
def test_counts_of_a_turn_beside_the_arrays_are_told(fact: str, position: str, tmp_path: Path) -> None:
    path = tmp_path / "log.npz"
    arrays: dict[str, Any] = {"time": LOG.time, position: COUNTS, "torque": LOG.torque, fact: 16384}
    np.savez(path, **arrays)
    with pytest.raises(RecordingError, match="in this file COUNTS_A_TURN is 16384"):
        read_named_log(path)


def test_an_attribute_of_hdf5_is_such_a_fact_and_an_angle_stays_one(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "log.h5"
    for position, is_asked in ((COUNTS, True), (np.asarray(LOG.position), False)):
        with h5py.File(path, "w") as file:
            file["time"], file["position"], file["torque"] = LOG.time, position, LOG.torque
            file.attrs["cpr"] = 16384
        if is_asked:
            with pytest.raises(RecordingError, match="COUNTS_A_TURN is 16384"):
                read_named_log(path)
        else:
            assert len(read_named_log(path).recordings) == 1

"""Where no column is a time, a position and its velocity tell how many rows come a second."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log


def write(path: Path, rate: float, names: str, factors: tuple[float, float]) -> Path:
    """A log of what was asked for, velocity, angle and torque, without a time."""
    log = joint_log(20.0, rate, 4)
    velocity = np.gradient(log.position, log.time) * factors[0]
    rows = np.column_stack([velocity, log.position * factors[1], log.torque])
    np.savetxt(path, rows, delimiter="\t", header=names, comments="", fmt="%.6f")
    return path


@pytest.mark.parametrize(
    ("rate", "names", "factors"),
    [
        (100.0, "velocity\tangle\ttorque", (1.0, 1.0)),
        (250.0, "speed [rpm]\tangle [deg]\ttorque [Nm]", (30.0 / np.pi, 180.0 / np.pi)),
        (333.0, "vel [turns/s]\tpos [turns]\ttau", (0.5 / np.pi, 0.5 / np.pi)),
    ],
)
def test_a_log_without_a_time_is_told_the_rate_of_its_rows(
    rate: float, names: str, factors: tuple[float, float], tmp_path: Path
) -> None:
    path = write(tmp_path / "log.txt", rate, names, factors)
    with pytest.raises(RecordingError, match="no column of time") as refused:
        read_named_log(path)
    told = re.search(r"says --row-rate ([\d.]+)", str(refused.value))
    assert told is not None
    assert float(told.group(1)) == pytest.approx(rate, rel=0.02)
    assert read_named_log(path, row_rate=float(told.group(1))).recordings[0].duration == pytest.approx(20.0, rel=0.02)


def test_columns_that_do_not_belong_together_tell_no_rate(tmp_path: Path) -> None:
    rng = np.random.default_rng(3)
    np.savetxt(tmp_path / "log.csv", rng.normal(size=(2000, 3)), delimiter=",", header="pos,vel,tau", comments="")
    with pytest.raises(RecordingError, match="no column of time") as refused:
        read_named_log(tmp_path / "log.csv")
    assert "says --row-rate" not in str(refused.value)


@pytest.mark.parametrize("rate", [100.0, 400.0])
def test_numbers_without_names_and_time_are_proposed_as_a_joint(rate: float, tmp_path: Path) -> None:
    path = write(tmp_path / "log.txt", rate, "", (1.0, 1.0))
    (tmp_path / "log.toml").write_text(inspect_log(path).guess)
    assert 'decimal = "."' in inspect_log(path).guess
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    assert found.recording.position == pytest.approx(joint_log(20.0, rate, 4).position, abs=1e-6)
    assert found.recording.torque == pytest.approx(joint_log(20.0, rate, 4).torque, abs=1e-6)
    assert found.recording.duration == pytest.approx(20.0, rel=0.02)

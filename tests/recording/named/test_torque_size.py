"""A torque or a current as large as one in thousandths is asked about where its name states no unit, and only there."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(10.0, 200.0, 8)


@pytest.mark.parametrize(
    ("name", "factor", "is_asked"),
    [
        ("current", 400.0, True),
        ("iq", 900.0, True),
        ("current", 8.0, False),
        ("current_mA", 400.0, False),
        ("motor_torque", 1000.0, True),
        ("tau", 2000.0, True),
        ("tau", 20.0, False),
        ("torque [Nm]", 1000.0, False),
        ("effort", 1000.0, False),
    ],
)
def test_a_torque_or_current_too_large_for_a_joint_raises_the_question_of_its_unit(
    name: str, factor: float, is_asked: bool, tmp_path: Path
) -> None:
    rows = np.column_stack([LOG.time, LOG.position, factor * LOG.torque])
    path = tmp_path / "log.csv"
    np.savetxt(path, rows, delimiter=",", header=f"time,position,{name}", comments="", fmt="%.7f")
    asked = [note for note in read_named_log(path).notes if "1000 times too large" in note]
    assert bool(asked) is is_asked


@pytest.mark.parametrize(
    ("name", "unit"), [("i", "A"), ("joint.I", "A"), ("current", "A"), ("u", "N·m"), ("load", "N·m")]
)
def test_what_is_called_as_a_current_is_one_where_it_is_said_to_be_the_torque(
    name: str, unit: str, tmp_path: Path
) -> None:
    rows = np.column_stack([LOG.time, LOG.position, LOG.torque])
    path = tmp_path / "log.csv"
    np.savetxt(path, rows, delimiter=",", header=f"time,pos,{name}", comments="", fmt="%.7f")
    (recording,) = read_named_log(path, {"torque": name}).recordings
    assert recording.metadata.torque_unit == unit

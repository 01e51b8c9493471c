"""A motor's and its link's columns, told apart by a letter or a word, and the gear between them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.recording import Recording
from fricomp.recording.named.log import NamedLog, read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

from .proposed_mapping import convert_by_proposal

LOG = joint_log(10.0, 200.0, 6)


def _write(folder: Path, names: str, *columns: object) -> Path:
    path = folder / "log.csv"
    rows = np.column_stack([np.asarray(LOG.time), *map(np.asarray, columns)])
    np.savetxt(path, rows, delimiter=",", header=f"t,{names}", comments="", fmt="%.9f")
    return path


def _only(log: NamedLog) -> Recording:
    (recording,) = log.recordings
    return recording


@pytest.mark.parametrize(
    "names", ["theta_m,theta_l,i_q", "q_m,q_l,iq", "theta_motor,theta_link,iq", "angleM,angleL,i_q"]
)
@pytest.mark.parametrize("ratio", [1.0, 50.0, -99.6])
def test_one_position_is_of_the_motor_and_one_of_the_link(names: str, ratio: float, tmp_path: Path) -> None:
    path = _write(tmp_path, names, ratio * LOG.position, LOG.position, LOG.torque / 0.2)
    recording = _only(read_named_log(path))
    assert recording.position == pytest.approx(LOG.position, abs=1e-8)
    assert recording.motor_position == pytest.approx(LOG.position, abs=1e-4)  # on the joint's side of the gear
    assert recording.metadata.torque_unit == "A"
    converted = convert_by_proposal(path, tmp_path)
    assert converted.motor_position == pytest.approx(recording.motor_position, abs=1e-8)


def test_of_two_torques_the_motors_acts_and_the_links_is_its_load(tmp_path: Path) -> None:
    path = _write(
        tmp_path, "theta_m,theta_l,omega_m,tau_m,tau_l", 20.0 * LOG.position, LOG.position,
        20.0 * np.asarray(LOG.velocity), LOG.torque / 20.0, 0.9 * LOG.torque,
    )  # fmt: skip
    log = read_named_log(path)
    recording = _only(log)
    assert recording.torque == pytest.approx(LOG.torque / 20.0, abs=1e-8)
    assert recording.load_torque == pytest.approx(0.9 * LOG.torque, abs=1e-8)
    assert recording.velocity is None
    assert any("gear_ratio = 20" in note for note in log.notes)


def test_three_joints_by_a_letter_have_no_motor_among_them(tmp_path: Path) -> None:
    columns = [k * np.asarray(LOG.position) for k in (1.0, 1.1, 1.2)]
    path = _write(tmp_path, "q_l,q_mid,q_r,tau_l,tau_mid,tau_r", *columns, *columns)
    assert len(read_named_log(path).recordings) == 3

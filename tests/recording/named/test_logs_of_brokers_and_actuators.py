"""What brokers of messages and servers of machines write, and names of actuators with the motor inside."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording
from fricomp.recording.named.log import read_named_log

from .test_forms_of_printouts import POSITION, TIME, TORQUE, VELOCITY


def write(folder: Path, names: str, *columns: np.ndarray[tuple[int], np.dtype[np.float64]]) -> Path:
    np.savetxt(folder / "log.csv", np.column_stack(columns), delimiter=",", header=names, comments="", fmt="%.9f")
    return folder / "log.csv"


def require_same(recording: Recording) -> None:
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


def test_times_topics_and_values_of_a_broker_are_read(tmp_path: Path) -> None:
    rows = [
        f"{1.7e9 + t:.6f} robot/elbow/position {q:.9f}\n{1.7e9 + t:.6f} robot/elbow/torque {tau:.9f}\n"
        for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True)
    ]
    (tmp_path / "log.txt").write_text("".join(rows))
    (recording,) = read_named_log(tmp_path / "log.txt").recordings
    require_same(recording)
    assert recording.metadata.joint == "elbow"


def test_samples_of_a_server_of_machines_are_told_by_their_names(tmp_path: Path) -> None:
    rows, begin = ["SourceTimestamp,DisplayName,Value,StatusCode"], datetime(2024, 3, 1, tzinfo=UTC)
    for t, q, tau in zip(TIME, np.degrees(POSITION), TORQUE, strict=True):
        stamp = (begin + timedelta(seconds=float(t))).isoformat(timespec="microseconds")
        rows += [f"{stamp},ActualPosition [deg],{q:.9f},Good", f"{stamp},ActualTorque [Nm],{tau:.9f},Good"]
    (tmp_path / "log.csv").write_text("\n".join(rows) + "\n")
    require_same(read_named_log(tmp_path / "log.csv").recordings[0])


@pytest.mark.parametrize("name", ["motor1_{}", "motor_2.{}", "Motor[3].{}"])
def test_a_motor_with_a_number_is_an_actuator_and_its_position_that_of_the_joint(name: str, tmp_path: Path) -> None:
    names = ",".join(["t", *(name.format(one) for one in ("pos", "vel", "tau"))])
    (recording,) = read_named_log(write(tmp_path, names, TIME, POSITION, VELOCITY, TORQUE)).recordings
    require_same(recording)
    assert recording.motor_position is None


def test_a_numbered_motor_beside_the_angle_of_its_joint_is_the_motors(tmp_path: Path) -> None:
    path = write(tmp_path, "t,motor1_pos,joint1_pos,tau_1", TIME, 50.0 * POSITION, POSITION, TORQUE)
    require_same(read_named_log(path).recordings[0])


def test_the_position_of_a_motor_alone_is_asked_about(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="the position of a motor alone"):
        read_named_log(write(tmp_path, "t,motor_pos,motor_tau", TIME, POSITION, TORQUE))


def test_a_torque_that_comes_back_is_the_torque_and_not_the_current_beside_it(tmp_path: Path) -> None:
    path = write(tmp_path, "ts,mechPos,mechVel,torque_fdb,iqf", TIME, POSITION, VELOCITY, TORQUE, 3.0 * TORQUE)
    (recording,) = read_named_log(path).recordings
    require_same(recording)
    assert recording.metadata.torque_unit == "N·m"


def test_a_letter_that_is_said_to_be_the_torque_is_no_time(tmp_path: Path) -> None:
    path = write(tmp_path, "stamp,p,v,t", TIME, POSITION, VELOCITY, TORQUE)
    (recording,) = read_named_log(path, {"position": "p", "torque": "t"}).recordings
    require_same(recording)
    assert recording.time == pytest.approx(TIME - TIME[0], abs=1e-6)

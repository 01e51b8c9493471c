"""Objects of CiA 402, registers of servos, states by interface and rotations: read, or asked for with their worth."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping, read_recording
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.intake import Intake, read_source, select_recordings
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(9.0, 160.0, 12)
POSITION, TORQUE = np.asarray(LOG.position), np.asarray(LOG.torque)
VELOCITY = np.gradient(POSITION, LOG.time)


def _write(path: Path, names: str, *columns: np.ndarray, above: str = "") -> Path:
    with path.open("w") as file:
        file.write(above)
        np.savetxt(file, np.column_stack([LOG.time, *columns]), fmt="%.9g", delimiter=",", header=names, comments="")
    return path


@pytest.mark.parametrize("names", ["time_s,0x6064,0x606C,0x6077", "0x2000,0x6064,0x606C,0x6077", "t,6064h,606Ch,6077h"])
def test_the_mapping_proposed_for_objects_of_a_drive_needs_no_more(names: str, tmp_path: Path) -> None:
    above = "# rated torque (0x6076) = 1700 mNm\n# encoder 40000 counts/rev\n"
    counts = 40_000 / (2.0 * np.pi)
    columns = np.round(POSITION * counts), np.round(VELOCITY * counts), np.round(TORQUE / 1.7 * 1000)
    path = _write(tmp_path / "log.csv", names, *columns, above=above)
    if names[0] == "t":
        with pytest.raises(RecordingError, match=r"RATED is 1\.7 by"):
            read_recording(path)
    seen = inspect_log(path)
    assert seen.log is None
    (tmp_path / "log.toml").write_text(seen.guess)
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    np.testing.assert_allclose(found.recording.torque, TORQUE, atol=1e-3)
    np.testing.assert_allclose(np.ptp(found.recording.position), np.ptp(POSITION), atol=1e-3)


def test_a_current_is_a_part_of_the_rated_current_and_not_of_the_torque(tmp_path: Path) -> None:
    above = "# rated torque: 2 Nm\n# Motor rated current (0x6075): 5200 mA\n"
    path = _write(tmp_path / "log.csv", "t,q_rad,0x6078", POSITION, np.round(TORQUE / 0.3 / 5.2 * 1000), above=above)
    with pytest.raises(RecordingError, match=r'torque_unit = "A".*RATED is 5\.2 by'):
        read_recording(path)
    assert "scale = 0.0052" in inspect_log(path).guess


@pytest.mark.parametrize("above", ["# encoder: 14 bit\n", "# 14-bit absolute encoder\n", "# 16384 counts per rev\n"])
def test_the_bits_of_an_encoder_are_counts_of_a_turn(above: str, tmp_path: Path) -> None:
    counts = np.round(POSITION / (2.0 * np.pi) * 2**14) % 2**14
    path = _write(tmp_path / "log.csv", "t_s,enc_counts,torque_Nm", counts, TORQUE, above=above)
    with pytest.raises(RecordingError, match="COUNTS_A_TURN is 16384"):
        read_recording(path)


def test_registers_of_a_servo_are_proposed_with_their_worth(tmp_path: Path) -> None:
    counts = np.round(POSITION / (2.0 * np.pi) * 4096) + 2048, np.round(TORQUE * 400)
    path = _write(tmp_path / "log.csv", "t_s,Present_Position,Present_Current", *counts)
    with pytest.raises(RecordingError, match=r"0\.00269 where it is 2\.69 mA"):
        read_recording(path)
    guess = inspect_log(path).guess
    assert "scale = 0.00153398" in guess
    assert "scale = 0.00269" in guess


def test_a_position_in_rotations_stands_beside_a_velocity_in_them(tmp_path: Path) -> None:
    turns = 2.0 * np.pi
    path = _write(tmp_path / "log.csv", "t_s,pos_rot,vel_rps,torque_nm", POSITION / turns, VELOCITY / turns, TORQUE)
    (recording,) = read_named_log(path).recordings
    np.testing.assert_allclose(recording.position, POSITION, atol=1e-6)
    np.testing.assert_allclose(recording.channels["velocity"], VELOCITY, atol=1e-6)


def test_a_joint_may_be_called_rot(tmp_path: Path) -> None:
    path = _write(tmp_path / "log.csv", "t_s,pos_rot,vel_rot,tau_rot", POSITION, VELOCITY, TORQUE)
    (recording,) = read_named_log(path).recordings
    assert recording.metadata.joint == "rot"
    np.testing.assert_allclose(recording.position, POSITION, atol=1e-6)


@pytest.mark.parametrize("interfaces", [["position", "velocity", "effort"], ["effort", "position"]])
def test_states_by_interface_are_those_of_their_joints(interfaces: list[str], tmp_path: Path) -> None:
    mcap = pytest.importorskip("mcap.writer")
    said = {"position": POSITION, "velocity": VELOCITY, "effort": TORQUE}
    path = tmp_path / "log.mcap"
    with path.open("wb") as stream:
        writer = mcap.Writer(stream)
        writer.start()
        schema = writer.register_schema("control_msgs/DynamicJointState", "jsonschema", b'{"type": "object"}')
        channel = writer.register_channel("/dynamic_joint_states", "json", schema)
        for k, time in enumerate(np.asarray(LOG.time)):
            values = [float(said[one][k]) for one in interfaces]
            each = [{"interface_names": interfaces, "values": [s * one for one in values]} for s in (-1.0, 1.0)]
            message = {"joint_names": ["hip", "knee"], "interface_values": each}
            writer.add_message(channel, int(1e9 * (1.7e9 + time)), json.dumps(message).encode(), 0)
        writer.finish()
    found = {one.metadata.joint: one for one in read_named_log(path).recordings}
    assert sorted(found) == ["hip", "knee"]
    np.testing.assert_allclose(found["knee"].torque, TORQUE)
    np.testing.assert_allclose(found["hip"].position, -POSITION)


def test_a_joint_to_convert_need_not_be_called_as_in_the_log(tmp_path: Path) -> None:
    names = "t,q_left_knee,tau_left_knee,q_left_hip,tau_left_hip"
    path = _write(tmp_path / "log.csv", names, POSITION, TORQUE, -POSITION, -TORQUE)
    (found,) = select_recordings(read_source(path, Intake()), ["knee"])
    assert found.recording.metadata.joint == "left_knee"
    with pytest.raises(RecordingError, match="valid are left_knee, left_hip"):
        select_recordings(read_source(path, Intake()), ["left"])


def test_the_unit_in_each_cell_stands_behind_the_name_of_its_column(tmp_path: Path) -> None:
    rows = [
        f"{t:.4f},{np.degrees(q):.5f}°,{1e3 * u:.3f} mN·m" for t, q, u in zip(LOG.time, POSITION, TORQUE, strict=True)
    ]
    path = tmp_path / "log.csv"
    path.write_text("\n".join(["Time,elbow position,elbow torque", *rows, ""]))
    log = read_named_log(path)
    assert not any("nothing tells the unit" in note for note in log.notes)
    np.testing.assert_allclose(log.recordings[0].position, POSITION, atol=1e-6)
    (tmp_path / "log.toml").write_text(
        '[source]\nheader = true\ndelimiter = ","\n[channels]\ntime = { column = "Time" }\n'
        'position = { column = "elbow position" }\ntorque = { column = "elbow torque" }\n'
    )
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    np.testing.assert_allclose(found.recording.torque, TORQUE, atol=1e-5)


def test_means_are_the_joints_and_their_deviations_are_none(tmp_path: Path) -> None:
    spread = 1e-3 * np.abs(np.sin(7.0 * np.asarray(LOG.time)))
    path = _write(tmp_path / "log.csv", "t,pos_mean,pos_std,tau_mean,tau_std", POSITION, spread, TORQUE, spread)
    (recording,) = read_named_log(path).recordings
    assert recording.metadata.joint == "joint"
    np.testing.assert_allclose(recording.position, POSITION, atol=1e-6)


def test_a_folder_that_is_no_bag_is_told_as_such(tmp_path: Path) -> None:
    (tmp_path / "replay.zarr" / "data").mkdir(parents=True)
    with pytest.raises(RecordingError, match="give the log inside of it"):
        read_source(tmp_path / "replay.zarr", Intake())

"""Forms in which scopes, serial monitors, robots and data bases write a log: read as they come, or refused with why."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from fricomp.errors import RecordingError
from fricomp.recording.file import read_content
from fricomp.recording.named.log import read_named_log
from fricomp.recording.sources.cell import parse_number

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 700, 200.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 1.3 * np.sin(2.1 * TIME) + 0.2 * np.sin(7.3 * TIME + 0.4)
TORQUE = 2.7 * np.sign(np.cos(2.1 * TIME)) + 0.31 * POSITION
DEGREES = np.rad2deg(POSITION)
Write = Callable[[Path], Path]


def write(path: Path, lines: Sequence[str], encoding: str = "utf-8") -> Path:
    path.write_bytes(("\n".join(lines) + "\n").encode(encoding))
    return path


def fill(form: str, position: np.ndarray[tuple[int], np.dtype[np.float64]] = DEGREES) -> list[str]:
    return [form.format(t=t, q=q, u=u, ms=1e3 * t) for t, q, u in zip(TIME, position, TORQUE, strict=True)]


def write_duration_of_controllers(folder: Path) -> Path:
    rows = [
        f"T#{int(t)}s{round(1e3 * t) % 1000}ms;{q:.9f};{u:.9f}" for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)
    ]
    return write(folder / "trace.csv", ["; trace", "Timestamp;fActPosition [rad];fActTorque [Nm]", *rows])


def write_duration_of_matlab(folder: Path) -> Path:
    return write(folder / "log.csv", ["Time,JointAngle,MotorTorque", *fill("{t:.6g} sec,{q:.9f},{u:.9f}", POSITION)])


def write_units_in_cells(folder: Path) -> Path:
    small = fill("{ms:.3f} ms,{q:.9f}°,{u:.9f} N·m")
    small[5:9] = [line.replace(" N·m", "e3 mN·m") for line in small[5:9]]
    return write(folder / "panel.csv", ['Time,"position {joint=""elbow""}","torque {joint=""elbow""}"', *small])


def write_minutes(folder: Path) -> Path:
    rows = [
        f"{int(t + 58) // 60:02d}:{(t + 58) % 60:06.3f},{q:.9f},{u:.9f}"
        for t, q, u in zip(TIME, DEGREES, TORQUE, strict=True)
    ]
    return write(folder / "log.csv", ["Time (mm:ss.000),Angle (deg),Torque (Nm)", *rows])


def write_three_lines(folder: Path) -> Path:
    above = ["Time;Pos;Trq", "s;deg;Nm", "clock of the host;encoder;strain gauge of the drive"]
    return write(folder / "log.csv", above + fill("{t:.6f};{q:.9f};{u:.9f}"))


def write_number_name_remark_unit(folder: Path) -> Path:
    above = ["Channel\t1\t2\t3", "Name\tTime\tAngle\tTorque", "Comment\tclock\tscale\tpin", "Unit\tms\tdeg\tNm"]
    return write(folder / "log.txt", above + fill("\t{ms:.3f}\t{q:.9f}\t{u:.9f}"))


def write_data_inspector(folder: Path) -> Path:
    above = ["time,position,torque", ",Type: double,Type: double", ",Unit: deg,Unit: N*m", ",Interp: zoh,Interp: zoh"]
    return write(folder / "log.csv", above + fill("{t:.6f},{q:.9f},{u:.9f}"))


def write_scope_with_units(folder: Path) -> Path:
    above = ["Name\tScope", "", "Name\tAxis.ActPos\tName\tAxis.ActTorque", "SampleTime[ms]\t5\tSampleTime[ms]\t5"]
    above += ["Unit\t°\tUnit\tNm", "Offset\t0\tOffset\t0", ""]
    return write(folder / "scope.csv", above + fill("{ms:.3f}\t{q:.9f}\t{ms:.3f}\t{u:.9f}"))


def write_scope_of_named_units(folder: Path) -> Path:
    names = "Name\tAxis.ActPos (deg)\tName\tAxis.ActTorque [Nm]\tName\tAxis.SetPos [deg]"
    above = [names, "SampleTime[ms]\t5\tSampleTime[ms]\t5\tSampleTime[ms]\t5", ""]
    return write(folder / "scope.csv", above + fill("{ms:.3f}\t{q:.9f}\t{ms:.3f}\t{u:.9f}\t{ms:.3f}\t{q:.9f}"))


def write_cyrillic(folder: Path) -> Path:
    above = ["Время, мс;Угол, град;Момент, Н·м"]
    rows = [row.replace(".", ",") for row in fill("{ms:.3f};{q:.9f};{u:.9f}")]
    return write(folder / "log.csv", above + rows, "cp1251")


def write_chinese(folder: Path) -> Path:
    return write(folder / "log.csv", ["时间(ms),位置(°),力矩(Nm)", *fill("{ms:.3f},{q:.9f},{u:.9f}")], "gbk")


def write_traditional(folder: Path) -> Path:
    return write(folder / "log.csv", ["時間[s],角度[deg],轉矩[Nm]", *fill("{t:.6f},{q:.9f},{u:.9f}")], "big5")


def write_korean(folder: Path) -> Path:
    return write(folder / "log.csv", ["시간(s),각도(deg),토크(Nm)", *fill("{t:.6f},{q:.9f},{u:.9f}")], "cp949")


def write_symbols(folder: Path) -> Path:
    rows = [row.replace("-", "\u2212") for row in fill("{t:.6f},{q:.9f},{u:.9f}", POSITION)]
    return write(folder / "log.csv", ["t / s,φ / rad,τ / (N m)", *rows])


def write_index(folder: Path) -> Path:
    return write(folder / "log.csv", [",measured.position,measured.torque", *fill("{t:.6f},{q:.9f},{u:.9f}", POSITION)])


def write_serial_monitor(folder: Path) -> Path:
    rows = [f"10:00:{t:06.3f} -> {1e6 * t:.0f},{q:.9f},{u:.9f}" for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)]
    return write(folder / "monitor.txt", ["10:00:00.000 -> boot", "10:00:00.000 -> micros,angle_rad,torque_Nm", *rows])


def write_messages(folder: Path) -> Path:
    lines = []
    for t, q, u in zip(TIME, POSITION, TORQUE, strict=True):
        stamp = ["header:", "  stamp:", f"    sec: {1_700_000_000 + int(t)}", f"    nanosec: {round(t % 1 * 1e9)}"]
        lines += [*stamp, "  frame_id: ''", "name:", "- elbow", "position:", f"- {q:.9f}", "velocity: []", "effort:"]
        lines += [f"- {u:.9f}", "---"]
    return write(folder / "joint_states.yaml", lines)


def write_metrics(folder: Path) -> Path:
    lines = []
    for name, values in (("joint_position_radians", POSITION), ("joint_torque_newton_meters", TORQUE)):
        lines += [f"# HELP {name} of it", f"# TYPE {name} gauge"]
        samples = zip(values, TIME, strict=True)
        lines += [f'{name}{{joint="elbow"}} {value:.9f} {1_700_000_000_000 + 1e3 * t:.0f}' for value, t in samples]
    return write(folder / "metrics.prom", lines)


def write_registers(folder: Path) -> Path:
    rows = [
        json.dumps({"timestamp": t, "values": {"MODE": 10, "POSITION": q, "VELOCITY": 0.0, "TORQUE": u, "FAULT": 0}})
        for t, q, u in zip(TIME, POSITION / (2.0 * np.pi), TORQUE, strict=True)
    ]
    return write(folder / "moteus.jsonl", rows)


def write_odrive(folder: Path) -> Path:
    names = "time,axis0.pos_estimate,axis0.motor.torque_estimate,axis0.controller.input_pos,axis0.motor.foc.Iq_measured"
    return write(
        folder / "odrive.csv", [names, *fill("{t:.6f},{q:.9f},{u:.9f},0.25,{u:.6f}", POSITION / (2.0 * np.pi))]
    )


def write_odrive_alone(folder: Path) -> Path:
    rows = fill("{t:.6f},{q:.9f},0.0,{u:.9f}", POSITION / (2.0 * np.pi))
    return write(folder / "odrive.csv", ["time,pos_estimate,vel_estimate,Iq_measured", *rows])


def write_control_desk(folder: Path) -> Path:
    signals = [
        {"Name": '"Model Root"/Joint/phi', "Data": DEGREES, "Unit": "deg"},
        {"Name": '"Model Root"/Drive/M_ist [Nm]', "Data": TORQUE, "Unit": ""},
    ]
    capture = {"X": {"Name": "", "Data": TIME, "Unit": "s"}, "Y": np.array(signals, dtype=object)}
    savemat(folder / "rec1_001.mat", {"rec1_001": capture})
    return folder / "rec1_001.mat"


FORMS: list[Write] = [
    *(write_duration_of_controllers, write_duration_of_matlab, write_units_in_cells, write_minutes, write_three_lines),
    *(
        write_number_name_remark_unit,
        write_data_inspector,
        write_scope_with_units,
        write_scope_of_named_units,
        write_cyrillic,
        write_chinese,
    ),
    *(write_traditional, write_korean, write_symbols, write_index, write_serial_monitor, write_messages, write_metrics),
    *(write_registers, write_odrive, write_odrive_alone, write_control_desk),
]


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-5)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize("form", [one for one in FORMS if one is not write_metrics])
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    recording = convert_by_proposal(form(tmp_path), tmp_path)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize(
    ("cell", "value"),
    [
        ("12 345,5", 12345.5), ("12\u202f345,5", 12345.5), ("-1'234'567.25", -1234567.25), ("\u22120,5", -0.5),
        ("1.25D-03", 1.25e-3), ("62:03,5", 3723.5), ("26:00:01", 93601.0), ("10:11:12:345", 36672.345),
        ("LTIME#1m2s3ms4us", 62.003004),
    ],
)  # fmt: skip
def test_numbers_are_read_as_programs_write_them(cell: str, value: float) -> None:
    assert parse_number(cell, ",") == pytest.approx(value)


@pytest.mark.parametrize("cell", ["12 34", "1'2", "10:11", "T#", "1d", "12 3456"])
def test_what_could_be_anything_else_is_no_number(cell: str) -> None:
    with pytest.raises(ValueError, match=r"."):
        parse_number(cell, ",")


def test_a_quantity_of_which_the_large_numbers_are_not_read_is_refused(tmp_path: Path) -> None:
    rows = [
        f"{t:.3f};{q:.3f};{u:.3f}{'_' if abs(u) > 2.5 else ''}" for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)
    ]
    with pytest.raises(RecordingError, match=r"cells of 'tau' are not read as numbers, such as '-?2\.\d+_'"):
        read_content(write(tmp_path / "log.csv", ["t;q;tau", *rows]))


@pytest.mark.parametrize("row", ["(17{t:.6f})  can0  181   [4]  10 A2 F1 0B", "(17{t:.6f}) vcan1 181#10A2F10B"])
def test_bare_frames_of_a_bus_are_refused_with_what_decodes_them(row: str, tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"bare frames of a CAN bus.* cantools decode"):
        read_content(write(tmp_path / "candump.log", fill(row)))


def test_a_velocity_in_an_unknown_unit_is_left_out_and_told(tmp_path: Path) -> None:
    rows = [f"{row},{k}" for k, row in enumerate(fill("{t:.6f},{q:.9f},{u:.9f}"))]
    content = read_content(write(tmp_path / "log.csv", ["t,angle[deg],torque[Nm],speed[ERPM]", *rows]))
    assert content.recording.velocity is None
    assert any("'speed[ERPM]' was left out" in one.message for one in content.findings)


def test_the_state_of_a_motor_is_that_of_its_joint(tmp_path: Path) -> None:
    names = "timestamp,motor_state[0].q,motor_state[0].tau_est,motor_state[1].q,motor_state[1].tau_est"
    path = write(tmp_path / "log.csv", [names, *fill("{t:.6f},0.3,0.1,{q:.9f},{u:.9f}", POSITION)])
    assert [one.metadata.joint for one in read_named_log(path).recordings] == ["motor_0", "motor_1"]


def test_a_column_that_is_chosen_keeps_the_unit_in_its_name(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", ["Time (ms),PL.FB (deg),XY.Z (Arms)", *fill("{ms:.3f},{q:.9f},{u:.9f}")])
    with pytest.raises(RecordingError, match=r"--channel 'torque=XY\.Z \(Arms\)' where it is that one"):
        read_content(path)
    assert read_content(path, channels={"torque": "XY.Z (Arms)"}).recording.metadata.torque_unit == "A"


@pytest.mark.parametrize(("name", "period"), [("dt", 0.005), ("Ts_ms", 5.0), ("sim.sample_time", 0.005)])
def test_a_single_period_beside_columns_without_a_time_is_that_of_their_rows(
    name: str, period: float, tmp_path: Path
) -> None:
    arrays: dict[str, Any] = {"qpos": POSITION[:, None], "actuator_force": TORQUE[:, None], name: period}
    np.savez(tmp_path / "log.npz", **arrays)
    found = read_content(tmp_path / "log.npz").recording
    assert found.sample_period == pytest.approx(1.0 / RATE)
    np.testing.assert_allclose(found.torque, TORQUE)


def test_steps_of_time_beyond_all_numbers_are_refused(tmp_path: Path) -> None:
    steps = np.full(POSITION.size, 1e308)
    np.savez(tmp_path / "log.npz", dt=steps, q=POSITION, tau=TORQUE)
    with pytest.raises(RecordingError):
        read_content(tmp_path / "log.npz")


@pytest.mark.parametrize("name", ["Kt", "log.Kt_NmA", "motor.torque_constant"])
def test_a_current_beside_its_torque_constant_is_taken_and_what_makes_a_torque_of_it_is_told(
    name: str, tmp_path: Path
) -> None:
    path = tmp_path / "log.mat"
    content: dict[str, Any] = {"log": {"t": TIME, "q": POSITION, "i_A": TORQUE}}
    *above, last = name.split(".")
    content.setdefault(above[0] if above else last, {} if above else 0.12)
    if above:
        content[above[0]][last] = 0.12
    savemat(path, content)
    found = read_content(path)
    assert found.recording.metadata.torque_unit == "A"
    (said,) = (one.message for one in found.findings if "torque constant" in one.message)
    assert f"{name!r} = 0.12" in said
    assert 'torque = { column = "log.i_A", scale = 0.12 } and torque_unit = "N·m"' in said


@pytest.mark.parametrize(
    "above",
    [["my run", "# t q tau"], ["# time position torque", "a b c"], ["# date: position torque", "t q tau"]],
)
def test_the_line_with_the_most_known_words_names_the_columns(above: list[str], tmp_path: Path) -> None:
    recording = read_content(write(tmp_path / "log.txt", above + fill("{t:.6f} {q:.9f} {u:.9f}", POSITION))).recording
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


def test_what_was_decoded_of_a_frame_may_stand_below_it(tmp_path: Path) -> None:
    frame = " (17{t:.6f})  can0  141   [8]  92 1A 00 00 FF 10 0A 2B ::\nMotor_State(\n"
    row = frame + "    Position: {q:.6f} deg,\n    Torque: {u:.6f} Nm,\n    Temp: 31 degC\n)"
    recording = read_content(write(tmp_path / "decoded.txt", fill(row))).recording
    np.testing.assert_allclose(recording.position, POSITION, atol=1e-6)
    np.testing.assert_allclose(recording.torque, TORQUE, atol=1e-6)
    np.testing.assert_allclose(np.diff(recording.time), 1.0 / RATE, atol=1e-5)


def test_the_unit_behind_a_time_is_its_own_where_several_rows_share_a_stamp(tmp_path: Path) -> None:
    fast = [f"t={k // 2}ms pos={q:.6f}deg cur={u:.6f}A" for k, (q, u) in enumerate(zip(DEGREES, TORQUE, strict=True))]
    content = read_content(write(tmp_path / "serial.log", fast))
    assert content.recording.duration == pytest.approx(0.5e-3 * N_ROWS, rel=0.01)


@pytest.mark.parametrize(
    ("names", "taken"),
    [
        ("t,q,tau,temp_c", True),
        ("t,q,tau,Motortemperatur [°C]", True),
        ("t,q,tau,ambient_temp", False),
        ("t,q,tau,temp_mos,temp_motor", True),
        ("t,q,tau,temp_a,temp_b", False),
    ],
)
def test_the_temperature_of_a_log_of_one_joint_is_its_motors(names: str, taken: bool, tmp_path: Path) -> None:
    more = [f"{40 + k},{20 + 0.01 * k}" if names.count(",") == 4 else f"{20 + 0.01 * k}" for k in range(N_ROWS)]
    rows = [f"{row},{own}" for row, own in zip(fill("{t:.6f},{q:.9f},{u:.9f}", POSITION), more, strict=True)]
    recording = read_content(write(tmp_path / "log.csv", [names, *rows])).recording
    assert (recording.temperature is not None) == taken
    if recording.temperature is not None:
        assert recording.temperature[100] == pytest.approx(21.0)

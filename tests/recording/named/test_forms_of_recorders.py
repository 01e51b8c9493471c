"""Logs of recorders and serial monitors: names before numbers, offsets of scopes, controls beside states, frames."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.log import NamedLog, read_named_log
from fricomp.recording.named.source import read_unnamed_columns
from fricomp.recording.sources.printed.plain_table import as_table

from .proposed_mapping import convert_by_proposal

TIME = np.arange(900) / 300.0
POSITION = 1.1 * np.sin(2.7 * TIME) + 0.2 * np.sin(7.1 * TIME)
TORQUE = 0.4 * np.sign(np.cos(2.7 * TIME)) + 0.7 * POSITION


def write(path: Path, form: str, *above: str) -> Path:
    rows = [form.format(t=t, q=q, u=u, k=k) for k, (t, q, u) in enumerate(zip(TIME, POSITION, TORQUE, strict=True))]
    path.write_text("\n".join([*above, *rows]) + "\n", encoding="utf-8")
    return path


def read(path: Path) -> NamedLog:
    log = read_named_log(path)
    assert log.recordings[0].position == pytest.approx(POSITION, abs=1e-6)
    assert log.recordings[0].torque == pytest.approx(TORQUE, abs=1e-6)
    return log


@pytest.mark.parametrize(
    "form",
    [
        "{t:.6f} s | pos {q:.9f} rad | torque {u:.9f} Nm",
        "T {t:.6f} POS {q:.9f} TRQ {u:.9f}",
        "[{t:.6f}] pos {q:.9f} rad, torque {u:.9f} Nm",
        "time {t:.6f} s; position {q:.9f} rad; effort {u:.9f}",
    ],
)
def test_names_with_a_space_before_their_numbers_are_the_names(form: str, tmp_path: Path) -> None:
    log = read(write(tmp_path / "monitor.txt", form, "motor on"))
    assert log.recordings[0].time - log.recordings[0].time[0] == pytest.approx(TIME, abs=1e-5)


def test_a_unit_behind_a_number_is_that_of_its_name(tmp_path: Path) -> None:
    path = write(tmp_path / "monitor.txt", "{t:.6f} s | pos {q:.9f} deg | torque {u:.9f} mNm")
    (recording,) = read_named_log(path).recordings
    assert recording.position == pytest.approx(np.radians(POSITION), abs=1e-7)
    assert recording.torque == pytest.approx(1e-3 * TORQUE, abs=1e-7)


@pytest.mark.parametrize("lines", [["1.0 2.0 3.0"] * 9, ["t;q;tau", *["1;2;3"] * 9], ["axis 1 of 6 ready"] * 9])
def test_lines_that_do_not_consist_of_names_and_numbers_are_left_as_they_are(lines: list[str]) -> None:
    assert as_table(lines) == lines


@pytest.mark.parametrize("number", ["0.5", "0"])
def test_an_offset_above_the_rows_is_told_and_not_added(number: str, tmp_path: Path) -> None:
    above = ("Name;ActPos;ActTorque", "Unit;rad;Nm", f"Offset;0;{number}", "Time [s];ActPos;ActTorque")
    notes = " ".join(read(write(tmp_path / "trace.csv", "{t:.6f};{q:.9f};{u:.9f}", *above)).notes)
    assert ("'Offset;0;0.5' above the rows was not added to the numbers" in notes) is (number != "0")


@pytest.mark.parametrize(("state", "control"), [("servo_stats", "servo_control"), ("state", "control")])
def test_what_a_controller_asks_for_is_no_joint_of_its_own(state: str, control: str, tmp_path: Path) -> None:
    names = f"timestamp,{state}.position_deg,{state}.torque,{control}.position,{control}.torque"
    path = tmp_path / "log.csv"
    angle = np.degrees(POSITION)
    rows = [f"{t:.6f},{q:.9f},{u:.9f},{q + 0.1:.9f},0" for t, q, u in zip(TIME, angle, TORQUE, strict=True)]
    path.write_text("\n".join([names, *rows]) + "\n", encoding="utf-8")
    (recording,) = read(path).recordings
    assert recording.position_reference == pytest.approx(np.radians(angle + 0.1), abs=1e-8)  # in its unit, unsaid


def test_a_joint_that_is_called_control_alone_is_a_joint(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "{t:.6f},{q:.9f},{u:.9f}", "time,control.position,control.torque")
    assert read(path).recordings[0].metadata.joint == "control"


@pytest.mark.parametrize("name", ["ns", "nanos", "us", "ms"])
def test_a_unit_of_time_alone_is_the_name_of_the_time(name: str, tmp_path: Path) -> None:
    step = {"ns": 1e-9, "nanos": 1e-9, "us": 1e-6, "ms": 1e-3}[name]
    path = tmp_path / "log.csv"
    rows = [f"{t / step:.6f},{q:.9f},{u:.9f}" for t, q, u in zip(TIME, POSITION, TORQUE, strict=True)]
    path.write_text("\n".join([f"{name},position,torque", *rows]) + "\n", encoding="utf-8")
    assert read(path).recordings[0].time == pytest.approx(TIME, abs=1e-6)


@pytest.mark.parametrize(
    ("name", "lines"),
    [
        ("trace.asc", ["   {t:.6f} 1  181             Rx   d 8 00 00 E5 FF 03 00 00 00"]),
        ("trace.blf", ["LOGG {k}"]),
        ("trace.trc", ["{k}) {t:.3f} Rx 0181 8 00 00 E5 FF 03 00 00 00"]),
    ],
)
def test_frames_that_no_decoder_reads_are_written_as_lines_first(name: str, lines: list[str], tmp_path: Path) -> None:
    path = write(tmp_path / name, lines[0], "date Thu Mar 14 13:19:50.250 2024", "base hex  timestamps absolute")
    with pytest.raises(RecordingError, match=rf"can\.logconvert {name} trace\.candump\.log'.*< trace\.candump\.log >"):
        read_content(path)


def test_lines_that_say_their_direction_are_frames_too(tmp_path: Path) -> None:
    path = write(tmp_path / "can.log", "({t:.6f}) can0 181#0000000001000000 R")
    with pytest.raises(RecordingError, match=r"bare frames of a CAN bus.*< can\.log >"):
        read_content(path)


@pytest.mark.parametrize("motor", ["motor_", ""])
def test_the_torque_constant_goes_with_the_gear_in_the_proposed_mapping(motor: str, tmp_path: Path) -> None:
    above = ("# gear ratio: 50", "# Kt = 0.09 Nm/A", f"time [s],{motor}position [rad],{motor}current [mA]")
    path = write(tmp_path / "log.csv", "{t:.6f},{q:.9f},{u:.9f}", *above)
    seen = inspect_log(path)
    proposed = seen.guess or render_mapping(path, seen.log) if seen.log is not None else seen.guess
    line = next(one for one in proposed.splitlines() if one.startswith("# torque"))
    assert "scale = 0.0045 }" in line
    assert "by 'Kt = 0.09 Nm/A' and 'gear ratio: 50'; 9e-05 without a gear" in line
    mapping = tmp_path / "log.toml"
    kept = (line.removeprefix("# ") if one.startswith("torque = ") else one for one in proposed.splitlines())
    mapping.write_text("\n".join(kept).replace('torque_unit = "A"', 'torque_unit = "N·m"'), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.torque == pytest.approx(0.0045 * TORQUE, abs=1e-9)
    assert found.recording.metadata.torque_unit == "N·m"


def test_steps_of_a_unit_and_counts_of_a_motor_stand_in_the_proposed_mapping(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    counts, current = np.round(4096 * POSITION / (2.0 * np.pi)), np.round(100.0 * TORQUE)
    rows = [f"{1e3 * t:.6f},{a:.0f},{b:.0f}" for t, a, b in zip(TIME, counts, current, strict=True)]
    path.write_text("\n".join(["Time (ms),Motor Position (counts),Current (0.01 A)", *rows]) + "\n", encoding="utf-8")
    guess = inspect_log(path).guess
    assert "scale = 6.2832/(COUNTS_A_TURN*RATIO) }" in guess
    assert 'torque = { column = "Current (0.01 A)", scale = 0.01 }' in guess
    mapping = tmp_path / "log.toml"
    mapping.write_text(guess.replace("6.2832/(COUNTS_A_TURN*RATIO)", f"{2.0 * np.pi / 4096:.9g}"), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.torque == pytest.approx(TORQUE, abs=6e-3)
    assert found.recording.position == pytest.approx(POSITION, abs=1e-3)


@pytest.mark.parametrize(("names", "offered"), [("Torque [‰];Current [mA]", True), ("Torque [‰];Status", False)])
def test_a_current_is_offered_for_a_torque_whose_rating_may_not_be_known(
    names: str, offered: bool, tmp_path: Path
) -> None:
    path = write(tmp_path / "log.csv", "{t:.6f};{q:.9f};{u:.9f};{u:.9f}", f"Time [s];Angle [rad];{names}")
    with pytest.raises(RecordingError) as refused:
        read_content(path)
    assert ("--channel 'torque=Current [mA]'" in str(refused.value)) is offered
    if offered:
        (recording,) = read_named_log(path, {"torque": "Current [mA]"}).recordings
        assert recording.metadata.torque_unit == "A"
        assert recording.torque == pytest.approx(1e-3 * TORQUE, abs=1e-8)


def test_a_rating_is_no_rate(tmp_path: Path) -> None:
    above = ("Sampling Period;2;ms", "Time [s];Angle [rad];Torque [%]")
    path = write(tmp_path / "log.csv", "{t:.6f};{q:.9f};{u:.9f}", *above)
    with pytest.raises(RecordingError, match="rated torque") as refused:
        read_content(path)
    assert "in this file" not in str(refused.value)


def test_registers_behind_the_number_of_their_servo_are_filled_in(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    counts, current = np.round(4096 * POSITION / (2.0 * np.pi)), np.round(TORQUE / 0.00269)
    rows = [f"{1e3 * t:.6f},{a:.0f},{b:.0f}" for t, a, b in zip(TIME, counts, current, strict=True)]
    path.write_text("\n".join(["Time(ms),[ID:001]Present Position,[ID:001]Present Current", *rows]) + "\n")
    mapping = tmp_path / "log.toml"
    mapping.write_text(inspect_log(path).guess, encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.position == pytest.approx(POSITION, abs=1e-3)
    assert found.recording.torque == pytest.approx(TORQUE, abs=2e-3)


@pytest.mark.parametrize(("asked", "factor"), [("pos_cmd", np.degrees(1.0)), ("pos_cmd", 1.0), ("pos_cmd_rad", 1.0)])
def test_a_reference_is_in_the_unit_in_which_it_is_followed(asked: str, factor: float, tmp_path: Path) -> None:
    path, reference = tmp_path / "log.csv", 1.02 * POSITION + 0.01
    rows = [
        f"{t:.6f},{np.degrees(q):.9f},{factor * r:.9f},{u:.9f}"
        for t, q, r, u in zip(TIME, POSITION, reference, TORQUE, strict=True)
    ]
    path.write_text("\n".join([f"t,pos_deg,{asked},torque", *rows]) + "\n", encoding="utf-8")
    log = read(path)
    assert log.recordings[0].position_reference == pytest.approx(reference, abs=1e-6)
    assert any("'pos_cmd' was taken to be in deg, by 'pos_deg'" in note for note in log.notes) is bool(factor > 1.0)


@pytest.mark.parametrize("names", ["Phase U current [A],Iq current [A]", "phase_current_a,motor_current"])
def test_the_current_of_a_phase_comes_behind_that_of_the_motor(names: str, tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    turning = TORQUE * np.sin(7.0 * POSITION)
    rows = [f"{t:.6f},{q:.9f},{i:.9f},{u:.9f}" for t, q, i, u in zip(TIME, POSITION, turning, TORQUE, strict=True)]
    path.write_text("\n".join([f"time,angle_rad,{names}", *rows]) + "\n", encoding="utf-8")
    assert read(path).recordings[0].metadata.torque_unit == "A"


def test_currents_of_which_each_may_make_the_torque_are_asked_about(tmp_path: Path) -> None:
    form, names = "{t:.6f},{q:.9f},{u:.9f},{q:.9f}", "time,angle_rad,left current,right current"
    with pytest.raises(RecordingError, match="could each be the current: choose by --channel torque=NAME"):
        read_named_log(write(tmp_path / "log.csv", form, names))


@pytest.mark.parametrize(
    "form",
    [
        "motor-1  | 2026-03-14T10:00:{t:09.6f}Z INFO state pos=[{q:.9f}] eff=[{u:.9f}]",
        "node-7 WARN 2026-03-14 10:00:{t:09.6f}, state pos: {q:.9f} effort: {u:.9f}",
    ],
)
def test_a_date_behind_the_name_of_a_program_is_the_time_of_its_line(form: str, tmp_path: Path) -> None:
    log = read(write(tmp_path / "out.log", form))
    assert log.recordings[0].time - log.recordings[0].time[0] == pytest.approx(TIME, abs=1e-5)


def test_a_list_behind_a_label_has_an_entry_a_joint(tmp_path: Path) -> None:
    form = "State(t={t:.6f}, q=[0.1, {q:.9f}], dq=[], tau=array([-1.5e-1, {u:.9f}]))"
    log = read_named_log(write(tmp_path / "out.txt", form))
    found = {one.metadata.joint: one for one in log.recordings}
    assert found["joint_2"].position == pytest.approx(POSITION, abs=1e-8)
    assert found["joint_2"].torque == pytest.approx(TORQUE, abs=1e-8)


@pytest.mark.parametrize("names", [("   time [s]   q [rad] tau [Nm]",), ()])
def test_numbers_of_fixed_places_may_touch(names: tuple[str, ...], tmp_path: Path) -> None:
    path = write(tmp_path / "log.dat", "{t:10.4f}{q:11.8f}{u:11.8f}", *names)
    assert re.search(r"\d-\d", path.read_text().replace("e-", ""))
    if names:
        assert read(path).recordings[0].position.size == TIME.size
        return
    columns = read_unnamed_columns(path)
    assert columns["2"] == pytest.approx(POSITION, abs=1e-8)
    assert columns["3"] == pytest.approx(TORQUE, abs=1e-8)


@pytest.mark.parametrize(("factor", "unit"), [(30.0 / np.pi, "rpm"), (180.0 / np.pi, "deg/s"), (1.0, "")])
def test_a_velocity_asked_for_is_read_by_the_rate_of_the_position(factor: float, unit: str, tmp_path: Path) -> None:
    path, wanted = tmp_path / "log.csv", np.gradient(POSITION, TIME) + 0.02
    rows = [
        f"{t:.6f},{q:.9f},{factor * w:.9f},{u:.9f}" for t, q, w, u in zip(TIME, POSITION, wanted, TORQUE, strict=True)
    ]
    path.write_text("\n".join(["t,q_rad,speed_cmd,torque", *rows]) + "\n", encoding="utf-8")
    log = read(path)
    assert log.recordings[0].velocity_reference == pytest.approx(wanted, abs=1e-6)
    assert any(f"'speed_cmd' was taken to be in {unit}, by 'q_rad'" in note for note in log.notes) is bool(unit)


@pytest.mark.parametrize("names", ["motor angle [rad],current [‰]", "motor position [counts],motor current [%]"])
def test_a_current_in_parts_of_its_rating_beside_a_constant_is_asked_about(names: str, tmp_path: Path) -> None:
    above = ("# gear ratio: 50", "# Kt = 0.05 Nm/A", f"time [s],{names}")
    path = tmp_path / "log.csv"
    counts, parts = np.round(1e4 * POSITION), np.round(1e3 * TORQUE)
    rows = [f"{t:.6f},{a:.0f},{b:.0f}" for t, a, b in zip(TIME, counts, parts, strict=True)]
    path.write_text("\n".join([*above, *rows]) + "\n", encoding="utf-8")
    assert "scale = RATED/" in inspect_log(path).guess


def test_a_proposed_mapping_leaves_out_the_rows_that_the_reading_leaves_out(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "{t:.6f},{q:.9f},{u:.9f}", "time,position_rad,torque_Nm")
    lines = path.read_text(encoding="utf-8").splitlines()
    lines[40:43] = [line.rpartition(",")[0] + ",NaN" for line in lines[40:43]]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert len(convert_by_proposal(path, tmp_path)) == TIME.size - 3


def test_a_proposed_mapping_of_names_that_no_line_has_is_followed(tmp_path: Path) -> None:
    names = "%time,field.header.seq,field.name0,field.position0,field.effort0"
    form = "1710460790{k:03d}000000,{k},elbow,{q:.9f},{u:.9f}"
    path = write(tmp_path / "echo.csv", form, names)
    recording = convert_by_proposal(path, tmp_path)
    assert recording.metadata.joint == "elbow"
    assert recording.position == pytest.approx(POSITION, abs=1e-8)

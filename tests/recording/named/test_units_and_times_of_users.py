"""Logs of users whose units, times or names had been taken for others, or for none."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest

from fricomp.api.identify import IdentifySettings, identify_source
from fricomp.errors import RecordingError
from fricomp.recording import Recording, convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(12.0, 125.0, 43)
TIME, POSITION, TORQUE = (np.asarray(one) for one in (LOG.time, LOG.position, LOG.torque))
assert LOG.velocity is not None
VELOCITY = np.asarray(LOG.velocity)
DEGREES, RPM = np.rad2deg(POSITION), VELOCITY * 30.0 / np.pi
NEAR_MIDNIGHT = [datetime(2026, 3, 10, 23, 59, 55) + timedelta(seconds=float(one)) for one in TIME]
CLOCK = [f"{one:%H:%M:%S}.{one.microsecond:06d}" for one in NEAR_MIDNIGHT]
Write = Callable[[Path], Path]


def write(path: Path, head: str, *columns: np.ndarray | list[str], mark: str = ",", encoding: str = "utf-8") -> Path:
    cells = [[one if isinstance(one, str) else f"{one:.9g}" for one in column] for column in columns]
    rows = [mark.join(row) for row in zip(*cells, strict=True)]
    path.write_text("\n".join([head, *rows] if head else rows) + "\n", encoding=encoding)
    return path


def write_japanese(folder: Path) -> Path:
    head = "時間[ms],位置[deg],速度[r/min],トルク[N・m]"
    return write(folder / "log.csv", head, 1e3 * TIME, DEGREES, RPM, TORQUE, encoding="cp932")


def write_wide_letters(folder: Path) -> Path:
    return write(folder / "log.csv", "时间（毫秒）,位置（度）,力矩（Ｎ・ｍ）", 1e3 * TIME, DEGREES, TORQUE)


def write_italian(folder: Path) -> Path:
    head = "Tempo [s];Posizione [gradi];Velocità [giri/min];Coppia [daN·m]"
    return write(folder / "log.csv", head, TIME, DEGREES, RPM, TORQUE / 10.0, mark=";")


def write_parts_of_a_day(folder: Path) -> Path:
    days = [f"{(36000.0 + one) / 86400.0:.13f}" for one in TIME]
    return write(folder / "log.csv", "Zeit;Winkel [°];Drehmoment [Nm]", days, DEGREES, TORQUE, mark=";")


def write_halves_of_a_day(folder: Path) -> Path:
    days = [f"{one:%m/%d/%Y}" for one in NEAR_MIDNIGHT]
    clock = [f"{one:%I:%M:%S}.{one.microsecond:06d} {one:%p}" for one in NEAR_MIDNIGHT]
    return write(folder / "log.csv", "Date,Time,Position (rad),Torque (N-m)", days, clock, POSITION, TORQUE)


def write_phone(folder: Path) -> Path:
    rows = [
        f"03-10 {clock}  1234  1250 I JointCtl: pos={q:.9f} trq={u:.9f}"
        for clock, q, u in zip(CLOCK, POSITION, TORQUE, strict=True)
    ]
    return write(folder / "log.txt", "", rows)


def write_journal(folder: Path) -> Path:
    rows = [
        f"Mar 10 {clock} robot jointd[812]: pos={q:.9f} tau={u:.9f}"
        for clock, q, u in zip(CLOCK, POSITION, TORQUE, strict=True)
    ]
    return write(folder / "log.log", "", rows)


def write_monitor(folder: Path) -> Path:
    rows = [
        f"{clock} -> angle:{q:.9f}\ttau:{u:.9f}\ttarget:0" for clock, q, u in zip(CLOCK, POSITION, TORQUE, strict=True)
    ]
    return write(folder / "log.txt", "", rows)


def write_nodes(folder: Path) -> Path:
    head = "Timestamp;ns=3;s=Axis1.ActualPosition_deg;ns=3;s=Axis1.ActualTorque_Nm"
    return write(folder / "log.csv", head, [f"{one.isoformat()}Z" for one in NEAR_MIDNIGHT], DEGREES, TORQUE, mark=";")


def write_tdms_names(folder: Path) -> Path:
    head = ",/'Untitled'/'Time',/'Untitled'/'Angle (deg)',/'Untitled'/'Torque (Nm)'"
    return write(folder / "log.csv", head, np.arange(TIME.size), TIME, DEGREES, TORQUE)


def write_enumeration(folder: Path) -> Path:
    turns = 2.0 * np.pi
    rows = [
        f"{t:.6f} {{<Register.MODE: 0>: 10, <Register.POSITION: 1>: {q / turns:.9f}, <Register.VELOCITY: 2>: "
        f"{v / turns:.9f}, <Register.TORQUE: 3>: {u:.9f}, <Register.FAULT: 15>: 0}}"
        for t, q, v, u in zip(TIME, POSITION, VELOCITY, TORQUE, strict=True)
    ]
    return write(folder / "log.txt", "", rows)


def write_recorder(folder: Path) -> Path:
    parts = np.round(1e9 * (TIME % 1.0))
    head = "ZeitInSek,ZeitInNanoSek,axisQMsr_arm[2],axisTauMsr_arm[2]"
    return write(folder / "log.csv", head, np.floor(TIME), [f"{one:.0f}" for one in parts], POSITION, TORQUE)


def write_rate_beside_columns(folder: Path) -> Path:
    facts = {"rate_hz": 125, "units": {"position": "deg", "torque": "Nm"}}
    data = {"position": DEGREES.tolist(), "torque": TORQUE.tolist()}
    (folder / "log.json").write_text(json.dumps({"meta": facts, "data": data}))
    return folder / "log.json"


def write_curves(folder: Path) -> Path:
    curves = [
        {"name": name, "x": TIME.tolist(), "y": values.tolist(), "type": "scatter"}
        for name, values in (("position (rad)", POSITION), ("torque (Nm)", TORQUE))
    ]
    (folder / "log.json").write_text(json.dumps({"data": curves, "layout": {}}))
    return folder / "log.json"


FORMS: list[Write] = [
    write_japanese, write_wide_letters, write_italian, write_parts_of_a_day, write_halves_of_a_day, write_phone,
    write_journal, write_monitor, write_nodes, write_tdms_names, write_enumeration, write_recorder,
    write_rate_beside_columns, write_curves,
]  # fmt: skip


def require_same(recording: Recording) -> None:
    assert len(recording) == TIME.size
    assert recording.time - recording.time[0] == pytest.approx(TIME - TIME[0], abs=2e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)
    assert recording.metadata.torque_unit == "N·m"


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    require_same(read_content(form(tmp_path)).recording)


@pytest.mark.parametrize("form", [write_nodes, write_tdms_names, write_italian, write_rate_beside_columns])
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    path, mapping = form(tmp_path), tmp_path / "log.toml"
    seen = inspect_log(path)
    assert seen.log is not None
    mapping.write_text(render_mapping(path, seen.log), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    require_same(found.recording)


def test_a_time_that_is_in_no_seconds_is_asked_about(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "time,q,tau", [f"{one / 3.6e6:.15f}" for one in TIME], POSITION, TORQUE)
    with pytest.raises(RecordingError, match=r'million rows a second: write time = .* unit = "h"'):
        read_named_log(path)


@pytest.mark.parametrize(
    ("name", "first", "unit"),
    [("time", 1.773e9, 1.0), ("stamp_ms", 1.773e12, 1e3), ("filetime [100 ns]", (1.773e9 + 11_644_473_600) * 1e7, 1e7)],
)
def test_a_recording_knows_when_it_was_taken_where_its_stamps_are_dates(
    name: str, first: float, unit: float, tmp_path: Path
) -> None:
    stamps = [f"{first + unit * one:.3f}" for one in TIME]
    path = write(tmp_path / "log.csv", f"{name},q,tau", stamps, POSITION, TORQUE)
    (recording,) = read_named_log(path).recordings
    assert recording.metadata.recorded == "2026-03-08T20:00:00.000+00:00"
    result = identify_source(recording, IdentifySettings()).result
    assert result.model.provenance.notes["recorded"] == recording.metadata.recorded
    since_start = write(tmp_path / "other.csv", "time,q,tau", TIME, POSITION, TORQUE)
    assert read_named_log(since_start).recordings[0].metadata.recorded == ""


def test_a_mapping_keeps_the_date_as_well(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "a,b,c", [f"{1.773e12 + 1e3 * one:.3f}" for one in TIME], POSITION, TORQUE)
    mapping = tmp_path / "log.toml"
    rules = ['time = { column = "a", unit = "ms", from_zero = true }', 'position = { column = "b" }']
    rules.append('torque = { column = "c" }')
    mapping.write_text("\n".join(["[source]", "header = true", "[channels]", *rules]) + "\n")
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.metadata.recorded == "2026-03-08T20:00:00.000+00:00"


def test_steps_in_a_name_are_what_whole_numbers_are_worth(tmp_path: Path) -> None:
    head = "t (ms),pos (0.001 deg),speed (0.1 rpm),_tq_act (0.001 Nm)"
    whole = [1e3 * DEGREES, 10.0 * RPM, 1e3 * TORQUE]
    path = write(tmp_path / "log.csv", head, 1e3 * TIME, *([f"{one:.0f}" for one in values] for values in whole))
    recording = read_content(path).recording
    assert recording.position == pytest.approx(POSITION, abs=1e-5)
    assert recording.velocity == pytest.approx(VELOCITY, abs=0.006)
    assert recording.torque == pytest.approx(TORQUE, abs=6e-4)
    scaled = write(tmp_path / "other.csv", "t (ms),pos (deg),tq (0.001 Nm)", 1e3 * TIME, DEGREES, TORQUE)
    with pytest.raises(RecordingError, match="is not known"):
        read_content(scaled)


def test_the_least_and_the_largest_of_a_channel_are_no_joints(tmp_path: Path) -> None:
    names = [f"run - elbow/{channel}{end}" for channel in ("position", "torque") for end in ("", "__MIN", "__MAX")]
    path = write(tmp_path / "log.csv", f"t,{','.join(names)}", TIME, *[POSITION] * 3, *[TORQUE] * 3)
    assert [one.metadata.joint for one in read_named_log(path).recordings] == ["run_elbow"]


def test_the_velocity_of_a_motor_is_none_of_its_joint(tmp_path: Path) -> None:
    head = "t,motor_pos,motor_vel,motor_torque,joint_pos"
    path = write(tmp_path / "log.csv", head, TIME, 50.0 * POSITION, 50.0 * VELOCITY, TORQUE, POSITION)
    log = read_named_log(path)
    assert log.recordings[0].velocity is None
    assert any("'motor_vel' is that of the motor, and was left out" in note for note in log.notes)


@pytest.mark.parametrize(
    ("head", "likely"),
    [("time,POS,VEL,T,T_MOS,T_ROTOR", "torque=T"), ("t_us,target,voltage.q,velocity,angle", "torque=voltage.q")],
)
def test_the_column_that_a_joint_explains_is_told_as_its_torque(head: str, likely: str, tmp_path: Path) -> None:
    warm = 30.0 + 0.1 * TIME
    if "POS" in head:
        path = write(tmp_path / "log.csv", head, TIME, POSITION, VELOCITY, TORQUE, warm, warm)
    else:
        path = write(tmp_path / "log.csv", head, 1e6 * TIME, 0.01 + POSITION, TORQUE, VELOCITY, POSITION)
    with pytest.raises(RecordingError, match=f"--channel {likely} where"):
        read_named_log(path)


def test_a_voltage_that_is_taken_for_the_torque_is_one(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", "t,voltage.q,angle", TIME, TORQUE, POSITION)
    (recording,) = read_named_log(path, {"torque": "voltage.q"}).recordings
    assert recording.metadata.torque_unit == "V"


def test_the_torque_of_an_axis_of_sysmac_is_in_per_cent(tmp_path: Path) -> None:
    head = "Time(us),MC_Axis000.Act.Pos,MC_Axis000.Act.Vel,MC_Axis000.Act.Trq"
    path = write(tmp_path / "log.csv", head, 1e6 * TIME, POSITION, VELOCITY, 40.0 * TORQUE)
    with pytest.raises(RecordingError, match="per cent of the rated torque"):
        read_named_log(path)


@pytest.mark.parametrize(
    ("head", "said"),
    [
        ("t (ms),count,speed_rpm,torque_Nm", "some 65... a turn make 'speed_rpm' its rate"),
        ("t (ms),pos_counts,torque_Nm", r"scale = 6.2832/COUNTS_A_TURN \}"),
    ],
)
def test_what_a_count_is_worth_stands_in_the_mapping_that_is_proposed(head: str, said: str, tmp_path: Path) -> None:
    counts = [f"{one:.0f}" for one in POSITION * 65536 / (2.0 * np.pi)]
    columns: list[np.ndarray | list[str]] = [1e3 * TIME, counts, *([RPM] if "rpm" in head else []), TORQUE]
    seen = inspect_log(write(tmp_path / "log.csv", head, *columns))
    assert seen.log is None
    assert re.search(said, seen.guess)


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("力矩(牛·米)", ""), ("速度(转/分)", "rpm"), ("电流（毫安）", "mA"), ("Couple_daNm", "daNm"),
        ("Ângulo (graus)", "deg"), ("Velocidade (graus/s)", "deg/s"), ("位置【度】", "deg"), ("Kąt [stopnie]", "deg"),
    ],
)  # fmt: skip
def test_units_of_other_languages_are_known(name: str, unit: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert (meaning.unit, meaning.joint) == (unit, "")

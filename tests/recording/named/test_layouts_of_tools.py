"""Layouts that scopes, controllers and serial ports write: read by themselves, or refused with what to write."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import check_recording, convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.named.column import read_column_name
from fricomp.recording.named.log import read_named_log
from fricomp.recording.runs import order_runs

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 900, 125.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 4.07 * np.sin(1.1 * TIME) + 0.3 * np.sin(4.7 * TIME + 0.2)
VELOCITY = 4.477 * np.cos(1.1 * TIME) + 1.41 * np.cos(4.7 * TIME + 0.2)
TORQUE = 1234.5 * np.sign(VELOCITY) + 5.25 * VELOCITY
Samples = np.ndarray[tuple[int, ...], np.dtype[np.float64]]
Write = Callable[[Path], Path]


def write(path: Path, lines: Sequence[str], end: str = "\n") -> Path:
    path.write_text("\n".join(lines) + end, encoding="utf-8")
    return path


def rows_of(*columns: Samples, mark: str = ",") -> list[str]:
    return [mark.join(f"{cell:.10g}" for cell in row) for row in zip(*columns, strict=True)]


def write_pairs_of_time_and_value(folder: Path) -> Path:
    above = ["Name\tScope", "", "Name\tAxis.Position\tName\tAxis.ActTorque", "SampleTime[ms]\t8\tSampleTime[ms]\t8"]
    above += ["Offset\t0\tOffset\t0", "ScaleFactor\t1\tScaleFactor\t1"]
    return write(folder / "scope.csv", above + rows_of(1e3 * TIME, POSITION, 1e3 * TIME, TORQUE, mark="\t"))


def write_labels(folder: Path) -> Path:
    lines = [f"t={t:.4f} q={q:.9g}, tau: {tau:.9g}" for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True)]
    lines.insert(300, "# late by 3 us")
    return write(folder / "serial.log", ["boot 1.3", "ADC = 0.998", *lines, "t=99.2 q=1.0, tau: 1"], end="")


def write_objects_of_json(folder: Path) -> Path:
    rows = zip(TIME, POSITION, TORQUE, strict=True)
    return write(folder / "run.log", [f'{{"t": {t:.4f}, "q": {q:.9g}, "tau": {tau:.9g}}}' for t, q, tau in rows])


def write_label_of_units(folder: Path) -> Path:
    above = ["recorder,1,,", "path,Model/A,Model/B,Model/C", "name,XAxis,Position,Torque", "unit,s,rad,Nm"]
    first, *rows = rows_of(TIME, POSITION, TORQUE)
    return write(folder / "trace.csv", [*above, f"trace_values,{first}", *(f",{row}" for row in rows)])


def write_points_between_thousands(folder: Path) -> Path:
    def spell(value: float) -> str:
        return f"{value:,.6f}".translate(str.maketrans(",.", ".,"))

    lines = [";".join(map(spell, row)) for row in zip(TIME, 1e3 * POSITION, 60.0 * TORQUE, strict=True)]
    return write(folder / "excel.csv", ["sep=;", "Zeit;Lage;Moment", "s;mrad;Nm", *lines])


def write_long_form(folder: Path) -> Path:
    lines = ["time,signal,value"]
    for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True):
        lines += [f"{t:.4f},position,{q:.10g}", f"{t:.4f},torque,{tau:.10g}"]
    return write(folder / "long.csv", lines)


def write_chinese(folder: Path) -> Path:
    return write(folder / "log.csv", ["时间[s],关节角度[deg],实际力矩", *rows_of(TIME, np.rad2deg(POSITION), TORQUE)])


def write_dutch(folder: Path) -> Path:
    return write(folder / "log.csv", ["tijd,hoek,koppel", *rows_of(TIME, POSITION, TORQUE)])


def write_days(folder: Path) -> Path:
    lines = [
        f"{45356.4 + t / 86400:.12f},{q:.10g},{tau:.10g}" for t, q, tau in zip(TIME, POSITION, TORQUE, strict=True)
    ]
    return write(folder / "log.csv", ["DateTime,Position,Torque", *lines])


def write_timeseries(folder: Path) -> Path:
    from scipy.io import savemat

    one = {name: {"Time": TIME, "Data": values} for name, values in (("q", POSITION), ("tau", TORQUE))}
    savemat(folder / "log.mat", {"logs": one})
    return folder / "log.mat"


def write_structures_with_time(folder: Path) -> Path:
    from scipy.io import savemat

    def signal(values: Samples) -> dict[str, object]:
        return {"time": TIME, "signals": {"values": values, "dimensions": 1.0, "label": ""}}

    savemat(folder / "log.mat", {"tout": TIME, "position": signal(POSITION), "torque": signal(TORQUE)})
    return folder / "log.mat"


SAME: list[Write] = [
    write_pairs_of_time_and_value, write_labels, write_objects_of_json, write_label_of_units, write_long_form,
    write_chinese, write_dutch, write_days, write_timeseries, write_structures_with_time,
]  # fmt: skip


@pytest.mark.parametrize("form", SAME)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert len(recording) == N_ROWS
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-5)


@pytest.mark.parametrize(
    "form", [write_pairs_of_time_and_value, write_labels, write_chinese, write_days, write_timeseries]
)
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    recording = convert_by_proposal(form(tmp_path), tmp_path)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-5)


def test_points_between_thousands_are_no_decimals(tmp_path: Path) -> None:
    recording = read_content(write_points_between_thousands(tmp_path)).recording
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(60.0 * TORQUE, abs=1e-5)


@pytest.mark.parametrize("phase", [0.5, 0.2])
def test_channels_that_stand_in_rows_of_their_own_meet_at_those_of_the_position(phase: float, tmp_path: Path) -> None:
    smooth = np.cos(2.3 * TIME)
    rows = [(t, f"{t:.6f},{q:.10g},") for t, q in zip(TIME, POSITION, strict=True)]
    rows += [(t, f"{t:.6f},,{tau:.10g}") for t, tau in zip(TIME + phase / RATE, smooth, strict=True)]
    path = write(tmp_path / "log.csv", ["__time,/elbow/position,/drive/torque", *(row for _, row in sorted(rows))])
    recording = read_content(path).recording
    assert len(recording) == N_ROWS - 1  # no torque is known before its first reading
    expected = np.interp(recording.time - recording.time[0] + TIME[1], TIME + phase / RATE, smooth)
    assert recording.torque == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize(
    "name",
    [
        "Torque Actual Value [per thousand]", "Torque [‰]", "torque [0.1%]", "Position [qc]", "Velocity [cnt/sec](A01)",
        "Present Velocity (0.229 rpm)", "Present Current (2.69 [mA])", "Torque [1/1000]", "pos_inc",
    ],
)  # fmt: skip
def test_units_of_a_device_are_asked_about(name: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert meaning.unit in ("counts", "?")


@pytest.mark.parametrize(
    ("name", "channel", "joint"),
    [
        ("Present Position[ID:001]", "position", "001"),
        ("GVL.rSetPosition", "position_reference", "GVL_r"),
        ("关节角速度", "velocity", ""),
        ("目标位置", "position_reference", ""),
        ("Ángulo", "position", ""),
        ("Position Actual Value", "position", ""),
        ("tau_cNm", "torque", ""),
    ],
)
def test_a_name_says_which_quantity(name: str, channel: str, joint: str) -> None:
    meaning = read_column_name(name)
    assert meaning is not None
    assert (meaning.channel, meaning.joint) == (channel, joint)


@pytest.mark.parametrize("name", ["Present Current", "torque"])
def test_whole_numbers_without_a_unit_are_no_amperes(name: str, tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", [f"t,pos_deg,{name}", *rows_of(TIME, POSITION, np.round(TORQUE))])
    with pytest.raises(RecordingError, match="holds whole numbers alone and names no unit: counts of a register"):
        read_named_log(path)
    stated = write(tmp_path / "mA.csv", [f"t,pos_deg,{name} [mNm]", *rows_of(TIME, POSITION, np.round(TORQUE))])
    assert read_named_log(stated).recordings[0].torque == pytest.approx(1e-3 * np.round(TORQUE))


def test_a_mapping_that_is_proposed_can_be_followed(tmp_path: Path) -> None:
    names = "sample,Position [cnt],Velocity [rpm],Active Current [A],position_ref"
    path = write(tmp_path / "log.csv", [names, *rows_of(RATE * TIME, POSITION, VELOCITY, TORQUE, POSITION)])
    guess = inspect_log(path).guess
    assert "rate = ROWS_A_SECOND" in guess
    filled = guess.replace("ROWS_A_SECOND", "125").replace("VALUE_OF_ONE", "0.25")
    mapping = tmp_path / "log.toml"
    mapping.write_text(filled, encoding="utf-8")
    assert "position_ref" not in str(tomllib.loads(filled))
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.metadata.torque_unit == "A"
    assert found.recording.time == pytest.approx(TIME)
    assert found.recording.position == pytest.approx(0.25 * POSITION)
    assert found.recording.velocity == pytest.approx(VELOCITY * np.pi / 30)


@pytest.mark.parametrize("asked", ["action:1", "goal", "x_ref"])
def test_what_was_asked_for_is_not_proposed_as_the_position(asked: str, tmp_path: Path) -> None:
    lead = POSITION + 0.02 * VELOCITY
    path = write(tmp_path / "log.csv", [f"t,{asked},state:1,load_mNm", *rows_of(TIME, lead, POSITION, TORQUE)])
    guess = inspect_log(path).guess
    assert asked not in guess
    assert 'position = { column = "state:1"' in guess


def test_a_note_on_the_rows_is_told_once(tmp_path: Path) -> None:
    rows = rows_of(TIME, POSITION, TORQUE)
    path = write(tmp_path / "log.csv", ["t,q,tau", *rows[::-1]])
    told = [one for one in read_content(path).findings if "run backwards" in one.message]
    assert len(told) == 1


def test_what_a_name_says_is_told_where_the_log_as_a_whole_is_not_read(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", ["t_us,enc_counts,tau_mNm", *rows_of(1e6 * TIME, np.round(POSITION), TORQUE)])
    why = {column.name: column.why for column in inspect_log(path).columns}
    assert why["t_us"] == "called as a time"
    assert why["enc_counts"] == "its name says position, in units of a device"
    assert why["tau_mNm"] == "its name says torque in mNm"


@pytest.mark.parametrize("suffix", [".csv.gz", ".zip"])
def test_a_packed_log_is_to_be_unpacked(suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"log{suffix}"
    path.write_bytes(b"\x1f\x8b\x08\0")
    with pytest.raises(RecordingError, match=r"is compressed: unpack it by '(gunzip -k|unzip) "):
        read_content(path)


@pytest.mark.parametrize(
    ("period", "rate"), [(86400.0, 500.0), (2.0**32 * 1e-6, 125.0), (65.536, 50.0), (3600.0, 10.0)]
)
def test_a_clock_that_is_full_is_carried_on(period: float, rate: float) -> None:
    time = np.arange(4000) / rate
    wrapped = np.mod(time + period - 7.0, period)
    channels, findings = order_runs({"time": wrapped, "position": time})
    assert channels["time"] - channels["time"][0] == pytest.approx(time, abs=1e-6)
    assert "as a counter that is full does" in findings[0].message


def test_a_gap_is_no_other_unit_of_the_velocity(tmp_path: Path) -> None:
    later = np.where(TIME > 2.0, TIME + 40.0, TIME)
    path = write(tmp_path / "log.csv", ["t,q,dq,tau", *rows_of(later, 0.05 * POSITION, 0.05 * VELOCITY, TORQUE)])
    codes = {finding.code for finding in check_recording(read_content(path).recording)}
    assert "gap" in codes
    assert not codes & {"velocity_scale", "velocity_mismatch", "velocity_unit"}


def test_a_number_for_no_value_is_no_wrap(tmp_path: Path) -> None:
    position = np.array(0.02 * POSITION)
    position[[70, 71, 300, 555]] = -9999.0
    path = write(tmp_path / "log.csv", ["t,q,tau", *rows_of(TIME, position, TORQUE)])
    findings = {finding.code: finding for finding in check_recording(read_content(path).recording)}
    assert "wrap" not in findings
    assert "position is -9999 in 4 row(s), far from all others" in findings["spike"].message


@pytest.mark.parametrize("decimal", [".", ","])
def test_a_measurement_of_labview_without_a_time_has_units_and_a_step(decimal: str, tmp_path: Path) -> None:
    facts = "Channels\t2\t\t\nSamples\t900\t900\t\nY_Unit_Label\tdeg\tmNm\t\nX0\t0.0\t0.0\t\nDelta_X\t0.008\t0.008\t\n"
    end, rows = "***End_of_Header***\t\t\t\n", zip(np.degrees(POSITION), 1e3 * TORQUE, strict=True)
    text = "".join(f"\t{q:.9f}\t{tau:.9f}\n" for q, tau in rows)
    text = f"X_Columns\tNo\n{end}\t\n{facts}{end}\tAngle\tTorque\tComment\n{text}".replace(".", decimal)
    (tmp_path / "log.lvm").write_text(text)
    recording = read_content(tmp_path / "log.lvm").recording
    assert recording.time == pytest.approx(TIME - TIME[0], abs=1e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)

"""Forms in which programs export a log: names in two lines, channels in lines, JSON with names beside numbers."""

from __future__ import annotations

import json
import pickle
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording.file import read_content
from fricomp.recording.named.log import read_named_log

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 600, 250.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 0.9 * np.sin(3.1 * TIME) + 0.15 * np.cos(8.0 * TIME)
TORQUE = 1.9 * np.sign(np.cos(3.1 * TIME)) + 0.4 * POSITION
DEGREES = np.rad2deg(POSITION)
Write = Callable[[Path], Path]


def write(path: Path, lines: Sequence[str]) -> Path:
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return path


def fill(form: str) -> list[str]:
    rows = zip(TIME, POSITION, DEGREES, TORQUE, strict=True)
    return [form.format(t=t, ms=1e3 * t, q=q, deg=deg, u=u) for t, q, deg, u in rows]


def list_rows(position: np.ndarray[tuple[int], np.dtype[np.float64]] = DEGREES) -> list[list[float]]:
    return [list(row) for row in zip(TIME, position, TORQUE, strict=True)]


def write_facts_in_lines(folder: Path) -> Path:
    above = ["Name;Project 1", "", "Name;Axes.A1.ActPos;MAIN.fTorque", "NetID;5.62.1.1;5.62.1.1", "Port;501;851"]
    above += ["SampleTime [ms];4;4", "Data-Type;REAL64;REAL64", "Unit;deg;Nm", ""]
    return write(folder / "scope.csv", above + fill("{ms:.3f};{deg:.9f};{u:.9f}"))


def write_facts_down_to_the_rows(folder: Path) -> Path:
    above = ["Signal\tArm.Angle [rad]\tArm.Torque [Nm]", "Gain\t1\t1", "Offset\t0\t0"]
    return write(folder / "scope.txt", above + fill("{t:.6f}\t{q:.9f}\t{u:.9f}"))


def write_simulink(folder: Path) -> Path:
    return write(folder / "out.csv", ["tout,q_out,tau_out", *fill("{t:.6f},{q:.9f},{u:.9f}")])


def write_series_in_rows(folder: Path) -> Path:
    rows = [
        f'"{name}";{row}' for name, form in (("q", "{t:.6f};{q:.9f}"), ("tau", "{t:.6f};{u:.9f}")) for row in fill(form)
    ]
    return write(folder / "panel.csv", ['"Series";"Time";"Value"', *rows])


def write_channels_in_lines(folder: Path) -> Path:
    rows = zip(("Time (s)", "Angle (deg)", "Torque (Nm)"), (TIME, DEGREES, TORQUE), strict=True)
    return write(folder / "sheet.txt", ["\t".join([name, *(f"{x:.9f}" for x in values)]) for name, values in rows])


def write_elements(folder: Path) -> Path:
    rows = fill('<Rob T="1"><AIPos A1="{deg:.9f}"/><ASPos A1="1.5"/><Trq A1="{u:.9f}"/><IPOC>{ms:.0f}</IPOC></Rob>')
    return write(folder / "rsi.xml", ["<Log>", *rows, "</Log>"])


def write_fields_in_archive(folder: Path) -> Path:
    log = np.zeros(N_ROWS, dtype=[("t_us", "i8"), ("state", [("pos_deg", "f8")]), ("tau", "f8")])
    log["t_us"], log["state"]["pos_deg"], log["tau"] = np.round(1e6 * TIME), DEGREES, TORQUE
    np.savez(folder / "log.npz", run=log, remark=np.array(["rig 3"]))
    return folder / "log.npz"


def write_json(folder: Path, content: object) -> Path:
    (folder / "log.json").write_text(json.dumps(content))
    return folder / "log.json"


def write_rows(path: Path, rows: Sequence[Mapping[str, object]]) -> Path:
    """The same rows as a line of JSON each, or as Parquet, by the name of the file."""
    import pyarrow
    from pyarrow import parquet

    if path.suffix == ".jsonl":
        return write(path, [json.dumps(row) for row in rows])
    parquet.write_table(pyarrow.Table.from_pylist(rows), path)
    return path


def write_names_beside_rows(folder: Path) -> Path:
    content = {"columns": ["time_s", "angle_deg", "torque_Nm"], "index": list(range(N_ROWS)), "data": list_rows()}
    return write_json(folder, content)


def write_names_beside_columns(folder: Path) -> Path:
    fields = [{"name": "time"}, {"name": "position"}, {"name": "torque"}]
    columns = [TIME.tolist(), POSITION.tolist(), TORQUE.tolist()]
    return write_json(folder, {"results": [{"schema": {"fields": fields}, "data": {"values": columns}}]})


def write_series_of_pairs(folder: Path) -> Path:
    series = [
        {
            "metric": {"__name__": name, "joint": "elbow"},
            "values": [[1.7e9 + t, f"{x:.9f}"] for t, x in zip(TIME, values, strict=True)],
        }
        for name, values in (("joint_position_radians", POSITION), ("joint_torque_newton_meters", TORQUE))
    ]
    return write_json(folder, {"status": "success", "data": {"resultType": "matrix", "result": series}})


def write_value_before_time(folder: Path) -> Path:
    series = [
        {"target": name, "datapoints": [[x, 1.7e12 + 1e3 * t] for t, x in zip(TIME, values, strict=True)]}
        for name, values in (("angle_deg", DEGREES), ("torque_Nm", TORQUE))
    ]
    return write_json(folder, series)


def write_units_beside_values(folder: Path) -> Path:
    rows = [
        {
            "ts": f"2025-06-17T14:03:{t:09.6f}Z",
            "m": {"angle": {"value": q, "unit": "deg"}, "torque": {"value": u, "unit": "Nm"}},
        }
        for t, q, u in list_rows()
    ]
    return write(folder / "log.jsonl", [json.dumps(row) for row in rows])


def write_units_in_an_object(folder: Path) -> Path:
    content = {"units": {"angle": "deg", "torque": "Nm"}, "time": TIME.tolist(), "angle": DEGREES.tolist()}
    return write_json(folder, {**content, "torque": TORQUE.tolist()})


def write_units_in_a_table(folder: Path) -> Path:
    import pyarrow
    from pyarrow import parquet

    units = {"angle_unit": ["deg"] * N_ROWS, "torque_unit": ["Nm"] * N_ROWS}
    parquet.write_table(
        pyarrow.table({"time": TIME, "angle": DEGREES, "torque": TORQUE, **units}), folder / "log.parquet"
    )
    return folder / "log.parquet"


def write_vesc(folder: Path) -> Path:
    names = (
        "ms_today;temp_motor;current_motor;current_in;d_axis_current;q_axis_current;erpm;encoder_position;fault_code"
    )
    rows = [
        f"{5e7 + 1e3 * t:.3f};41;0.5;0.1;0.02;{u:.9f};{k % 7};{deg:.9f};FAULT_CODE_NONE"
        for k, (t, deg, u) in enumerate(list_rows())
    ]
    return write(folder / "vesc.csv", [names, *rows])


def write_mujoco(folder: Path) -> Path:
    return write(folder / "sim.csv", ["time,qpos_0,actuator_force_0,ctrl_0", *fill("{t:.6f},{q:.9f},{u:.9f},0.1")])


def write_quoted_commas(folder: Path, decimals: int = 9) -> Path:
    rows = [",".join(f'"{value:.{decimals}f}"'.replace(".", ",") for value in row) for row in list_rows(POSITION)]
    return write(folder / "log.csv", ['"t [s]","q [rad]","tau [Nm]"', *rows])


def write_units_in_a_comment(folder: Path) -> Path:
    return write(folder / "log.csv", ["# units: s, deg, Nm", "t,pos,torque", *fill("{t:.6f},{deg:.9f},{u:.9f}")])


FORMS: list[Write] = [
    *(write_quoted_commas, write_units_in_a_comment),
    *(write_vesc, write_mujoco),
    *(write_facts_in_lines, write_facts_down_to_the_rows, write_simulink, write_series_in_rows, write_elements),
    *(write_channels_in_lines, write_fields_in_archive, write_names_beside_rows, write_names_beside_columns),
    *(write_series_of_pairs, write_value_before_time, write_units_beside_values, write_units_in_an_object),
    write_units_in_a_table,
]
IN_SERIES = (write_series_in_rows, write_series_of_pairs, write_value_before_time)


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-5)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize("form", [one for one in FORMS if one not in IN_SERIES])
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    recording = convert_by_proposal(form(tmp_path), tmp_path)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize(
    "above",
    [
        ["joint,a,a,b,b", "channel,position,torque,position,torque", "time,,,,"],
        [",a,a,b,b", ",position,torque,position,torque"],
        ["Time (s),a,,b,", ",Angle (rad),Torque (Nm),Angle (rad),Torque (Nm)"],
        ["Time (s);a;;b;", "Test 3;Encoder 4;Sensor;Encoder 5;Sensor", ";rad;Nm;rad;Nm", ";pos;torque;pos;torque"],
    ],
)
def test_names_in_two_lines_are_those_of_two_joints(above: list[str], tmp_path: Path) -> None:
    mark = ";" if ";" in above[0] else ","
    path = write(tmp_path / "log.csv", above + fill(mark.join(["{t:.6f}", "0.3", "0.1", "{q:.9f}", "{u:.9f}"])))
    other, moved = read_named_log(path).recordings
    assert (other.metadata.joint, moved.metadata.joint) == ("a", "b")
    assert moved.position == pytest.approx(POSITION, abs=1e-6)
    assert moved.time == pytest.approx(TIME, abs=1e-6)


def test_axes_in_xml_are_joints_of_their_own(tmp_path: Path) -> None:
    rows = fill('<Rob><AIPos A1="7.5" A2="{deg:.9f}"/><Trq A1="0.2" A2="{u:.9f}"/><IPOC>{ms:.0f}</IPOC></Rob>')
    held, moved = read_named_log(write(tmp_path / "rsi.xml", rows)).recordings
    assert (held.metadata.joint, moved.metadata.joint) == ("A1", "A2")
    assert moved.position == pytest.approx(POSITION, abs=1e-6)


def test_counts_of_a_motor_are_asked_about_with_both_factors(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", ["t,Motor Position (counts),Current (A)", *fill("{t:.6f},{q:.9f},{u:.9f}")])
    with pytest.raises(RecordingError, match=r"scale = 6\.2832/\(COUNTS_A_TURN\*RATIO\)"):
        read_content(path)


def test_lines_of_a_boot_above_numbers_are_no_names(tmp_path: Path) -> None:
    from fricomp.calibration.table import is_friction_table

    path = write(tmp_path / "log.txt", ["MOT: Monitor enabled!", "MOT: Ready.", *fill("{q:.4f}\t{u:.4f}\t{deg:.4f}")])
    with pytest.raises(RecordingError, match=r"no line of names above its numbers.*--inspect"):
        is_friction_table(path)


@pytest.mark.parametrize("kind", ["jsonl", "parquet"])
def test_rows_of_joints_in_turns_are_those_of_each_joint(kind: str, tmp_path: Path) -> None:
    rows = [
        {"time": t, "joint": joint, "position": q if joint == "a" else 0.7, "torque": u}
        for t, q, u in list_rows(POSITION)
        for joint in ("a", "b")
    ]
    moved, held = read_named_log(write_rows(tmp_path / f"log.{kind}", rows)).recordings
    assert (moved.metadata.joint, held.metadata.joint) == ("a", "b")
    assert moved.position == pytest.approx(POSITION)
    assert held.position == pytest.approx(np.full(N_ROWS, 0.7))


@pytest.mark.parametrize("kind", ["jsonl", "parquet"])
def test_names_of_joints_in_a_list_beside_their_numbers_are_no_words_of_a_unit(kind: str, tmp_path: Path) -> None:
    """Messages of joints keep the names of all of them in every row."""
    rows = [
        {"time": t, "name": ["a", "b"], "position": [q, 0.7], "effort": [u, 0.1]} for t, q, u in list_rows(POSITION)
    ]
    moved, held = read_named_log(write_rows(tmp_path / f"log.{kind}", rows)).recordings
    assert moved.position == pytest.approx(POSITION)
    assert held.position == pytest.approx(np.full(N_ROWS, 0.7))


@pytest.mark.parametrize(
    ("start", "what"),
    [(pickle.dumps({"q": 1.0}), "a pickle"), (b"PK\x03\x04" + bytes(99), "a spreadsheet"), (b"\x89HDF\r\n", "HDF5")],
)
def test_another_format_that_is_called_csv_is_told(start: bytes, what: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_bytes(start)
    with pytest.raises(RecordingError, match=f"is called .csv and begins as {what}"):
        read_content(tmp_path / "log.csv")


@pytest.mark.parametrize("unit", ["mGrad", "furlong"])
def test_a_line_of_units_says_all_of_them_known_or_not(tmp_path: Path, unit: str) -> None:
    """One unit that nobody here knows made a line of units be passed over, and the position was taken for rad."""
    above = ["rig 3;;", "Zeit;Winkel;Drehmoment", f"ms;{unit};Nm"]
    path = write(tmp_path / "log.csv", above + [row.replace(",", ";") for row in fill("{ms:.3f},{deg:.9f},{u:.9f}")])
    if unit == "furlong":
        with pytest.raises(RecordingError, match=r"the unit in 'Winkel \[\? furlong\]' is not known"):
            read_content(path)
    else:
        np.testing.assert_allclose(read_content(path).recording.position, 1e-3 * POSITION, atol=1e-9)


def test_the_units_of_labview_stand_in_a_line_of_facts(tmp_path: Path) -> None:
    above = ["LabVIEW Measurement\t", "X_Columns\tMulti", "***End_of_Header***\t", "\t", "Samples\t600\t\t600\t\t"]
    above += ["Y_Unit_Label\tdeg\t\tN.m\t\t", "X_Dimension\tTime\t\tTime\t\t", "X0\t0.0\t\t0.0\t\t"]
    above += ["***End_of_Header***\t\t\t\t\t", "X_Value\tAngle\tX_Value\tTorque\tComment"]
    path = write(tmp_path / "log.lvm", above + fill("{t:.6f}\t{deg:.9f}\t{t:.6f}\t{u:.9f}\t"))
    np.testing.assert_allclose(read_content(path).recording.position, POSITION, atol=1e-8)


def test_lerobot_names_a_joint_between_what_it_is_and_what_is_said_of_it(tmp_path: Path) -> None:
    names = ["observation.state.elbow.pos", "observation.effort.elbow.effort"]
    path = write(tmp_path / "log.csv", [f"timestamp,{','.join(names)}", *fill("{t:.6f},{q:.9f},{u:.9f}")])
    assert read_content(path, joint="elbow").recording.metadata.joint == "elbow"


def test_three_quoted_decimals_are_no_thousands(tmp_path: Path) -> None:
    recording = read_content(write_quoted_commas(tmp_path, 3)).recording
    assert recording.position == pytest.approx(POSITION, abs=6e-4)
    assert recording.torque == pytest.approx(TORQUE, abs=6e-4)


def test_quoted_commas_between_thousands_stay_so(tmp_path: Path) -> None:
    rows = [f'{t:.6f},"{1e3 * deg:,.3f}",{u:.9f}' for t, deg, u in list_rows()]
    recording = read_content(write(tmp_path / "log.csv", ["t,angle [mdeg],tau", *rows])).recording
    assert recording.position == pytest.approx(POSITION, abs=1e-6)


def test_currents_of_phases_are_told_as_such(tmp_path: Path) -> None:
    phases = [TORQUE * np.cos(7.0 * POSITION - k * 2.0 * np.pi / 3.0) for k in range(3)]
    rows = [",".join(f"{value:.6f}" for value in row) for row in zip(TIME, POSITION, *phases, strict=True)]
    with pytest.raises(RecordingError, match=r"i_a and i_b and i_c are the currents of a motor's phases"):
        read_content(write(tmp_path / "log.csv", ["t,pos_rad,i_a,i_b,i_c", *rows]))


def check_scaled(log: Path, tmp_path: Path) -> None:
    """That whole numbers are read by the scales beside them, and the proposed mapping reads them so too."""
    (found,) = read_named_log(log).recordings
    assert np.allclose(found.position, POSITION, atol=1e-5)
    assert np.allclose(found.torque, TORQUE, atol=2e-3)
    assert np.allclose(convert_by_proposal(log, tmp_path).position, POSITION, atol=1e-5)


def test_a_scope_that_scales_whole_numbers_has_their_size_in_its_head(tmp_path: Path) -> None:
    size = (0.001, 0.002)
    head = [
        "Name\tAxis.ActPos\tName\tAxis.ActTorque",
        "SampleTime[ms]\t4\tSampleTime[ms]\t4",
        "ScaleFactor\t0.001\tScaleFactor\t0,002",
        "Unit\tdeg\tUnit\tNm",
        "",
    ]
    counts = np.round(np.column_stack([DEGREES / size[0], TORQUE / size[1]]))
    rows = [f"{1e3 * t:.0f}\t{q:.0f}\t{1e3 * t:.0f}\t{u:.0f}" for t, (q, u) in zip(TIME, counts, strict=True)]
    log = write(tmp_path / "scope.csv", [*head, *rows])
    check_scaled(log, tmp_path)


def test_numbers_that_may_have_been_scaled_already_are_asked_about(tmp_path: Path) -> None:
    head = ["Name\tAxis.ActPos\tName\tAxis.ActTorque", "ScaleFactor\t0.001\tScaleFactor\t1", "Unit\tdeg\tUnit\tNm"]
    rows = [f"{1e3 * t:.0f}\t{q:.4f}\t{1e3 * t:.0f}\t{u:.4f}" for t, q, u in zip(TIME, DEGREES, TORQUE, strict=True)]
    with pytest.raises(RecordingError, match=r"0\.001 deg"):
        read_named_log(write(tmp_path / "scope.csv", [*head, "", *rows]))


@pytest.mark.parametrize(
    "head",
    [
        ["Name;ActPos;ActTorque", "SampleTime [ms];4;4", "ScaleFactor;0.001;0.002", "Unit;deg;Nm"],
        ["ScaleFactor;0,001;0,002", "Unit;deg;Nm", "time [ms];Axis.ActPos;Axis.ActTorque"],
        ["time [ms];ActPos [deg];ActTorque [Nm]", "Scale Factor;0.001;0.002"],
    ],
)
def test_a_line_of_scales_beside_the_names_counts_as_well(head: list[str], tmp_path: Path) -> None:
    counts = np.round(np.column_stack([DEGREES / 0.001, TORQUE / 0.002]))
    rows = [f"{1e3 * t:.0f};{q:.0f};{u:.0f}" for t, (q, u) in zip(TIME, counts, strict=True)]
    log = write(tmp_path / "scope.csv", [*head, *rows])
    check_scaled(log, tmp_path)

"""Legends, marks of sections, units of which a number is a part, points that are objects, glued words."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.named.log import read_named_log
from fricomp.recording.unit_word import UNKNOWN_UNIT, read_bracket

N_ROWS, RATE = 700, 140.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 0.9 * np.sin(2.3 * TIME) + 0.2 * np.sin(5.1 * TIME + 0.4)
VELOCITY = 2.07 * np.cos(2.3 * TIME) + 1.02 * np.cos(5.1 * TIME + 0.4)
TORQUE = 1.7 * np.sign(VELOCITY) + 0.6 * VELOCITY
DEGREES = np.degrees(POSITION)
Samples = np.ndarray[tuple[int, ...], np.dtype[np.float64]]


def read(path: Path, above: Sequence[str], *columns: Samples, mark: str = ",") -> Recording:
    rows = [mark.join(f"{cell:.9g}" for cell in row) for row in zip(*columns, strict=True)]
    path.write_text("\n".join([*above, *rows]) + "\n", encoding="utf-8")
    return read_named_log(path).recordings[0]


def require_right(recording: Recording, unit: str = "N·m", off: float = 1e-3) -> None:
    assert recording.metadata.torque_unit == unit
    assert recording.duration == pytest.approx(TIME[-1], rel=1e-6)
    for found, truth in ((recording.position, POSITION), (recording.torque, TORQUE)):
        assert np.max(np.abs(np.asarray(found) - truth)) < off * np.max(np.abs(truth))
    if recording.velocity is not None:
        assert np.max(np.abs(np.asarray(recording.velocity) - VELOCITY)) < off * np.max(np.abs(VELOCITY))


@pytest.mark.parametrize("section", ["[Data]", "BEGIN DATA", "Messwerte:", "***DATA***", "<values>", "data;;"])
@pytest.mark.parametrize("mark", [";", "\t"])
def test_a_line_that_says_that_rows_begin_is_passed_over(tmp_path: Path, section: str, mark: str) -> None:
    above = ["[Signals]", mark.join(["Time [s]", "Angle [deg]", "Torque [Nm]"]), section]
    require_right(read(tmp_path / "log.csv", above, TIME, DEGREES, TORQUE, mark=mark))


@pytest.mark.parametrize("entry", ["# {}: {}", '"{}","{}"', "{}={}", "{} ;{}"])
def test_columns_called_as_channels_are_what_a_legend_says(tmp_path: Path, entry: str) -> None:
    said = {"CH 1": "Angle [deg]", "CH 2": "Torque [Nm]"}
    above = [entry.format(*one) for one in said.items()]
    require_right(read(tmp_path / "log.csv", [*above, "Time [s],CH 1,CH 2"], TIME, DEGREES, TORQUE))


@pytest.mark.parametrize(
    ("position", "torque"),
    [
        ("1/1000 deg", "1/1000 Nm"),
        ("10^-3 deg", "x0.001 Nm"),
        ("1e-3 deg", "10⁻³ Nm"),
        ("10⁻³ deg", "0.001 Nm"),
        ("x 0.001 deg", "10-3 Nm"),
    ],
)
def test_whole_numbers_are_so_many_parts_of_a_unit(tmp_path: Path, position: str, torque: str) -> None:
    head = f"t [s],pos [{position}],trq [{torque}]"
    require_right(read(tmp_path / "log.csv", [head], TIME, np.round(1e3 * DEGREES), np.round(1e3 * TORQUE)), off=2e-3)
    with pytest.raises(RecordingError, match="the unit in 'pos"):
        read(tmp_path / "other.csv", [head], TIME, DEGREES, TORQUE)


@pytest.mark.parametrize(("unit", "parts"), [("0.1%", 1000), ("0.01 %", 10000), ("%", 100)])
def test_parts_of_a_per_cent_are_asked_for_as_what_they_are(tmp_path: Path, unit: str, parts: int) -> None:
    head = f"t [s],pos [deg],Torque [{unit}]"
    with pytest.raises(RecordingError, match=f"scale = RATED/{parts} }}"):
        read(tmp_path / "log.csv", [head], TIME, DEGREES, np.round(parts * TORQUE / 3.0))
    with pytest.raises(RecordingError, match="scale = RATED/100 }"):  # it is the resolution of what is in per cent
        read(tmp_path / "share.csv", [head], TIME, DEGREES, np.round(100.0 * TORQUE / 3.0, 1))


@pytest.mark.parametrize(
    "names",
    [
        ["jointpos", "jointvel", "actuatorfrc"],
        ["elbow_jointpos", "elbow_jointvel", "elbow_actuatorfrc"],
        ["axisposition", "axisspeed", "axistorque"],
        ["joint_pos", "joint_vel", "applied_torque"],
        ["arm.Rz.q", "arm.Rz.w", "arm.Rz.t"],
        ["iiwa_joint_7_q", "iiwa_joint_7_w", "iiwa_joint_7_tau"],
    ],
)
def test_words_that_simulators_write_as_one_and_letters_of_primitives(tmp_path: Path, names: Sequence[str]) -> None:
    found = read(tmp_path / "log.csv", [",".join(["time", *names])], TIME, POSITION, VELOCITY, TORQUE)
    assert found.velocity is not None
    require_right(found)


def test_of_an_applied_and_a_computed_torque_the_applied_one_acts(tmp_path: Path) -> None:
    head = "time,joint_pos,applied_joint_pos,computed_torque,applied_torque"
    asked = POSITION + 0.01 * np.sin(9.0 * TIME)
    found = read(tmp_path / "log.csv", [head], TIME, POSITION, asked, 1.3 * TORQUE, TORQUE)
    require_right(found)
    assert found.position_reference == pytest.approx(asked, abs=1e-6)


def test_one_quantity_in_two_units_is_no_question_and_two_quantities_are(tmp_path: Path) -> None:
    head = "time_s,pos_deg,pos_rad,torque_nm"
    require_right(read(tmp_path / "log.csv", [head], TIME, 0.01 * np.round(100.0 * DEGREES), POSITION, TORQUE))
    with pytest.raises(RecordingError, match="could each be the position"):
        read(tmp_path / "two.csv", [head], TIME, DEGREES + 3.0 * np.sin(TIME), POSITION, TORQUE)


@pytest.mark.parametrize("shape", ["nodes", "datasets", "keys"])
def test_points_that_are_objects_are_series(tmp_path: Path, shape: str) -> None:
    channels = {"joint_angle_deg": DEGREES, "joint_torque_nm": TORQUE}
    when, what = {"nodes": ("sourceTimestamp", "value"), "datasets": ("x", "y"), "keys": ("ts", "value")}[shape]
    stamps = 1710460790.0 + TIME if shape == "keys" else TIME
    points = {
        name: [{when: float(t), what: float(x)} for t, x in zip(stamps, values, strict=True)]
        for name, values in channels.items()
    }
    document = {
        "nodes": [{"nodeId": f"ns=2;s={name}", "values": one} for name, one in points.items()],
        "datasets": {"data": {"datasets": [{"label": name, "data": one} for name, one in points.items()]}},
        "keys": points,
    }[shape]
    (tmp_path / "log.json").write_text(json.dumps(document))
    require_right(read_named_log(tmp_path / "log.json").recordings[0], off=2e-3)


def test_times_with_a_zone_and_in_angle_brackets_are_read(tmp_path: Path) -> None:
    clock = [f"10:00:{t:09.6f}" for t in TIME]
    rows = [f"2026-03-14 {at} UTC,{q:.9g},{u:.9g}" for at, q, u in zip(clock, DEGREES, TORQUE, strict=True)]
    (tmp_path / "zone.csv").write_text("\n".join(["ts,pos_deg,torque_nm", *rows]) + "\n")
    require_right(read_named_log(tmp_path / "zone.csv").recordings[0])
    rows = [f"<{at}> M1 POS={q:.9g}deg TRQ={u:.9g}Nm" for at, q, u in zip(clock, DEGREES, TORQUE, strict=True)]
    (tmp_path / "port.log").write_text("\n".join(rows) + "\n")
    require_right(read_named_log(tmp_path / "port.log").recordings[0])


@pytest.mark.parametrize(("root", "kind"), [('<mujoco model="arm">', "MJCF"), ('<robot name="arm">', "URDF")])
def test_a_simulation_is_told_to_be_one_where_a_log_is_asked_for(tmp_path: Path, root: str, kind: str) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(f'<?xml version="1.0"?>\n<!-- licence -->\n{root}<joint damping="0.3" armature="0.02"/></x>\n')
    with pytest.raises(RecordingError, match=rf"is a simulation \({kind}\), and no recording: give it by --simulation"):
        read_named_log(path)
    with pytest.raises(RecordingError, match="is a simulation"):
        inspect_log(path)


def test_a_column_that_is_a_rate_is_not_offered_as_the_torque(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="--channel torque=other where"):
        read(tmp_path / "log.csv", ["time,q,w,other"], TIME, POSITION, VELOCITY, TORQUE)


@pytest.mark.parametrize(
    "unit",
    ["deg·10⁻³", "deg x100", "deg x 10", "deg e-3", "e-3 deg", "kdeg", "·10⁻³ deg", "scaled deg", "tenths of deg"],
)
def test_a_unit_with_a_factor_about_it_is_asked_for_and_never_taken_without(tmp_path: Path, unit: str) -> None:
    with pytest.raises(RecordingError, match="the unit in 'pos"):
        read(tmp_path / "log.csv", [f"t [s],pos [{unit}],trq [Nm]"], TIME, 17.3 * DEGREES, TORQUE)


@pytest.mark.parametrize(
    "unit", ["min-1", "1/min", "rad s^-1", "mm·s⁻¹", "rad/s^2", "milli-Nm", "N·m", "in-lb", "kg·cm"]
)
def test_powers_and_prefixes_of_a_unit_are_no_factors(unit: str) -> None:
    assert read_bracket(unit) not in ("", UNKNOWN_UNIT)

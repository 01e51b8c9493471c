"""Logs as people and tools write them: each is read by itself, or is refused with what to write."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from datetime import datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.api.identify import IdentifySettings, identify_source
from fricomp.calibration.table import is_friction_table, read_friction_table
from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.file import read_content
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import COULOMB, VISCOUS, joint_log

from .proposed_mapping import convert_by_proposal

N_ROWS, RATE = 1200, 160.0
TIME = np.arange(N_ROWS) / RATE
POSITION = 0.7 * np.sin(1.7 * TIME) + 0.1 * np.sin(5.3 * TIME + 0.4)
VELOCITY = 1.19 * np.cos(1.7 * TIME) + 0.53 * np.cos(5.3 * TIME + 0.4)
TORQUE = 0.25 * np.sign(VELOCITY) + 0.08 * VELOCITY + 0.3 * np.sin(POSITION)
Cells = Any
Write = Callable[[Path], Path]


def write(path: Path, names: Sequence[str], columns: Sequence[Cells], mark: str = ",", above: str = "") -> Path:
    rows = [
        mark.join(f"{cell:.10g}" if isinstance(cell, float) else str(cell) for cell in row)
        for row in zip(*columns, strict=True)
    ]
    text = "\n".join([above + mark.join(names), *rows]) if names else "\n".join(rows)
    path.write_text(text + "\n", encoding="utf-8")
    return path


def write_other_words(folder: Path) -> Path:
    columns = [TIME * 1e3, np.rad2deg(POSITION), VELOCITY * 30 / np.pi, TORQUE * 1e3]
    return write(folder / "log.csv", ["Time (ms)", "Angle (deg)", "Speed (rpm)", "Torque (mNm)"], columns)


def write_preamble(folder: Path) -> Path:
    above = "Robot log v1.2\nSerial: 123456, 7\nDate: 2024-01-02\n\n"
    return write(folder / "log.csv", ["Time", "Position", "Torque"], [TIME, POSITION, TORQUE], above=above)


def write_line_of_units(folder: Path) -> Path:
    columns = [["ms", *(1e3 * TIME)], ["deg", *np.rad2deg(POSITION)], ["mNm", *(1e3 * TORQUE)]]
    return write(folder / "log.csv", ["time", "position", "torque"], columns)


def write_names_in_a_comment(folder: Path) -> Path:
    return write(folder / "log.txt", ["# time", "position", "torque"], [TIME, POSITION, TORQUE], " ", "% of a rig\n")


def write_white_space(folder: Path) -> Path:
    return write(folder / "log.dat", ["t", "q", "tau"], [TIME, POSITION, TORQUE], "   ")


def write_semicolons_with_points(folder: Path) -> Path:
    return write(folder / "log.csv", ["Zeit", "Winkel", "Drehmoment"], [TIME, POSITION, TORQUE], ";")


def write_day_first(folder: Path) -> Path:
    begin = datetime(2024, 3, 5, 23, 59, 58)
    stamps = [f"{begin + timedelta(seconds=float(t)):%d.%m.%Y %H:%M:%S.%f}" for t in TIME]
    return write(folder / "log.csv", ["DateTime", "JointAngle", "JointTorque"], [stamps, POSITION, TORQUE])


def write_seconds_and_nanoseconds(folder: Path) -> Path:
    stamps = [1_700_000_000_750_000_000 + round(1e9 * t) for t in TIME]
    parts = [[one // 10**9 for one in stamps], [one % 10**9 for one in stamps]]
    names = ["header.stamp.sec", "header.stamp.nanosec", "position[0]", "effort[0]"]
    return write(folder / "log.csv", names, [*parts, POSITION, TORQUE])


def write_thousands(folder: Path) -> Path:
    columns = [TIME, [f'"{v:,.4f}"' for v in np.rad2deg(POSITION) * 1e3], [f'"{v:,.5f}"' for v in 1e3 * TORQUE]]
    return write(folder / "log.csv", ["Time [s]", "Position [mdeg]", "Torque [mNm]"], columns)


def write_names_that_disagree(folder: Path) -> Path:
    return write(folder / "log.csv", ["t", "theta_m", "torque_a"], [TIME, POSITION, TORQUE])


def write_observer_beside(folder: Path) -> Path:
    return write(folder / "log.csv", ["time", "q", "tau_motor", "tau_ext"], [TIME, POSITION, TORQUE, 0.01 * VELOCITY])


def write_backwards(folder: Path) -> Path:
    return write(folder / "log.csv", ["t", "q", "tau"], [TIME[::-1], POSITION[::-1], TORQUE[::-1]])


def write_twice(folder: Path) -> Path:
    return write(folder / "log.csv", ["t", "q", "tau"], [np.repeat(one, 2) for one in (TIME, POSITION, TORQUE)])


FORMS: list[Write] = [
    write_other_words, write_preamble, write_line_of_units, write_names_in_a_comment, write_white_space,
    write_semicolons_with_points, write_day_first, write_seconds_and_nanoseconds, write_thousands,
    write_names_that_disagree, write_observer_beside, write_backwards, write_twice,
]  # fmt: skip


@pytest.mark.parametrize("form", FORMS)
def test_it_is_read_as_it_was_measured(form: Write, tmp_path: Path) -> None:
    recording = read_content(form(tmp_path)).recording
    assert len(recording) == N_ROWS
    assert recording.time - recording.time[0] == pytest.approx(TIME, abs=1e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)
    assert recording.metadata.torque_unit == "N·m"


@pytest.mark.parametrize("form", FORMS)
def test_its_mapping_reads_the_same(form: Write, tmp_path: Path) -> None:
    recording = convert_by_proposal(form(tmp_path), tmp_path)
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)
    assert recording.position == pytest.approx(POSITION, abs=1e-6)


def test_a_current_a_sensor_and_a_command_stand_in_for_a_torque(tmp_path: Path) -> None:
    unit = read_content(write(tmp_path / "a.csv", ["t_us", "pos_rad", "iq_mA"], [1e6 * TIME, POSITION, TORQUE]))
    assert unit.recording.metadata.torque_unit == "A"
    assert unit.recording.torque == pytest.approx(1e-3 * TORQUE, abs=1e-9)
    letter = read_content(write(tmp_path / "b.csv", ["t", "q0", "i0"], [TIME, POSITION, TORQUE])).recording
    assert (letter.metadata.joint, letter.metadata.torque_unit) == ("joint_0", "A")
    told = read_content(write(tmp_path / "c.csv", ["t", "q", "q_des", "tau_cmd"], [TIME, POSITION, POSITION, TORQUE]))
    assert told.recording.metadata.torque_kind == "commanded"
    both = ["time", "q", "motor_torque", "sensor_torque"]
    sensor = read_content(write(tmp_path / "d.csv", both, [TIME, POSITION, TORQUE, 0.5 * TORQUE])).recording
    assert sensor.load_torque == pytest.approx(0.5 * TORQUE, abs=1e-6)


@pytest.mark.parametrize("names", [["time", "velocity", "torque"], ["t", "dq", "tau"]])
def test_a_velocity_without_a_position_is_integrated(names: list[str], tmp_path: Path) -> None:
    path, mapping = write(tmp_path / "log.csv", names, [TIME, VELOCITY, TORQUE]), tmp_path / "log.toml"
    content = read_content(path)
    assert content.recording.position == pytest.approx(POSITION - POSITION[0], abs=1e-3)
    assert any("integral of velocity" in finding.message for finding in content.findings)
    mapping.write_text(render_mapping(path, read_named_log(path)), encoding="utf-8")
    (found,) = convert(path, load_mapping(mapping))
    assert found.recording.position == pytest.approx(content.recording.position, abs=1e-9)


def test_a_velocity_that_no_row_has_beside_a_torque_is_refused(tmp_path: Path) -> None:
    first = np.arange(N_ROWS) < 1
    path = write(tmp_path / "log.csv", ["t", "dq", "tau"], [TIME, np.where(first, np.nan, VELOCITY), TORQUE])
    np.testing.assert_allclose(read_content(path).recording.time.size, N_ROWS - 1)
    alone = write(tmp_path / "b.csv", ["t", "dq", "tau"], [TIME[:2], [np.nan, 1.0], [1.0, np.nan]])
    with pytest.raises(RecordingError, match="fewer than two rows"):
        read_content(alone)


def test_rows_of_joints_in_turns_are_the_log_of_these_joints(tmp_path: Path) -> None:
    joints = ["left", "right"] * N_ROWS
    position = np.stack([POSITION, -POSITION], axis=1).ravel()
    torque = np.stack([TORQUE, -TORQUE], axis=1).ravel()
    path = write(tmp_path / "log.csv", ["t", "joint", "q", "tau"], [np.repeat(TIME, 2), joints, position, torque])
    left, right = read_named_log(path).recordings
    assert (left.metadata.joint, right.metadata.joint) == ("left", "right")
    assert right.position == pytest.approx(-POSITION, abs=1e-6)
    assert len(left) == N_ROWS


def test_a_clock_that_starts_again_begins_another_run(tmp_path: Path) -> None:
    columns = [np.concatenate([one, one[:700]]) for one in (TIME, POSITION, TORQUE)]
    content = read_content(write(tmp_path / "log.csv", ["t", "q", "tau"], columns))
    step = np.diff(content.recording.time)
    assert len(content.recording) == N_ROWS + 700
    assert int(np.argmax(step)) == N_ROWS - 1
    assert step.max() == pytest.approx(1.0)
    assert any("the clock starts again 1 time(s)" in finding.message for finding in content.findings)


@pytest.mark.parametrize(
    ("names", "columns", "message"),
    [
        (["time", "encoder_counts", "torque"], [TIME, 1e3 * POSITION, TORQUE], r"scale = 6\.2832/COUNTS_A_TURN"),
        (["time", "position", "torque_percent"], [TIME, POSITION, TORQUE], "torque = { column = 'torque_percent'"),
        (["time", "position", "pwm"], [TIME, POSITION, TORQUE], "torque = { column = 'pwm', scale = VALUE_OF_ONE }"),
        (["t", "motor_position", "motor_torque"], [TIME, POSITION, TORQUE], "position = { column = 'motor_position'"),
        (["q", "dq", "tau"], [POSITION, VELOCITY, TORQUE], "--row-rate 500"),
        (["t", "q", "tau_a", "tau_b"], [TIME, POSITION, TORQUE, TORQUE], "choose by --channel torque=NAME"),
        (["t", "q", "tau"], [[0.0, 0.1], ["0.2", ""], ["", "0.1"]], "fewer than two rows with both a position"),
        ([], [TIME, POSITION, TORQUE], "write one, such as time,position,torque"),
    ],
)
def test_what_it_does_not_say_is_told_with_what_to_write(
    names: list[str], columns: list[Cells], message: str, tmp_path: Path
) -> None:
    with pytest.raises(RecordingError, match=message):
        read_named_log(write(tmp_path / "log.csv", names, columns))


@pytest.mark.parametrize("clock", ["_time", "timestamp", "stamp_ns"])
def test_a_log_with_another_word_for_its_time_is_no_friction_table(clock: str, tmp_path: Path) -> None:
    columns = [TIME, POSITION, VELOCITY, TORQUE]
    assert not is_friction_table(write(tmp_path / "log.csv", [clock, "position", "velocity", "torque"], columns))
    assert is_friction_table(write(tmp_path / "points.csv", ["velocity", "torque"], columns[2:]))


def test_counts_of_an_encoder_are_no_radians(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", ["time", "pos", "torque"], [TIME, np.round(4096 * POSITION), TORQUE])
    with pytest.raises(RecordingError, match=r"position holds whole numbers alone.*scale = 6\.2832 over the counts"):
        identify_source(path, IdentifySettings())


def test_a_channel_that_there_is_not_is_refused_with_those_that_are(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", ["t", "q", "tau"], [TIME, POSITION, TORQUE])
    with pytest.raises(RecordingError, match=r"no channel 'torqe'.*valid are .*position.*torque"):
        read_content(path, channels={"torqe": "tau"})


def test_the_column_that_was_asked_for_is_the_torque(tmp_path: Path) -> None:
    path = write(tmp_path / "log.csv", ["t", "q", "tau_a", "tau_b"], [TIME, POSITION, TORQUE, 2.0 * TORQUE])
    assert read_content(path, channels={"torque": "tau_b"}).recording.torque == pytest.approx(2.0 * TORQUE, abs=1e-6)


def test_friction_comes_out_of_a_log_in_other_words_and_units(tmp_path: Path) -> None:
    log = joint_log(16.0, 250.0, 11)
    assert log.velocity is not None
    columns = [1e3 * log.time, np.rad2deg(log.position), 1e3 * log.torque]
    path = write(tmp_path / "log.csv", ["Zeit [ms]", "Winkel [deg]", "Moment [mNm]"], columns, ";")
    found = identify_source(path, IdentifySettings(law="coulomb_viscous"))
    assert found.result.parameters["coulomb.coulomb_torque"] == pytest.approx(COULOMB, rel=0.01)
    assert found.result.parameters["viscous.viscous_coefficient"] == pytest.approx(VISCOUS, rel=0.02)


@pytest.mark.parametrize(
    ("names", "mark", "factors"),
    [(["speed [rpm]", "torque [mNm]"], ",", (30 / np.pi, 1e3)), (["omega", "tau"], ";", (1.0, 1.0))],
)
def test_a_table_of_friction_points_says_its_units(
    names: list[str], mark: str, factors: tuple[float, float], tmp_path: Path
) -> None:
    columns = [factors[0] * VELOCITY, factors[1] * TORQUE]
    cells = [[f"{v:.8g}".replace(".", "," if mark == ";" else ".") for v in one] for one in columns]
    path = write(tmp_path / "points.csv", names, cells, mark)
    assert is_friction_table(path)
    table = read_friction_table(path)
    assert table.velocity == pytest.approx(VELOCITY, abs=1e-6)
    assert table.torque == pytest.approx(TORQUE, abs=1e-6)


def test_decimal_commas_between_commas_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_text("velocity,torque\n0,5,1,25\n1,0,1,5\n")
    with pytest.raises(RecordingError, match="numbers with decimal commas need another mark between columns"):
        read_friction_table(path)

"""Columns without a unit, where the log tells it in words above its rows or by a velocity that states one."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import convert, load_mapping
from fricomp.recording.file import read_content

from .test_forms_of_printouts import POSITION, ROWS, TIME, TORQUE, VELOCITY

RULE = re.compile(r"(position|torque) = (\{[^}]*\})")


def write(
    folder: Path, names: str, columns: list[np.ndarray[tuple[int], np.dtype[np.float64]]], above: str = ""
) -> Path:
    rows = [",".join(f"{one:.9g}" for one in row) for row in np.stack(columns, axis=1)]
    (folder / "log.csv").write_text("\n".join([*above.splitlines(), names, *rows]) + "\n")
    return folder / "log.csv"


def convert_as_told(path: Path, folder: Path, skip: int) -> None:
    """Follow the refusal of a log word by word, and require what was measured."""
    with pytest.raises(RecordingError, match=r"write (position|torque)") as refused:
        read_content(path)
    told = dict(RULE.findall(str(refused.value)))
    rules = {"position": '{ column = "q" }', "torque": '{ column = "tau" }'} | told
    lines = ["[source]", "header = true", f"skip_lines = {skip}", "[channels]", 'time = { column = "t" }']
    (folder / "log.toml").write_text("\n".join([*lines, *(f"{name} = {rule}" for name, rule in rules.items())]))
    (found,) = convert(path, load_mapping(folder / "log.toml"))
    assert found.recording.position == pytest.approx(POSITION, rel=1e-2, abs=1e-3)
    assert found.recording.torque == pytest.approx(TORQUE, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize(
    ("above", "position", "torque"),
    [
        ("Bench 3\nTorque is given in mNm\n", 1.0, 1e3),
        ("Bench 3\nall angles in degrees, all torques in Ncm\n", 180.0 / np.pi, 1e2),
        ("# Position: mrad, Torque: N.cm\n", 1e3, 1e2),
        ("// positions: mrev and torque: mNm\n", 500.0 / np.pi, 1e3),
    ],
)
def test_words_above_the_rows_are_asked_about(above: str, position: float, torque: float, tmp_path: Path) -> None:
    path = write(tmp_path, "t,q,tau", [TIME, position * POSITION, torque * TORQUE], above)
    convert_as_told(path, tmp_path, above.count("\n"))


@pytest.mark.parametrize("above", ["Limit: 10 deg\n", "Peak 900 mNm\n", "Kt = 50 mNm/A\n", "No 3, 20 degrees\n"])
def test_the_unit_of_a_number_above_the_rows_is_that_of_no_column(above: str, tmp_path: Path) -> None:
    recording = read_content(write(tmp_path, "t,q_rad,tau", [TIME, POSITION, TORQUE], above)).recording
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


def test_who_names_a_column_has_it_in_si(tmp_path: Path) -> None:
    path = write(tmp_path, "t,q_rad,tau", [TIME, POSITION, TORQUE], "torque in mNm\n")
    recording = read_content(path, channels={"torque": "tau"}).recording
    assert recording.torque == pytest.approx(TORQUE, abs=1e-6)


@pytest.mark.parametrize("factor", [500.0 / np.pi, 10800.0 / np.pi])
def test_a_position_that_moves_far_more_than_its_velocity_says_is_asked_about(factor: float, tmp_path: Path) -> None:
    path = write(tmp_path, "t,q,speed [rpm],tau", [TIME, factor * POSITION, VELOCITY * 30.0 / np.pi, TORQUE])
    convert_as_told(path, tmp_path, 0)


def test_the_velocity_of_a_motor_beside_the_angle_of_its_joint_stays(tmp_path: Path) -> None:
    path = write(tmp_path, "t,q,speed [rpm],tau", [TIME, POSITION, 50.0 * VELOCITY * 30.0 / np.pi, TORQUE])
    assert len(read_content(path).recording) == ROWS.shape[0]


@pytest.mark.parametrize(("factor", "unit"), [(1.0, "rad/s"), (0.5 / np.pi, "turns/s")])
def test_rps_beside_an_angle_in_rad_is_what_makes_one_the_rate_of_the_other(
    factor: float, unit: str, tmp_path: Path
) -> None:
    content = read_content(write(tmp_path, "t,q_rad,vel_rps,tau", [TIME, POSITION, factor * VELOCITY, TORQUE]))
    assert content.recording.velocity == pytest.approx(VELOCITY, abs=1e-6)
    assert any("to be in rad/s" in finding.message for finding in content.findings) is (unit == "rad/s")

"""Torques in parts of a rating and positions in the unit of an axis are asked for, with what to write."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import RecordingWarning, convert, load_mapping, read_recording
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.named.log import read_named_log

_TIME = np.arange(0.0, 12.0, 0.004)
_POSITION = 2.0 * np.sin(1.3 * _TIME) + 0.5 * np.sin(3.1 * _TIME)
_VELOCITY = np.gradient(_POSITION, _TIME)
_TORQUE = 0.1 * np.gradient(_VELOCITY, _TIME) + 1.2 * np.sign(_VELOCITY) + 0.3 * _VELOCITY


def _write(path: Path, position: str, torque: str, scales: tuple[float, float]) -> Path:
    table = np.stack([_TIME, scales[0] * _POSITION, scales[1] * _TORQUE], axis=1)
    np.savetxt(path, table, fmt="%.6f", delimiter=",", header=f"time [s],{position},{torque}", comments="")
    return path


@pytest.mark.parametrize(
    ("position", "torque", "parts"),
    [
        ("Axis01.ActualPosition", "Axis01.TorqueFeedback", 100),
        ("q [rad]", "6077h torque actual value", 1000),
        ("q [rad]", "0x6077_Torque", 1000),
        ("q [rad]", "torque [%]", 100),
        ("q [rad]", "torque_permille", 1000),
    ],
)
def test_a_torque_in_parts_of_a_rating_asks_for_the_rating(
    position: str, torque: str, parts: int, tmp_path: Path
) -> None:
    path = _write(tmp_path / "log.csv", position, torque, (1.0, parts / 8.0))
    with pytest.raises(RecordingError, match="RATED") as refused:
        read_recording(path)
    assert f"torque = {{ column = '{torque}', scale = RATED/{parts} }}" in str(refused.value)


def test_the_line_that_is_asked_for_makes_the_torque(tmp_path: Path) -> None:
    path = _write(tmp_path / "log.csv", "q", "Torque [%]", (1.0, 100.0 / 8.0))
    (tmp_path / "log.toml").write_text(
        '[source]\nheader = true\n[metadata]\ntorque_unit = "N·m"\n[channels]\ntime = { column = "time [s]" }\n'
        'position = { column = "q" }\ntorque = { column = "Torque [%]", scale = 0.08 }\n'
    )
    (named,) = convert(path, load_mapping(tmp_path / "log.toml"))
    recording = named.recording
    np.testing.assert_allclose(recording.torque, _TORQUE, atol=1e-5)


@pytest.mark.parametrize("name", ["Axis_1.fActPosition", "Axis 1 ActPos", "Axis01.ActualPosition"])
def test_a_position_in_the_unit_of_an_axis_that_goes_far_asks_for_the_unit(name: str, tmp_path: Path) -> None:
    path = _write(tmp_path / "log.csv", name, "torque [Nm]", (180.0 / np.pi, 1.0))
    with pytest.raises(RecordingError, match="in the unit of its axis") as refused:
        read_recording(path)
    assert f"position = {{ column = '{name}', unit = \"deg\" }}" in str(refused.value)


def test_a_position_of_an_axis_that_stays_near_is_in_rad(tmp_path: Path) -> None:
    path = _write(tmp_path / "log.csv", "Axis_1.fActPosition", "torque [Nm]", (1.0, 1.0))
    with pytest.warns(RecordingWarning, match="as rad"):
        recording = read_recording(path)
    np.testing.assert_allclose(recording.position, _POSITION, atol=1e-5)


def test_the_mapping_to_edit_asks_for_rating_and_unit(tmp_path: Path) -> None:
    path = _write(tmp_path / "log.csv", "Axis01.ActualPosition", "Axis01.TorqueFeedback", (180.0 / np.pi, 12.5))
    text = inspect_log(path).guess
    assert 'torque = { column = "Axis01.TorqueFeedback", scale = RATED/100 }' in text
    assert 'position = { column = "Axis01.ActualPosition", scale = VALUE_OF_ONE }' in text


def test_an_axis_in_whole_numbers_asks_for_the_counts_of_a_turn(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    table = np.stack([_TIME, np.round(65536.0 / (2.0 * np.pi) * _POSITION), _TORQUE], axis=1)
    np.savetxt(path, table, fmt="%.6g", delimiter=",", header="time [s],ActualPosition,torque [Nm]", comments="")
    with pytest.raises(RecordingError, match=r"scale = 6\.2832/COUNTS_A_TURN \}"):
        read_recording(path)


@pytest.mark.parametrize(("scale", "says"), [(1.0, 'unit = "deg"'), (4096.0 / 6.28, "COUNTS_A_TURN")])
def test_an_encoder_without_whole_numbers_is_asked_for_its_unit_and_not_for_counts(
    scale: float, says: str, tmp_path: Path
) -> None:
    table = np.stack([_TIME, _POSITION if scale == 1.0 else np.round(scale * _POSITION), _TORQUE], axis=1)
    np.savetxt(tmp_path / "log.csv", table, fmt="%.6f", delimiter=",", header="time,/enc/position,tau", comments="")
    with pytest.raises(RecordingError) as refused:
        read_recording(tmp_path / "log.csv")
    assert says in str(refused.value)


@pytest.mark.parametrize(("force", "worth"), [("force_lbf", 0.0254), ("force_N", 1.0)])
def test_a_position_called_in_beside_pounds_is_in_inches(force: str, worth: float, tmp_path: Path) -> None:
    path = _write(tmp_path / "log.csv", "pos_in", force, (1.0, 1.0))
    with pytest.warns(RecordingWarning, match="pos_in"):
        recording = read_recording(path)
    assert recording.metadata.motion == "linear"
    np.testing.assert_allclose(recording.position, worth * _POSITION, atol=1e-5)


@pytest.mark.parametrize(("position", "is_asked"), [("q [rad]", False), ("q_counts", True)])
def test_a_part_of_a_rating_asks_for_the_position_where_that_is_a_devices(
    position: str, is_asked: bool, tmp_path: Path
) -> None:
    rows = np.random.default_rng(2).normal(size=(50, 3)).cumsum(axis=0)
    np.savetxt(tmp_path / "log.csv", rows, delimiter=",", header=f"t,{position},torque_pct", comments="")
    with pytest.raises(RecordingError, match="per cent of the rated torque") as refused:
        read_named_log(tmp_path / "log.csv")
    assert ("what one of the position is" in str(refused.value)) is is_asked


@pytest.mark.parametrize("name", ["Torque command[%]", "torque_setpoint_pct", "torque_pct"])
def test_a_command_in_parts_of_a_rating_that_stands_for_the_torque_is_asked_for_as_the_torque(
    name: str, tmp_path: Path
) -> None:
    path = _write(tmp_path / "log.csv", "q [rad]", name, (1.0, 40.0))
    with pytest.raises(RecordingError, match=r"write torque = \{ column") as refused:
        read_named_log(path)
    assert f"column = {name!r}, scale = RATED/100" in str(refused.value)
    (tmp_path / "log.toml").write_text(inspect_log(path).guess.replace("RATED/100", "0.025"))
    (found,) = convert(path, load_mapping(tmp_path / "log.toml"))
    assert found.recording.torque == pytest.approx(_TORQUE, abs=1e-5)

"""A line of a mapping that a message gives, or that is proposed, can be followed as it stands."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording, convert, load_mapping
from fricomp.recording.inspection.inspection import inspect_log
from fricomp.recording.inspection.mapping_text import render_mapping
from fricomp.recording.named.log import read_named_log
from fricomp.sim_bench.studies.logs.good_log import joint_log

LOG = joint_log(12.0, 250.0, 8)
RATIO = 50.0


def _write(path: Path, head: str, *columns: np.ndarray) -> Path:
    np.savetxt(path, np.column_stack([LOG.time, *columns]), delimiter=",", header=head, comments="", fmt="%.8f")
    return path


def _convert(log: Path, mapping: str) -> Recording:
    path = log.with_suffix(".toml")
    path.write_text(mapping, encoding="utf-8")
    (found,) = convert(log, load_mapping(path))
    return found.recording


@pytest.mark.parametrize(
    ("head", "name", "factor"),
    [
        ("# torque constant: 1.35 Nm/A", "current_mA", 1e3),
        ("# Kt = 1350 mNm/A", "current", 1.0),
        ("# Kt = 1.35 mNm/mA", "iq_mA", 1e3),
    ],
)
def test_a_torque_constant_is_told_for_the_unit_of_the_current(
    head: str, name: str, factor: float, tmp_path: Path
) -> None:
    log = _write(tmp_path / "log.csv", f"{head}\ntime,position,{name}", LOG.position, factor * LOG.torque / 1.35)
    said = next(note for note in read_named_log(log).notes if "torque constant" in note)
    rule = re.search(r"torque = \{.*?\}", said)
    assert rule is not None
    seen = inspect_log(log)
    assert seen.log is not None
    proposed = render_mapping(log, seen.log)
    commented = re.search(r"# (torque = \{.*?\})", proposed)
    assert commented is not None
    for line in (rule.group(), commented.group(1)):
        edited = re.sub(r"(?m)^(current|torque) = .*$", "", proposed).replace('"A"', '"N·m"') + f"{line}\n"
        assert np.allclose(_convert(log, edited).torque, LOG.torque, atol=1e-4)


def test_the_encoder_of_a_motor_comes_to_the_joint_by_the_gear_that_is_stated(tmp_path: Path) -> None:
    assert LOG.velocity is not None
    position, speed = np.rad2deg(RATIO * LOG.position), RATIO * LOG.velocity * 30.0 / np.pi
    head = "# gear ratio: 50\ntime [s],motor position [deg],motor speed [rpm],motor current [mA]"
    log = _write(tmp_path / "log.csv", head, position, speed, 1e3 * LOG.torque)
    with pytest.raises(RecordingError, match=r'unit = "deg", scale = 1/RATIO .*RATIO is 50'):
        read_named_log(log)
    seen = inspect_log(log)
    found = _convert(log, seen.guess)
    assert np.allclose(found.position, LOG.position, atol=1e-6)
    assert found.velocity is not None
    assert np.allclose(found.velocity, LOG.velocity, atol=1e-6)


def test_the_gear_is_asked_for_where_nothing_states_it_and_units_make_no_other_motion(tmp_path: Path) -> None:
    assert LOG.velocity is not None
    position, speed = np.rad2deg(RATIO * LOG.position), RATIO * LOG.velocity * 30.0 / np.pi
    head = "time [s],motor position [deg],motor speed [rpm],motor current [mA]"
    guess = inspect_log(_write(tmp_path / "log.csv", head, position, speed, 1e3 * LOG.torque)).guess
    assert "scale = 1/RATIO" in guess
    assert "another unit" not in guess


def test_what_the_checks_refuse_stands_beside_its_column(tmp_path: Path) -> None:
    log = _write(tmp_path / "log.csv", "time,position,torque", LOG.position, -LOG.torque)
    seen = inspect_log(log)
    assert seen.log is not None
    (line,) = (one for one in render_mapping(log, seen.log, seen.findings).splitlines() if one.startswith("torque ="))
    assert "# torque against the motion" in line
    assert "sign = -1" in line


def test_a_number_that_is_to_be_worked_out_is_told_as_such(tmp_path: Path) -> None:
    mapping = tmp_path / "log.toml"
    mapping.write_text('[channels]\ntorque = { column = "a", scale = 0.3/1000 }\n', encoding="utf-8")
    with pytest.raises(RecordingError, match=r"line 2: TOML works nothing out: write the number that 0\.3/1000 is"):
        load_mapping(mapping)


def test_the_sign_of_a_position_in_counts_is_in_the_line_to_write(tmp_path: Path) -> None:
    counts = np.round((LOG.position - float(np.mean(LOG.position))) * 4096 / (2.0 * np.pi))
    stored = np.where(counts < 0.0, 2.0**15 - counts, counts)
    log = _write(tmp_path / "log.csv", "time,position [counts],torque_Nm", stored, LOG.torque)
    with pytest.raises(RecordingError, match=r"COUNTS_A_TURN, sign_bit = 15 "):
        read_named_log(log)
    assert "sign_bit = 15" in inspect_log(log).guess

"""What a resumed fleet keeps, does again and removes, and what it makes of damaged files."""

from dataclasses import replace
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError, RecordingError
from fricomp.fleet import FleetJoint, FleetRow, SerialExecutor, read_rows, run_fleet
from tests.fleet.working import count_bytes

pytest.importorskip("pyarrow")

_SERIAL = (SerialExecutor(), 1)


@pytest.fixture
def joint(tmp_path: Path) -> FleetJoint:
    """A joint with a recording and a simulation."""
    (tmp_path / "elbow.csv").write_bytes(b"x")
    (tmp_path / "robot.xml").write_text("<mujoco/>")
    return FleetJoint("elbow", (tmp_path / "elbow.csv",), tmp_path / "robot.xml")


def _resume(joint: FleetJoint, out: Path) -> FleetRow:
    (row,) = run_fleet([joint], count_bytes, out, _SERIAL, settings={}, resume=True)
    return row


@pytest.mark.parametrize("change", [{"simulation": Path("typo.xml")}, {"joint": "wrist"}])
def test_a_joint_that_is_asked_for_otherwise_is_not_kept(
    change: dict[str, object], joint: FleetJoint, tmp_path: Path
) -> None:
    assert _resume(joint, tmp_path / "out")["error"] == ""
    joint.recordings[0].unlink()
    assert _resume(joint, tmp_path / "out")["error"] == ""
    assert "cannot read" in _resume(replace(joint, **change), tmp_path / "out")["error"]  # type: ignore[arg-type]


def test_a_simulation_out_of_reach_is_said_and_its_results_are_removed(joint: FleetJoint, tmp_path: Path) -> None:
    out = tmp_path / "out"
    _resume(joint, out)
    assert (out / "elbow" / "report.html").exists()
    assert joint.simulation is not None
    joint.simulation.unlink()
    assert f"cannot read {joint.simulation}" in _resume(joint, out)["error"]
    assert list((out / "elbow").iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"PAR1xx"])
def test_a_damaged_row_is_done_again(content: bytes, joint: FleetJoint, tmp_path: Path) -> None:
    out = tmp_path / "out"
    _resume(joint, out)
    (out / "rows" / "elbow.parquet").write_bytes(content)
    assert read_rows(out) == []
    assert _resume(joint, out)["bytes"] == 1


@pytest.mark.parametrize("content", ["", '{"comm', "[]"])
def test_damaged_settings_are_refused(content: str, joint: FleetJoint, tmp_path: Path) -> None:
    out = tmp_path / "out"
    _resume(joint, out)
    (out / "fleet.json").write_text(content)
    with pytest.raises(RecordingError, match=r"fleet.json .*: give another --out"):
        _resume(joint, out)


def test_settings_are_written_once(joint: FleetJoint, tmp_path: Path) -> None:
    out = tmp_path / "out"
    _resume(joint, out)
    (out / "fleet.json").write_text("{ }")  # the same settings, in a writing of their own
    _resume(joint, out)
    assert (out / "fleet.json").read_text() == "{ }"


def test_a_joint_that_is_refused_before_it_runs_keeps_its_folder(joint: FleetJoint, tmp_path: Path) -> None:
    def refuse(joint: FleetJoint, folder: Path) -> None:
        assert folder == tmp_path / "out" / "elbow"
        raise DiagnosisError("there is a calibration")

    out = tmp_path / "out"
    _resume(joint, out)
    joint.recordings[0].write_bytes(b"xx")
    (row,) = run_fleet([joint], count_bytes, out, _SERIAL, settings={}, resume=True, check=refuse)
    assert row["error"] == "there is a calibration"
    assert (out / "elbow" / "report.html").read_text() == "elbow: [1]"
    assert _resume(joint, out)["bytes"] == 2

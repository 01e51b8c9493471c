"""Fleets of `diagnose` and `identify` on the command line: what they refuse, and what they tell of single joints."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from fricomp.cli.fleet import say_same_joint
from fricomp.cli.main import app
from fricomp.diagnosis import DIAGNOSIS_SCHEMA, DiagnosisRecord
from fricomp.diagnosis.report import build_fleet_row
from fricomp.errors import IdentificationError, RecordingError
from fricomp.fleet import FleetJoint, FleetRow, read_rows
from fricomp.laws import Coulomb, FrictionLaw
from fricomp.model import FrictionModel, Provenance, save_model

pytest.importorskip("pyarrow")


@pytest.fixture
def diagnosed(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Names of the joints as they are diagnosed, which takes no time."""
    names: list[str] = []

    def at_once(joint: FleetJoint, out: Path, **_: Any) -> FleetRow:
        names.append(joint.name)
        return build_fleet_row(DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, verdict="consistent"))

    monkeypatch.setattr("fricomp.cli.diagnosis.fleet._diagnose_one", at_once)
    return names


def _call(command: str, *arguments: object) -> Result:
    call = [command, *map(str, arguments), "--executor", "serial"]
    return CliRunner().invoke(app, call, env={"COLUMNS": "300"})


def test_a_fleet_writes_over_no_calibration_and_no_input(tmp_path: Path, diagnosed: list[str]) -> None:
    model = tmp_path / "runs" / "elbow" / "friction.json"
    model.parent.mkdir(parents=True)
    save_model(FrictionModel(FrictionLaw((Coulomb(1.0),)), provenance=Provenance(method="calibrate")), model)
    for name in ("elbow", "knee"):
        (tmp_path / f"{name}.csv").write_text("time,position,torque\n")
    table, out = tmp_path / "joints.csv", tmp_path / "runs"
    table.write_text("recording,friction\nelbow.csv,runs/elbow/friction.json\nknee.csv,\n")
    before = model.read_bytes()
    assert _call("diagnose", table, "--out", out).exit_code == 0
    assert diagnosed == ["knee"]
    assert "would write over its input" in read_rows(out)[0]["error"]
    table.write_text("recording\nelbow.csv\nknee.csv\n")
    assert _call("diagnose", table, "--out", out, "--resume").exit_code == 0
    assert "holds friction.json, which a diagnosis writes too" in read_rows(out)[0]["error"]
    assert model.read_bytes() == before


def test_a_fleet_is_not_gone_on_with_other_files_for_all_joints(tmp_path: Path, diagnosed: list[str]) -> None:
    recording, simulated, loop = (tmp_path / name for name in ("elbow.csv", "simulated.csv", "loop.toml"))
    for path in (recording, simulated, loop):
        path.write_text("1")
    call = (recording, "--each", "--simulated", simulated, "--controller", loop, "--out", tmp_path / "out", "--resume")
    assert [_call("diagnose", *call).exit_code for _ in range(2)] == [0, 0]
    assert diagnosed == ["elbow"]
    for path in (simulated, loop):
        path.write_text("2")
        refused = _call("diagnose", *call).exception
        assert isinstance(refused, RecordingError)
        assert str(path) in str(refused)
        path.write_text("1")
    assert _call("diagnose", *call).exit_code == 0


def test_one_simulation_may_be_written_in_two_ways(
    tmp_path: Path, diagnosed: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("elbow.csv", "robot.xml"):
        Path(name).write_text("1")
    for simulation in ("robot.xml", tmp_path / "robot.xml"):
        call = ("elbow.csv", "--each", "--simulation", simulation, "--out", "out", "--resume")
        assert _call("diagnose", *call).exit_code == 0
    assert diagnosed == ["elbow"]


def test_a_law_that_no_joint_can_be_identified_with_begins_no_fleet(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / f"{name}.csv").write_text("velocity,torque\n1,1\n")
    call = ("identify", tmp_path / "a.csv", tmp_path / "b.csv", "--law", "foo", "--out", tmp_path / "out")
    refused = _call(*call).exception
    assert isinstance(refused, IdentificationError)
    assert "unknown" in str(refused)
    assert not (tmp_path / "out").exists()


def test_what_the_checks_warn_of_is_told_of_a_fleet(tmp_path: Path) -> None:
    speed = np.geomspace(0.3, 115.0, 40)
    velocity = np.concatenate([-speed, speed])
    torque = (0.15 + 0.45 * np.exp(-((velocity / 2.9) ** 2))) * np.sign(velocity)
    points = np.column_stack([velocity, torque])
    (tmp_path / "joints").mkdir()
    np.savetxt(tmp_path / "joints" / "a.csv", points, delimiter=",", header="velocity,torque", comments="")
    call = (tmp_path / "joints", "--method", "least_squares", "--law", "coulomb", "--out", tmp_path / "out")
    done = _call("identify", *call)
    assert done.exit_code == 0, done.output
    assert "a: Careful: velocity reaches 115 rad/s: is it in degrees" in done.output
    assert read_rows(tmp_path / "out")[0]["warnings"].startswith("Careful: velocity reaches 115 rad/s")


@pytest.mark.parametrize(("joints", "is_told"), [(("elbow", "elbow"), True), (("elbow", "knee"), False)])
def test_files_of_one_joint_are_told_with_the_line_that_fits_them_together(
    joints: tuple[str, str], is_told: bool, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, joint in zip("ab", joints, strict=True):
        (tmp_path / name).mkdir()
        model = FrictionModel(FrictionLaw((Coulomb(1.0),)), provenance=Provenance(method="identify"), joint=joint)
        save_model(model, tmp_path / name / "friction.json")
    say_same_joint([{"name": "a", "error": ""}, {"name": "b", "error": ""}], ["my logs"], tmp_path)
    told = " ".join(capsys.readouterr().out.split())
    assert ("'fricomp diagnose 'my logs' --out " in told) is is_told

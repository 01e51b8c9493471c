"""The folder of an arm: what is written can be read, and is what was found."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.arm import load_arm_record
from fricomp.arm.record import arm_json_schema
from fricomp.cli.main import app
from fricomp.diagnosis import load_diagnosis
from fricomp.errors import DiagnosisError
from fricomp.model import load_model
from fricomp.recording import write_recording

from .moving_arm import MASSES, record_arm, write_arm

RECORDED = "2026-03-14T10:00:00.000+00:00"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, drawn_charts: None) -> Path:
    """What `fricomp diagnose` writes, and draws, of an arm whose hand is heavier than in the simulation."""
    root = tmp_path_factory.mktemp("arm")
    truth = write_arm(root, (MASSES[0], MASSES[1], MASSES[2] + 1.0))
    (root / "log").mkdir()
    for one in record_arm(truth):
        write_recording(one.with_metadata(recorded=RECORDED), root / "log" / f"{one.metadata.joint}.csv")
    command = ["diagnose", str(root / "log"), "--simulation", str(write_arm(root)), "--out", str(root / "out")]
    done = CliRunner().invoke(app, command)
    assert done.exit_code == 0, done.output
    assert "Links that are off: hand (" in done.output
    return root / "out"


@pytest.mark.slow
def test_one_table_of_all_joints_is_enough(tmp_path: Path) -> None:
    """Columns of lists, joints called by number: refused with the mapping to write, examined with it."""
    pyarrow = pytest.importorskip("pyarrow")
    from pyarrow import parquet

    simulation, series = write_arm(tmp_path), record_arm(write_arm(tmp_path), duration=20.0)
    columns = {
        name: np.stack([getattr(one, name) for one in series], axis=1).tolist() for name in ("position", "torque")
    }
    parquet.write_table(pyarrow.table({"time": series[0].time, **columns}), tmp_path / "log.parquet")
    command = ["identify", str(tmp_path / "log.parquet"), "--out", str(tmp_path / "out"), "--simulation"]
    refused = CliRunner().invoke(app, [*command, str(simulation)])
    line = re.search(r"--match (\S+)$", str(refused.exception))
    assert line is not None, refused.exception
    done = CliRunner().invoke(app, [*command, str(simulation), "--match", line.group(1)])
    assert done.exit_code == 0, done.output
    assert load_model(tmp_path / "out" / "joints" / "wrist" / "friction.json").joint == "wrist"


def test_an_arm_without_its_simulation_is_told_to_give_it(tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text("time,q_1,q_2,tau_1,tau_2\n" + "".join(f"{0.01 * k},1,2,3,4\n" for k in range(9)))
    done = CliRunner().invoke(app, ["diagnose", str(tmp_path / "log.csv"), "--out", str(tmp_path / "out")])
    assert "log of 2 joints, joint_1, joint_2: give the --simulation" in str(done.exception)
    assert "take one by --joint NAME" in str(done.exception)


@pytest.mark.filterwarnings("ignore::fricomp.recording.RecordingWarning")
def test_the_joint_of_a_log_that_moves_alone_is_taken_without_a_simulation(tmp_path: Path) -> None:
    lines = ["time,q_1,q_2,tau_1,tau_2", *(f"{0.01 * k},{math.sin(0.02 * k):.6f},2,3,4" for k in range(300))]
    (tmp_path / "log.csv").write_text("\n".join(lines))
    done = CliRunner().invoke(app, ["diagnose", str(tmp_path / "log.csv"), "--out", str(tmp_path / "out")])
    assert "lasts 2.99 s, and a diagnosis needs at least 5 s" in str(done.exception)  # of that joint


def test_the_models_of_the_joints_say_when_they_were_recorded(folder: Path) -> None:
    models = [load_model(one) for one in sorted((folder / "joints").glob("*/friction.json"))]
    assert [one.provenance.notes["recorded"] for one in models] == [RECORDED] * 3


def test_the_record_can_be_read_again(folder: Path) -> None:
    record = load_arm_record(folder / "arm.json")
    assert [joint.name for joint in record.joints] == ["shoulder", "elbow", "wrist"]
    assert record.held_joints == ("grip",)


def test_every_joint_has_a_model_that_loads(folder: Path) -> None:
    levels = {"shoulder": 1.2, "elbow": 0.8, "wrist": 0.3}
    for name, level in levels.items():
        model = load_model(folder / "joints" / name / "friction.json")
        assert model.joint == name
        assert model.law.torque(1e-6) == pytest.approx(level, abs=0.06)


def test_every_joint_has_a_diagnosis_and_a_page_that_the_page_of_the_arm_leads_to(folder: Path) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8")
    for name in ("shoulder", "elbow", "wrist"):
        record = load_diagnosis(folder / "joints" / name / "diagnosis.json")
        assert (record.verdict, record.joint, record.effects) == ("parameters", name, ())
        assert record.errors is not None
        assert record.heldout is not None
        assert record.heldout.rmse_after < 0.04  # of 0.03 N·m of white noise
        assert (folder / "joints" / name / "report.html").stat().st_size > 1000
        assert f'href="joints/{name}/report.html"' in page


def test_the_corrected_simulation_weighs_what_was_found(folder: Path) -> None:
    record, model = load_arm_record(folder / "arm.json"), mujoco.MjModel.from_xml_path(str(folder / "arm.xml"))
    for link in record.links:
        carried = 0.05 if link.name == "hand" else 0.0
        assert model.body(link.name).mass[0] + carried == pytest.approx(link.mass.value, rel=1e-4)
    assert np.all(np.isfinite(model.body_inertia))
    assert model.body("finger").mass[0] == pytest.approx(0.05)


def test_the_written_files_predict_what_they_were_not_fitted_to(folder: Path) -> None:
    """The hand is a kilogram heavier than simulated: torque and motion of all joints in line with it are better."""
    record = load_arm_record(folder / "arm.json")
    for joint in record.joints:
        files = joint.files
        assert files is not None
        assert files.torque < 1.2 * files.torque_fit + 0.002
        assert files.best_gain is not None
        assert files.best_gain.value == pytest.approx(1.0, abs=0.02)
        assert any("would have been compensated best" in one and joint.name in one for one in record.sentences)
        assert [each.after for each in files.positions] == pytest.approx([0.1, 0.5, 2.0], abs=0.01)
        if joint.name != "wrist":
            assert files.torque < 0.2 * files.torque_simulation
            assert files.positions[1].files < 0.3 * files.positions[1].simulation


def test_the_record_obeys_the_schema_that_is_published(folder: Path) -> None:
    """Where the record changes, write `json.dumps(arm_json_schema(), indent=2)` there."""
    published = json.loads((Path(__file__).parents[2] / "docs" / "arm.schema.json").read_text(encoding="utf-8"))
    assert published == json.loads(json.dumps(arm_json_schema()))
    pytest.importorskip("jsonschema").validate(json.loads((folder / "arm.json").read_bytes()), published)


def test_the_page_names_every_joint(folder: Path) -> None:
    page = (folder / "report.html").read_text(encoding="utf-8")
    assert all(name in page for name in ("shoulder", "elbow", "wrist"))
    assert (folder / "errors.png").stat().st_size > 1000


def test_a_damaged_record_is_refused(tmp_path: Path) -> None:
    (tmp_path / "arm.json").write_text("{}")
    with pytest.raises(DiagnosisError, match="record of an arm"):
        load_arm_record(tmp_path / "arm.json")

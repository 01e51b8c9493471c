"""`fricomp export`, `check-loop` and `run` on the command line."""

from __future__ import annotations

import json
import sys
import xml.etree.ElementTree as ET
from dataclasses import replace
from pathlib import Path

import pytest

from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, Validity, load_model, save_model

from .called import call as fricomp


@pytest.fixture
def model(tmp_path: Path) -> Path:
    curves = StribeckCurve(0.15, 0.60, 0.05, 0.02), StribeckCurve(0.20, 0.70, 0.05, 0.03)
    law = FrictionLaw((BidirectionalStribeck(*curves),))
    save_model(FrictionModel(law, joint="elbow", validity=Validity(velocity=(-1.0, 1.0))), tmp_path / "friction.json")
    return tmp_path / "friction.json"


def test_export_prints_c_and_says_what_is_kept(model: Path) -> None:
    done = fricomp("export", model, "--to", "c")
    assert done.returncode == 0
    assert "friction_elbow_torquef" in done.stdout
    assert "1e-12" in done.stderr


def test_export_refuses_an_unusable_model_unless_told_otherwise(model: Path) -> None:
    known = load_model(model)
    doubtful = replace(known, provenance=replace(known.provenance, status="not_identifiable", message="too fast"))
    save_model(doubtful, model)
    refused = fricomp("export", model, "--to", "c")
    assert refused.returncode == 2
    assert "not_identifiable: too fast" in refused.stderr
    assert fricomp("export", model, "--to", "c", "--any-status").returncode == 0


@pytest.mark.parametrize("format", ["mjcf", "urdf"])
def test_export_refuses_an_empty_file_to_write_into(model: Path, tmp_path: Path, format: str) -> None:
    empty, out = tmp_path / "empty.xml", tmp_path / "out.xml"
    empty.touch()
    done = fricomp("export", model, "--to", format, "--into", empty, "--out", out)
    assert done.returncode == 2
    assert "is not XML" in done.stderr
    assert not out.exists()


def test_export_writes_into_a_robot_and_states_the_loss(model: Path, tmp_path: Path) -> None:
    robot, out = tmp_path / "robot.xml", tmp_path / "out.xml"
    robot.write_text('<mujoco><worldbody><body><joint name="knee"/></body></worldbody></mujoco>')
    done = fricomp("export", model, "--to", "mjcf", "--into", robot, "--joint", "knee", "--out", out)
    assert done.returncode == 0
    assert "RMS" in done.stderr
    element = ET.parse(out).find("actuator/dcmotor")
    assert element is not None
    assert element.attrib["joint"] == "knee"


def test_export_joins_the_settings_of_several_joints_and_refuses_one_joint_twice(model: Path, tmp_path: Path) -> None:
    other = tmp_path / "wrist.json"
    other.write_text(model.read_text().replace('"joint": "', '"joint": "wrist_', 1))
    done = fricomp("export", model, other, "--to", "isaaclab")
    assert done.returncode == 0, done.stderr
    assert "wrist_" in done.stdout
    twice = fricomp("export", model, model, "--to", "isaaclab")
    assert twice.returncode == 2
    assert "give one model for each joint" in twice.stderr


def test_export_to_json_is_the_model(model: Path, tmp_path: Path) -> None:
    assert fricomp("export", model, "--to", "json", "--out", tmp_path / "copy.json").returncode == 0
    assert load_model(tmp_path / "copy.json").law == load_model(model).law


@pytest.mark.parametrize("to", ["c", "onnx"])
def test_export_makes_the_folder_of_its_file(model: Path, tmp_path: Path, to: str) -> None:
    out = tmp_path / "new" / "deeper" / "file"
    assert fricomp("export", model, "--to", to, "--out", out).returncode == 0
    assert out.is_file()
    refused = fricomp("export", model, "--to", to, "--out", model / "new" / "file")
    assert refused.returncode == 2
    assert "cannot make the folder" in refused.stderr


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--to", "onnx"), "say where with --out"),
        (("--to", "c", "--prefix", "1a"), "not a C name"),
        (("--to", "mjcf", "--into", "missing.xml"), "missing.xml"),
        (("--to", "mjcf", "--into", sys.executable), "is no text in UTF-8"),
        (("--to", "c", "--period", "nan"), "the period must be positive"),
    ],
)
def test_export_errors_are_one_sentence(model: Path, arguments: tuple[str, ...], sentence: str) -> None:
    done = fricomp("export", model, *arguments)
    assert done.returncode == 2
    assert sentence in done.stderr
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_check_loop_says_safe_or_exits_with_one(model: Path) -> None:
    good = fricomp("check-loop", model, "--inertia", 0.1, "--bandwidth", 10, "--delay", 0.002)
    assert good.returncode == 0
    assert "Safe." in good.stdout
    assert "torque not limited" in good.stdout
    assert "not bounded: give --torque-limit" in " ".join(good.stdout.split())
    limits = ("--torque-limit", 5, "--torque-rate", 100)
    bad = fricomp("check-loop", model, "--inertia", 0.05, "--bandwidth", 10, "--delay", 0.012, *limits)
    assert bad.returncode == 1
    assert "Not safe" in bad.stdout
    said = " ".join(bad.stdout.split())
    assert "at most 5 N·m, 100 N·m/s" in said
    assert "sensor mirrored" in said
    assert "travel until the gate stops it" in said


@pytest.mark.parametrize("option", ["--torque-limit", "--torque-rate"])
def test_check_loop_takes_no_limit_of_zero_for_none(model: Path, option: str) -> None:
    done = fricomp("check-loop", model, "--inertia", 0.1, "--bandwidth", 10, option, 0)
    assert done.returncode == 2
    assert "must be positive" in done.stderr
    assert "Safe." not in done.stdout


@pytest.mark.parametrize("limit", [-2, 0, "nan", "inf"])
def test_check_loop_refuses_a_velocity_limit_that_is_none(model: Path, limit: object) -> None:
    done = fricomp("check-loop", model, "--inertia", 0.1, "--bandwidth", 10, "--velocity-limit", limit)
    assert done.returncode == 2
    assert "--velocity-limit must be above 0 and finite" in done.stderr


def test_check_loop_states_the_fall_of_friction_in_its_unit(model: Path) -> None:
    done = fricomp("check-loop", model, "--inertia", 0.1, "--bandwidth", 5)
    assert "N·m·s/rad and the loop damps with 6.28 N·m·s/rad only" in done.stdout


def test_check_loop_needs_gains(model: Path) -> None:
    done = fricomp("check-loop", model, "--inertia", 0.1)
    assert done.returncode == 2
    assert "--bandwidth" in done.stderr


def test_run_shows_the_gain_and_keeps_recordings(model: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    done = fricomp("run", model, "--frequency", 0.5, "--cycles", 1, "--out", tmp_path / "run")
    assert done.returncode == 0, done.stderr
    figures = json.loads((tmp_path / "run" / "figures.json").read_text())
    assert figures["with"]["rms_error"][0] < 0.3 * figures["without"]["rms_error"][0]
    names = {path.name for path in (tmp_path / "run").iterdir()}
    assert {"run-0.png", "timing.png", "with_compensation_joint.csv", "without_compensation_joint.csv"} <= names


def test_run_wants_a_model_for_every_joint(model: Path, tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    done = fricomp("run", model, model, "--out", tmp_path / "run")
    assert done.returncode == 2
    assert "the bus needs 1 of each: give as many models (got 2)" in done.stderr


@pytest.mark.slow
def test_bench_tracking_does_only_what_is_asked(tmp_path: Path) -> None:
    pytest.importorskip("mujoco")
    done = fricomp("bench", "tracking", "--quick", "--only", "loops", "--out", tmp_path)
    assert done.returncode == 0, done.stderr
    figures = json.loads((tmp_path / "figures.json").read_text())
    assert list(figures) == ["loops"]
    assert {row["joint"] for row in figures["loops"]} == {"moderate", "table_i"}
    assert all(row["standstill_travel"] < 5e-5 for row in figures["loops"])

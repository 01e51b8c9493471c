"""The evaluator on the files that users have: MJCF and URDF in MuJoCo, networks, folders, the command."""

from __future__ import annotations

import json
from pathlib import Path

import mujoco
import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp.cli.main import app
from fricomp.errors import ModelFileError, RecordingError, SimulationFileError
from fricomp.evaluation import evaluate, read_model
from fricomp.evaluation.simulated_joint import read_simulated_joint
from fricomp.export import apply_to_mjcf, closed_form_graph, export_mjcf, save_graph
from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, save_model
from fricomp.recording import Recording, write_recording

ARM = """<mujoco><option timestep="0.001" integrator="implicitfast"/><worldbody><body>
<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><joint name="shoulder" axis="0 0 1"/><body pos="0.2 0 0">
<inertial pos="0.2 0 0" mass="0.5" diaginertia="0.01 0.01 0.01"/><joint name="elbow" axis="0 1 0" {friction}/>
</body></body></worldbody><actuator><position name="hold" joint="shoulder" kp="10"/><motor name="drive" joint="elbow"/>
</actuator><sensor><jointpos joint="shoulder"/></sensor><keyframe><key qpos="0 0.3"/></keyframe></mujoco>"""
FRICTION = 'damping="0.1" frictionloss="0.3"'
RATE = 500.0


def _write_arm(folder: Path, friction: str = FRICTION, name: str = "arm.xml") -> Path:
    path = folder / name
    path.write_text(ARM.format(friction=friction))
    return path


def _record(path: Path, duration: float = 12.0) -> Recording:
    """The elbow in MuJoCo, in closed loop, the shoulder held by an equality of nothing but its own stiffness."""
    spec = mujoco.MjSpec.from_file(str(path))
    spec.joint("shoulder").armature = 1e6
    model = spec.compile()
    data = mujoco.MjData(model)
    substeps, n = round(1.0 / RATE / model.opt.timestep), round(duration * RATE)
    t = np.arange(n) / RATE
    reference = 0.8 * np.sin(2.0 * np.pi * 0.2 * t) + 0.2 * np.sin(2.0 * np.pi * 0.7 * t)
    rows = np.empty((3, n))
    for k in range(n):
        drive = 30.0 * (reference[k] - data.qpos[1]) - 1.5 * data.qvel[1]
        rows[:, k] = data.qpos[1], data.qvel[1], drive
        data.ctrl[1] = drive
        mujoco.mj_step(model, data, substeps)
    recording = Recording(t, rows[0], rows[2], velocity=rows[1])
    return recording.with_metadata(joint="elbow")


def test_a_simulation_explains_what_it_made_itself(tmp_path: Path) -> None:
    path = _write_arm(tmp_path)
    found = evaluate(path, _record(path))
    assert found.torque.rms < 0.02 * found.torque.recorded
    for one in found.position:
        assert one.median < 0.01 * one.travel


def test_the_drives_and_other_joints_of_a_file_play_no_part(tmp_path: Path) -> None:
    path = _write_arm(tmp_path)
    joint = read_simulated_joint(path, "elbow")
    assert (joint.model.nv, joint.model.nu, joint.model.nsensor) == (1, 0, 0)
    dynamics = joint.measure_dynamics()
    assert dynamics.inertia == pytest.approx(0.01 + 0.5 * 0.2**2)
    assert abs(dynamics.gravity_cosine) == pytest.approx(0.5 * 9.81 * 0.2, rel=1e-6)


def test_an_exported_motor_keeps_its_friction(tmp_path: Path) -> None:
    curve = StribeckCurve(0.3, 0.3, 0.1, 0.1)
    export = export_mjcf(FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),))))
    plain = _write_arm(tmp_path, friction="")
    moved = tmp_path / "friction.xml"
    moved.write_text(apply_to_mjcf(export, plain.read_text(), "elbow"))
    recording = _record(_write_arm(tmp_path, name="true.xml"))
    without, with_motor = (evaluate(path, recording) for path in (plain, moved))
    assert with_motor.torque.rms < 0.2 * without.torque.rms


def test_friction_alone_takes_the_rigid_body_of_a_simulation(tmp_path: Path) -> None:
    path = _write_arm(tmp_path)
    recording = _record(path)
    curve = StribeckCurve(0.3, 0.3, 0.1, 0.1)
    friction = FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),)))
    found = evaluate(friction, recording, simulation=path)
    assert found.torque.rms < 0.05 * found.torque.recorded
    assert any("those of the simulation" in note for note in found.notes)


@pytest.mark.parametrize("terms", [(), (Cogging(0.05, 0.02, 20.0),)])
def test_a_network_of_the_law_has_the_errors_of_the_law(terms: tuple[Cogging, ...], tmp_path: Path) -> None:
    path = _write_arm(tmp_path)
    recording = _record(path)
    curve = StribeckCurve(0.25, 0.35, 0.1, 0.1)
    dynamics = read_simulated_joint(path, "elbow").measure_dynamics()
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve), *terms)), dynamics=dynamics)
    save_model(model, tmp_path / "friction.json")
    save_graph(closed_form_graph([model]), tmp_path / "friction.onnx")
    law, network = (evaluate(tmp_path / name, recording) for name in ("friction.json", "friction.onnx"))
    assert network.torque.rms == pytest.approx(law.torque.rms, rel=1e-3)
    assert network.position[0].median == pytest.approx(law.position[0].median, rel=0.05)
    assert evaluate(tmp_path, recording).torque == law.torque  # the folder of a diagnosis


def test_files_that_do_not_fit_say_what_to_do(tmp_path: Path) -> None:
    path = _write_arm(tmp_path)
    recording = _record(path, duration=4.0)
    with pytest.raises(SimulationFileError, match=r"say which of its joints is meant: 'shoulder', 'elbow'"):
        evaluate(path, recording.with_metadata(joint="joint"))
    with pytest.raises(SimulationFileError, match=r"has no joint 'wrist'"):
        evaluate(path, recording, joint="wrist")
    with pytest.raises(ModelFileError, match=r"is a simulation itself: leave out the other one"):
        evaluate(path, recording, simulation=path)
    with pytest.raises(RecordingError, match=r"give a recording in the model's unit"):
        evaluate(path, recording.with_metadata(torque_unit="A"))
    with pytest.raises(ModelFileError, match=r"give the simulation of this joint"):
        read_model(
            FrictionModel(FrictionLaw((Cogging(1.0, 0.0, 3.0),)), torque_unit="A"), simulation=path, joint="elbow"
        )


def test_the_command_prints_and_gives_json(tmp_path: Path) -> None:
    path = _write_arm(tmp_path)
    write_recording(_record(path), tmp_path / "elbow.csv")
    asked = ["evaluate", str(path), str(tmp_path / "elbow.csv")]
    run = CliRunner().invoke(app, [*asked, "--json", "--from", "2", "--to", "11"])
    assert run.exit_code == 0, run.output
    figures = json.loads(run.output)
    assert figures["schema"] == "fricomp.evaluation/1"
    assert figures["torque"]["unit"] == "N·m"
    assert figures["torque"]["duration"] < 9.0
    shown = CliRunner().invoke(app, [*asked, "--band", "10"])
    assert "in the band from 0 to 10 Hz" in " ".join(shown.output.split())

"""A whole arm is evaluated: simulations explain what they made, and friction models give the same as MuJoCo's own."""

from __future__ import annotations

from pathlib import Path

import mujoco
import numpy as np
import pytest

from fricomp.errors import RecordingError, SimulationFileError
from fricomp.evaluation import evaluate_arm
from fricomp.laws import Coulomb, FrictionLaw, LoadCoulomb, LuGre, SpringTorque, StribeckCurve, Viscous
from fricomp.model import FrictionModel, save_model
from fricomp.recording import Recording, RecordingMetadata

STICKING = 'solreffriction="0.002 1" solimpfriction="0.9999 0.9999 0.001 0.5 2"'
ARM = """<mujoco><option timestep="0.001" integrator="implicitfast"/><worldbody><body>
<inertial pos="0.1 0 0" mass="1" diaginertia="0.01 0.01 0.01"/><joint name="a" axis="0 1 0" armature="0.05" {0}/>
<body pos="0.2 0 0"><inertial pos="0.2 0 0" mass="0.5" diaginertia="0.01 0.01 0.01"/>
<joint name="b" axis="0 1 0" armature="0.02" {1}/><body pos="0.3 0 0"><inertial pos="0.02 0 0" mass="0.1"
diaginertia="1e-3 1e-3 1e-3"/><joint name="grip" type="slide" axis="1 0 0"/></body></body></body></worldbody>
<actuator><motor name="ma" joint="a"/><motor name="mb" joint="b"/></actuator></mujoco>"""
RATE, LEVELS, DRAG = 500.0, (0.6, 0.3), (0.3, 0.1)


def _write(folder: Path, levels: tuple[float, float] = LEVELS) -> Path:
    path = folder / f"arm-{levels[0]}.xml"
    own = (f'damping="{d}" frictionloss="{f}" {STICKING}' for d, f in zip(DRAG, levels, strict=True))
    path.write_text(ARM.format(*own))
    return path


def _record(path: Path, duration: float = 10.0) -> list[Recording]:
    spec = mujoco.MjSpec.from_file(str(path))
    spec.delete(spec.joint("grip"))
    model = spec.compile()
    data, n = mujoco.MjData(model), round(duration * RATE)
    substeps = round(1.0 / RATE / model.opt.timestep)
    t = np.arange(n) / RATE
    reference = np.stack([0.6 * np.sin(2.0 * np.pi * 0.23 * t), 0.5 * np.sin(2.0 * np.pi * 0.41 * t + 1.0)], axis=1)
    data.qpos[:] = reference[0]
    rows = np.empty((3, n, 2))
    for k in range(n):
        drive = (60.0, 30.0) * (reference[k] - data.qpos) - (3.0, 1.5) * data.qvel
        rows[:, k] = data.qpos, data.qvel, drive
        data.ctrl[:] = drive
        mujoco.mj_step(model, data, substeps)
    return [
        Recording(t, rows[0, :, j], rows[2, :, j], velocity=rows[1, :, j], metadata=RecordingMetadata(joint=name))
        for j, name in enumerate(("a", "b"))
    ]


def test_an_arm_explains_what_it_made_itself(tmp_path: Path) -> None:
    path = _write(tmp_path)
    found = evaluate_arm(path, _record(path))
    for one in found.joints:
        assert one.torque.rms < 0.02 * one.torque.recorded
        assert all(each.median < 0.01 * each.travel for each in one.position)
    assert found.notes == ("Held where the file has them: grip.",)
    assert "joint" in found.summary()


def test_friction_models_beside_the_arm_give_what_its_own_friction_gives(tmp_path: Path) -> None:
    path = _write(tmp_path)
    recordings = _record(path)
    names = ("a", "b")
    models = {
        n: FrictionModel(FrictionLaw((Coulomb(f), Viscous(d)))) for n, f, d in zip(names, LEVELS, DRAG, strict=True)
    }
    save_model(models["b"], tmp_path / "b.json")
    found = evaluate_arm(path, recordings, friction={"a": models["a"], "b": tmp_path / "b.json"})
    for one in found.joints:
        assert one.torque.rms < 0.03 * one.torque.recorded
        assert all(each.median < 0.02 * each.travel for each in one.position)


def test_a_range_that_a_joint_was_recorded_beyond_is_no_stop(tmp_path: Path) -> None:
    """Ranges of files are narrower than some robots are: a stop asked for 35 kN·m, of the simulation and the files."""
    path = _write(tmp_path)
    recordings = _record(path)
    path.write_text(path.read_text().replace('name="a"', 'name="a" range="-0.2 0.3" limited="true"'))
    for one in evaluate_arm(path, recordings).joints:
        assert one.torque.rms < 0.02 * one.torque.recorded
        assert all(each.median < 0.01 * each.travel for each in one.position)


def test_each_joint_has_its_own_error(tmp_path: Path) -> None:
    recordings = _record(_write(tmp_path))
    wrong = evaluate_arm(_write(tmp_path, levels=(0.601, 0.6)), recordings)
    assert wrong.joint("b").torque.rms == pytest.approx(0.3, rel=0.15)
    assert wrong.joint("a").torque.rms < 0.05


def test_bristles_and_loads_of_friction_models_are_followed(tmp_path: Path) -> None:
    path = _write(tmp_path)
    recordings = _record(path)
    curve = StribeckCurve(LEVELS[0], LEVELS[0], 1.0, DRAG[0])
    stiff = FrictionModel(FrictionLaw((LuGre(curve, curve, 3e3, 1.0),)))
    loaded = FrictionModel(FrictionLaw((Coulomb(LEVELS[1]), Viscous(DRAG[1]), LoadCoulomb(0.3))))
    found = evaluate_arm(path, recordings, friction={"a": stiff, "b": loaded})
    assert found.joint("a").torque.rms < 0.03 * found.joint("a").torque.recorded
    assert found.joint("b").torque.rms > 0.05


def test_a_torque_that_is_late_in_all_joints_is_moved(tmp_path: Path) -> None:
    path = _write(tmp_path)
    late = [one.with_channels(torque=np.interp(one.time - 0.01, one.time, one.torque)) for one in _record(path)]
    plain, moved = (evaluate_arm(path, late, torque_delay=delay, positions=False) for delay in (0.0, 0.01))
    assert moved.joint("a").torque.rms < 0.5 * plain.joint("a").torque.rms
    assert moved.joint("a").position == ()


def test_the_torque_of_each_joint_is_moved_by_its_own_delay(tmp_path: Path) -> None:
    path, recordings = _write(tmp_path), _record(_write(tmp_path))
    first = recordings[0]
    late = first.with_channels(torque=np.interp(first.time - 0.01, first.time, first.torque))
    mixed = [late, *recordings[1:]]
    plain, moved = (evaluate_arm(path, mixed, torque_delay=delay, positions=False) for delay in (0.0, {"a": 0.01}))
    assert moved.joint("a").torque.rms < 0.5 * plain.joint("a").torque.rms
    assert moved.joint("b").torque.rms == pytest.approx(plain.joint("b").torque.rms)


def test_what_does_not_fit_says_what_to_do(tmp_path: Path) -> None:
    path = _write(tmp_path)
    recordings = _record(path, duration=3.0)
    with pytest.raises(RecordingError, match=r"one recording of each joint, got a, a"):
        evaluate_arm(path, [recordings[0], recordings[0]])
    with pytest.raises(SimulationFileError, match=r"has no joint 'z'; it has a, b, grip: match the names"):
        evaluate_arm(path, recordings, match={"a": "z"})
    with pytest.raises(RecordingError, match=r"no recording of joint 'c'; there are a, b"):
        evaluate_arm(path, recordings, friction={"c": FrictionModel(FrictionLaw((Coulomb(1.0),)))})
    with pytest.raises(RecordingError, match=r"state the torque constant"):
        evaluate_arm(path, [one.with_metadata(torque_unit="A") for one in recordings])


def test_the_spring_of_a_law_stands_in_place_of_that_of_the_file(tmp_path: Path) -> None:
    """A file that is written with a spring has it where its friction model has it, too: it pulls once."""
    path = _write(tmp_path)
    path.write_text(path.read_text().replace('damping="0.3"', 'stiffness="4" springref="0" damping="0.3"'))
    terms = [
        (Coulomb(level), Viscous(drag), *extra)
        for level, drag, extra in zip(LEVELS, DRAG, ((SpringTorque(4.0, 0.0),), ()), strict=True)
    ]
    models = {name: FrictionModel(law=FrictionLaw(one), joint=name) for name, one in zip("ab", terms, strict=True)}
    found = evaluate_arm(path, _record(path), friction=models)
    assert all(one.torque.rms < 0.03 * one.torque.recorded for one in found.joints)

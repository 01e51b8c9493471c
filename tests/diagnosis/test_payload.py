"""What an arm carries more in one session than in another is found from joint torques, its links unknown."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.diagnosis import diagnose
from fricomp.errors import DiagnosisError
from fricomp.recording import Recording, RecordingMetadata, find_public_data, read_public
from fricomp.sim_bench.studies.real.arm import ARMS, arm_xml

from .toy_joint import ToyJoint, recording

_ARM = """<mujoco><worldbody>
<body><joint name="shoulder" axis="0 1 0"/><inertial pos="0.2 0 0" mass="3" diaginertia="0.1 0.1 0.1"/>
<body pos="0.5 0 0"><joint name="elbow" axis="0 1 0"/><inertial pos="0.15 0 0" mass="1.5" diaginertia="0.05 0.05 0.05"/>
</body></body></worldbody></mujoco>"""


def _session(payload: float, seed: int, seconds: float = 25.0) -> list[Recording]:
    """Both joints of the arm on a motion of their own, with a point mass 0.3 m along the forearm."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_string(_ARM)
    data, rng = mujoco.MjData(model), np.random.default_rng(seed)
    t = np.arange(int(seconds * 200)) / 200.0
    q, v, a = (np.zeros((t.size, 2)) for _ in range(3))
    for joint in range(2):
        for w in (0.7, 1.6, 2.9):
            size, angle = 0.5 * rng.uniform(0.6, 1.0), rng.uniform(0.0, 6.0)
            q[:, joint] += size * np.sin(w * t + angle)
            v[:, joint] += size * w * np.cos(w * t + angle)
            a[:, joint] -= size * w * w * np.sin(w * t + angle)
    model.body_mass[2], total = 1.5 + payload, 1.5 + payload
    centre = (1.5 * 0.15 + payload * 0.3) / total
    model.body_ipos[2] = [centre, 0.0, 0.0]
    model.body_inertia[2] += 1.5 * (0.15 - centre) ** 2 + payload * (0.3 - centre) ** 2
    mujoco.mj_setConst(model, data)
    torque = np.empty_like(q)
    for k in range(t.size):
        data.qpos[:], data.qvel[:], data.qacc[:] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        torque[k] = data.qfrc_inverse
    torque += 1.2 * np.sign(v) + 0.6 * v + 0.1 * rng.standard_normal(q.shape)
    names = ("shoulder", "elbow")
    return [Recording(t, q[:, i], torque[:, i], metadata=RecordingMetadata(joint=names[i])) for i in range(2)]


@pytest.fixture
def arm(tmp_path: Path) -> Path:
    path = tmp_path / "arm.xml"
    path.write_text(_ARM)
    return path


def test_a_payload_is_found_with_its_mass(arm: Path) -> None:
    diagnosis = diagnose([*_session(0.0, 1), *_session(0.8, 2)], arm)
    assert diagnosis.verdict == "parameters"
    (effect,) = diagnosis.effects
    assert effect.name == "payload_error"
    mass = effect.parameters["mass"]
    assert mass.value == pytest.approx(0.8, rel=0.05)
    assert mass.ci95[0] < 0.8 < mass.ci95[1]
    assert effect.parameters["first_moment_x"].value == pytest.approx(0.24, rel=0.05)
    assert "first_moment_y" not in effect.parameters, "both axes are parallel to it"
    assert diagnosis.sentences[1].startswith("It shows most in the torque of shoulder (")
    assert ", elbow (" in diagnosis.sentences[1]


def test_the_same_payload_twice_is_none(arm: Path) -> None:
    diagnosis = diagnose([*_session(0.3, 1), *_session(0.3, 2)], arm)
    assert diagnosis.verdict == "consistent"
    assert diagnosis.effects == ()
    assert "carry the same" in diagnosis.sentences[0]


def test_several_joints_without_an_arm_are_refused_by_name(arm: Path) -> None:
    light = _session(0.0, 1, 6.0)
    with pytest.raises(DiagnosisError, match="elbow, shoulder"):
        diagnose(light)
    with pytest.raises(DiagnosisError, match="two sessions"):
        diagnose(light, arm)
    amperes = [replace(one, metadata=replace(one.metadata, torque_unit="A")) for one in light]
    with pytest.raises(DiagnosisError, match="drive_gain"):
        diagnose([*amperes, *amperes], arm)


@pytest.mark.slow
def test_two_recordings_of_one_joint_with_different_loads() -> None:
    light, heavy = ToyJoint(), ToyJoint(gravity=8.0, inertia=0.42)
    diagnosis = diagnose([recording(light, "fourier", 30.0, 1), recording(heavy, "fourier", 30.0, 2)])
    assert diagnosis.verdict == "parameters"
    assert [effect.name for effect in diagnosis.effects] == ["payload_error"]
    found = {name: one.value for name, one in diagnosis.effects[0].parameters.items()}
    assert found["gravity_sin_2"] == pytest.approx(2.0 * np.cos(0.3), rel=0.03)
    assert found["gravity_cos_2"] == pytest.approx(2.0 * np.sin(0.3), rel=0.1)
    assert found["inertia_2"] == pytest.approx(0.07, rel=0.1)


@pytest.mark.slow
def test_the_known_payload_of_a_real_arm(tmp_path: Path) -> None:
    if find_public_data("ur10e") is None:
        pytest.skip("the public data of ur10e are not here: set FRICOMP_DATA")
    path = tmp_path / "ur10e.xml"
    path.write_text(arm_xml("ur10e", ARMS["ur10e"]))
    diagnosis = diagnose([*read_public("ur10e/fourier"), *read_public("ur10e/fourier_load")], path)
    assert [effect.name for effect in diagnosis.effects] == ["payload_error"]
    assert diagnosis.effects[0].parameters["mass"].value == pytest.approx(2.805, rel=0.1)

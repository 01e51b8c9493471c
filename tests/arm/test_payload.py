"""What an arm carries more in one session than in another is found from joint torques, its links unknown."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from fricomp import diagnose
from fricomp.arm.payload import diagnose_payload
from fricomp.arm.rigid.regressor import compute_regressor
from fricomp.arm.rigid.simulated_arm import read_arm
from fricomp.cli.main import app
from fricomp.diagnosis import load_diagnosis
from fricomp.errors import DiagnosisError
from fricomp.recording import Recording, RecordingMetadata, find_public_data, read_public
from fricomp.sim_bench.studies.real.arm import ARMS, arm_xml

from .moving_arm import record_arm, write_arm

_ARM = """<mujoco><worldbody>
<body><joint name="shoulder" axis="0 1 0"/><inertial pos="0.2 0 0" mass="3" diaginertia="0.1 0.1 0.1"/>
<body pos="0.5 0 0"><joint name="elbow" axis="0 1 0"/><inertial pos="0.15 0 0" mass="1.5" diaginertia="0.05 0.05 0.05"/>
</body></body></worldbody></mujoco>"""


def _session(payload: float, seed: int, seconds: float = 25.0, *, stops: bool = False) -> list[Recording]:
    """Both joints of the arm on a motion of their own, with a point mass 0.3 m along the forearm.

    With stops they stand for two of five seconds, and friction there is anything up to its level.
    """
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
    rubbed = np.sign(v)
    if stops:
        rate = np.clip(2.0 * np.cos(0.4 * np.pi * t) + 0.6, 0.0, 1.0)
        along, change = np.cumsum(rate) / 200.0, np.gradient(rate, t)
        at = [np.interp(along, t, one) for each in (q, v, a) for one in each.T]
        q, v, a = (np.stack(at[k : k + 2], axis=1) for k in (0, 2, 4))
        v, a = v * rate[:, None], a * rate[:, None] ** 2 + v * change[:, None]
        stop = np.floor(0.2 * t).astype(int)
        rubbed = np.where(rate[:, None] > 0.0, np.sign(v), rng.uniform(-1.0, 1.0, (stop.max() + 1, 2))[stop])
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
    torque += 1.2 * rubbed + 0.6 * v + 0.1 * rng.standard_normal(q.shape)
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


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_stops_of_pick_and_place_say_nothing_of_a_payload(arm: Path, seed: int) -> None:
    """A joint that stands takes any torque up to its friction, which came as mass, with intervals beside the truth."""
    sessions = [_session(0.0, seed, 60.0, stops=True), _session(0.8, 10 + seed, 60.0, stops=True)]
    mass = diagnose([*sessions[0], *sessions[1]], arm).effects[0].parameters["mass"]
    assert mass.value == pytest.approx(0.8, rel=0.05)
    assert mass.ci95[0] - 0.01 < 0.8 < mass.ci95[1] + 0.01


@pytest.mark.parametrize("name", ["gripper", "wrist"])
def test_a_joint_that_stands_still_in_both_sessions_is_left_out(name: str, arm: Path) -> None:
    """Whether the simulation has it or not."""
    hand = '<body pos="0.3 0 0"><joint name="wrist"/><geom size="0.02" mass="0.1"/></body>'
    arm.write_text(_ARM.replace("</body></body>", f"{hand}</body></body>"))
    sessions = [_session(0.0, 1), _session(0.8, 2)]
    still = Recording(
        sessions[0][0].time, np.full(5000, 0.02), np.full(5000, 1.1), metadata=RecordingMetadata(joint=name)
    )
    diagnosis = diagnose([one for session in sessions for one in (*session, still)], arm)
    assert diagnosis.verdict == "parameters"
    assert diagnosis.effects[0].parameters["mass"].value == pytest.approx(0.8, rel=0.05)


def test_a_payload_is_found_in_one_session_where_the_simulation_is_right(arm: Path) -> None:
    diagnosis = diagnose(_session(0.8, 2), arm, payload=True)
    mass = diagnosis.effects[0].parameters["mass"]
    assert mass.value == pytest.approx(0.8, rel=0.03)
    assert mass.ci95[0] < 0.8 < mass.ci95[1]
    assert "more than in its simulation" in diagnosis.effects[0].sentence
    assert diagnose(_session(0.0, 2), arm, payload=True).verdict == "consistent"


@pytest.mark.parametrize("single", [False, True])
def test_the_command_takes_sessions_as_they_were_logged(arm: Path, tmp_path: Path, single: bool) -> None:
    logs = []
    for name, payload, seed in (("light", 0.0, 1), ("heavy", 0.8, 2)):
        session = _session(payload, seed)
        q, tau = (np.stack([getattr(one, key) for one in session], axis=1) for key in ("position", "torque"))
        np.savez(tmp_path / f"{name}.npz", t=session[0].time, q=q, tau=tau)
        logs.append(str(tmp_path / f"{name}.npz"))
    given = [logs[1], "--payload"] if single else logs
    options = ["--simulation", str(arm), "--match", "joint_1=shoulder,joint_2=elbow", "--out", str(tmp_path / "out")]
    done = CliRunner().invoke(app, ["diagnose", *given, *options])
    assert done.exit_code == 0, done.output
    (effect,) = load_diagnosis(tmp_path / "out" / "diagnosis.json").effects
    assert effect.parameters["mass"].value == pytest.approx(0.8, rel=0.05)


def test_a_spring_is_no_mass(tmp_path: Path) -> None:
    columns = []
    for spring in ("", 'stiffness="6" springref="0.3"'):
        path = tmp_path / "arm.xml"
        path.write_text(_ARM.replace('name="elbow"', f'name="elbow" {spring}'))
        columns.append(compute_regressor(read_arm(path, ("shoulder", "elbow")), *np.full((3, 2, 2), 0.7)))
    np.testing.assert_allclose(columns[1], columns[0])


def test_the_same_payload_twice_is_none(arm: Path) -> None:
    diagnosis = diagnose([*_session(0.3, 1), *_session(0.3, 2)], arm)
    assert diagnosis.verdict == "consistent"
    assert diagnosis.effects == ()
    assert "carry the same" in diagnosis.sentences[0]


def test_several_joints_without_an_arm_are_refused_by_name(arm: Path) -> None:
    light = _session(0.0, 1, 6.0)
    with pytest.raises(DiagnosisError, match="elbow, shoulder"):
        diagnose(light)
    with pytest.raises(DiagnosisError, match="payload=True"):
        diagnose(light, arm)
    with pytest.raises(DiagnosisError, match="one or two sessions"):
        diagnose(light * 3, arm)
    amperes = [replace(one, metadata=replace(one.metadata, torque_unit="A")) for one in light]
    with pytest.raises(DiagnosisError, match="drive_gain"):
        diagnose([*amperes, *amperes], arm)


@pytest.mark.parametrize("light", ["ur10e/fourier", pytest.param("ur10e/points", marks=pytest.mark.slow)])
def test_the_known_payload_of_a_real_arm(tmp_path: Path, light: str) -> None:
    """Weighed: 2.805 kg. The motion without it is the same one, or another."""
    if find_public_data("ur10e") is None:
        pytest.skip("the public data of ur10e are not here: set FRICOMP_DATA")
    path = tmp_path / "ur10e.xml"
    path.write_text(arm_xml("ur10e", ARMS["ur10e"]))
    diagnosis = diagnose_payload([*read_public(light), *read_public("ur10e/fourier_load")], path)
    assert [effect.name for effect in diagnosis.effects] == ["payload_error"]
    mass = diagnosis.effects[0].parameters["mass"]
    assert mass.value == pytest.approx(2.805, rel=0.03)
    assert mass.ci95[0] < 2.805 < mass.ci95[1]


def test_a_simulation_that_is_wrong_elsewhere_widens_the_interval_of_one_session(tmp_path: Path) -> None:
    """The forearm weighs 1 kg more than its simulation says, beside 0.6 kg at the hand: joints do not agree."""
    recorded = record_arm(write_arm(tmp_path, (4.0, 3.5, 1.8)), duration=25.0)
    wrong = diagnose_payload(recorded, write_arm(tmp_path)).effects
    right = diagnose_payload(recorded, write_arm(tmp_path, (4.0, 3.5, 1.2))).effects[0].parameters["mass"]
    assert right.value == pytest.approx(0.6, rel=0.05)
    assert right.ci95[0] < 0.6 < right.ci95[1]
    assert not wrong or wrong[0].parameters["mass"].ci95[0] < 0.6 < wrong[0].parameters["mass"].ci95[1]

"""Simulations as robots ship them: what moves the recorded joints is found, what does not is held or refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from fricomp.arm.examination import match_recordings
from fricomp.arm.rigid.naming import find_strangers, match_in_order, match_joints, parse_names
from fricomp.arm.rigid.regressor import compute_regressor
from fricomp.arm.rigid.simulated_arm import read_arm
from fricomp.errors import SimulationFileError
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

from ..moving_arm import record_arm, write_arm

INERTIAL = (
    '<inertial><origin xyz="0.01 0.02 0.1"/><mass value="{0}"/>'
    '<inertia ixx="{1}" iyy="0.01" izz="0.006" ixy="0.001" ixz="0" iyz="0"/></inertial>'
)
MESH = '<visual><geometry><mesh filename="package://robot/meshes/{0}.dae"/></geometry></visual>'


def write_urdf(path: Path, *, ixx: float = 0.012) -> Path:
    """Two joints, a massless tool frame, a parallel gripper whose second finger mimics the first."""

    def link(name: str, mass: float) -> str:
        return f'<link name="{name}">{INERTIAL.format(mass, ixx)}{MESH.format(name)}</link>'

    def joint(name: str, kind: str, parent: str, child: str, axis: str, inside: str = "") -> str:
        limit = "" if kind == "fixed" else '<limit lower="-2" upper="2" effort="50" velocity="3"/>'
        return (
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="0 0 0.2"/><axis xyz="{axis}"/>{limit}{inside}</joint>'
        )

    mimic = '<mimic joint="finger_left" multiplier="-0.5" offset="0.01"/>'
    parts = (
        '<link name="world"/><link name="tool"/>',
        *(link(*one) for one in (("base", 3.0), ("upper", 2.0), ("lower", 1.0), ("left", 0.2), ("right", 0.1))),
        joint("root", "fixed", "world", "base", "0 0 1"),
        joint("arm_joint_1", "revolute", "base", "upper", "0 1 0"),
        joint("arm_joint_2", "continuous", "upper", "lower", "1 0 0"),
        joint("tip", "fixed", "lower", "tool", "0 0 1"),
        joint("finger_left", "prismatic", "tool", "left", "0 1 0"),
        joint("finger_right", "prismatic", "tool", "right", "0 1 0", mimic),
        '<transmission name="t"><type>SimpleTransmission</type></transmission>',
    )
    path.write_text(f'<robot name="r">{"".join(parts)}</robot>')
    return path


def test_meshes_transmissions_and_fixed_links_stop_nothing(tmp_path: Path) -> None:
    arm = read_arm(write_urdf(tmp_path / "r.urdf"), ("joint_1", "joint_2"))
    assert arm.joints == ("arm_joint_1", "arm_joint_2")
    assert arm.held == ("finger_left", "finger_right")
    assert arm.inertia[1, 0] == pytest.approx(1.0 + 0.2 + 0.1)


def test_a_joint_that_mimics_a_recorded_one_moves_with_it(tmp_path: Path) -> None:
    path = write_urdf(tmp_path / "r.urdf")
    arm = read_arm(path, ("arm_joint_1", "arm_joint_2", "finger_left"))
    assert [(one.name, one.leader) for one in arm.followers] == [("finger_right", 2)]
    assert arm.rotary == (True, True, False)
    rng = np.random.default_rng(0)
    q, v, a = rng.normal(size=(3, 10, 3))
    torques = compute_regressor(arm, q, v, a) @ arm.inertia.ravel()
    assert torques == pytest.approx(compute_by_virtual_work(arm, q, v, a), abs=1e-9)


def test_a_finger_that_mimics_one_that_stood_still_is_held_where_it_takes_it(tmp_path: Path) -> None:
    """It was held at its own zero: the link that carries the hand had its mass elsewhere than in the simulation."""
    path, joints = write_urdf(tmp_path / "r.urdf"), ("arm_joint_1", "arm_joint_2")
    opened = read_arm(path, joints, still={"finger_left": 0.03})
    placed = read_arm(path, joints, still={"finger_left": 0.03, "finger_right": -0.005})
    assert opened.inertia == pytest.approx(placed.inertia)
    assert not np.allclose(opened.inertia, read_arm(path, joints).inertia)


def compute_by_virtual_work(arm: Any, q: np.ndarray, v: np.ndarray, a: np.ndarray) -> np.ndarray:
    """Inverse dynamics of all joints, the follower's torque brought to its leader by the slope of its path."""
    model = arm._model
    data: Any = mujoco.MjData(model)
    names = ["arm_joint_1", "arm_joint_2", "finger_left", "finger_right"]
    places = [int(model.joint(name).qposadr[0]) for name in names]
    dofs = [int(model.joint(name).dofadr[0]) for name in names]
    torques = np.empty_like(q)
    for k in range(len(q)):
        data.qpos[places] = [*q[k], 0.01 - 0.5 * q[k, 2]]
        data.qvel[dofs], data.qacc[dofs] = [*v[k], -0.5 * v[k, 2]], [*a[k], -0.5 * a[k, 2]]
        mujoco.mj_inverse(model, data)
        each = data.qfrc_inverse[dofs]
        torques[k] = each[0], each[1], each[2] - 0.5 * each[3]
    return torques


def test_inertia_that_no_body_can_have_is_lowered_to_one_that_can(tmp_path: Path) -> None:
    arm = read_arm(write_urdf(tmp_path / "r.urdf", ixx=0.5), ("joint_1", "joint_2"))
    assert arm.inertia[0, 0] == pytest.approx(2.0)
    assert arm.inertia[0, 4] < 0.1


BODY = '<inertial pos="0 0 0.1" mass="{0}" diaginertia="0.01 0.01 0.01"/>'


def write_arms(path: Path, base: str = "") -> Path:
    """Two arms without names of bodies, the right one on a hull, and a loose box."""

    def arm(side: str, mass: float) -> str:
        inner = f'<body>{BODY.format(mass)}<joint name="{side}/j2" axis="0 1 0"/></body>'
        return f'<body>{BODY.format(mass)}<joint name="{side}/j1" axis="0 1 0"/>{inner}</body>'

    path.write_text(
        f'<mujoco><worldbody>{arm("left", 1.0)}<body name="hull" pos="0 1 0">{BODY.format(9)}{base}{arm("right", 2.0)}'
        f'</body><body name="box" pos="1 0 0"><freejoint name="loose"/>{BODY.format(1)}</body></worldbody></mujoco>'
    )
    return path


def test_one_of_two_arms_is_enough_and_what_lies_about_is_held(tmp_path: Path) -> None:
    path = write_arms(tmp_path / "two.xml")
    arm = read_arm(path, ("right/j1", "right/j2"))
    assert arm.inertia[:, 0] == pytest.approx([2.0, 2.0])
    assert arm.held == ("left/j1", "left/j2", "loose")
    with pytest.raises(SimulationFileError, match="--match j1=left/j1,j2=left/j2"):
        read_arm(path, ("j1", "j2"))


def test_a_base_that_floats_is_refused_and_a_base_on_wheels_is_held(tmp_path: Path) -> None:
    floating = write_arms(tmp_path / "floating.xml", '<freejoint name="root"/>')
    with pytest.raises(SimulationFileError, match="'right/j1' stands on body 'hull', which floats"):
        read_arm(floating, ("right/j1", "right/j2"))
    rolling = write_arms(tmp_path / "rolling.xml", '<joint name="x" type="slide" axis="1 0 0"/>')
    assert "x" in read_arm(rolling, ("right/j1", "right/j2")).held


def test_names_that_mean_the_same_are_matched() -> None:
    there = ("panda_joint1", "panda_joint2", "panda_finger_joint1")
    assert match_joints(("joint_1", "joint_2"), there, {}) == {"joint_1": there[0], "joint_2": there[1]}
    assert match_joints(("shoulder_pan", "elbow"), ("shoulder_pan_joint", "elbow_joint"), {})["elbow"] == "elbow_joint"
    assert match_joints(("J1", "J2"), ("joint_2", "joint_1"), {"J1": "joint_2", "J2": "joint_1"})["J1"] == "joint_2"


def test_recordings_that_count_from_zero_are_of_joints_that_count_from_one() -> None:
    """By their numbers all but the first would be the joint before, and the first the last."""
    for there in (("joint_1", "joint_2", "joint_3"), ("ur_joint_1", "ur_joint_2", "ur_joint_3")):
        recorded = ("joint_0", "joint_1", "joint_2")
        assert tuple(match_joints(recorded, there, {}).values()) == there
    assert match_joints(("q_0", "q_1"), ("joint_0", "joint_1"), {}) == {"q_0": "joint_0", "q_1": "joint_1"}
    assert match_joints(("q_0", "q_1"), ("rail", "joint_1"), {"q_0": "rail"})["q_1"] == "joint_1"
    with pytest.raises(SimulationFileError, match="--match q_0=rail"):
        match_joints(("q_0", "q_1"), ("rail", "joint_1"), {})


def test_words_of_names_tell_joints_where_all_of_the_simulation_were_recorded() -> None:
    """A made SCARA was refused for both; where the simulation has more joints, a gripper's could be meant."""
    there = ("j1_shoulder", "j2_elbow", "j3_lift")
    for recorded in (("elbow", "shoulder", "lift"), ("axis2", "axis1", "axis3")):
        assert tuple(match_joints(recorded, there, {}).values()) == (there[1], there[0], there[2])
    for others in ("shoulder", "shoulder j2", "shoulder lift lamp"):
        with pytest.raises(SimulationFileError):
            match_joints(("elbow", *others.split()), there, {})


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({}, "--match a=left,b=right"),
        ({"a": "left"}, "called 'b'; still free are right. .*--match b=right"),
        ({"c": "left"}, "'c', which was not recorded"),
        ({"a": "left", "b": "left"}, "called 'a', 'b'"),
    ],
)
def test_names_that_differ_are_refused_with_the_line_to_write(given: dict[str, str], message: str) -> None:
    with pytest.raises(SimulationFileError, match=message):
        match_joints(("a", "b"), ("left", "right"), given)


def test_a_mapping_of_names_may_stand_in_one_option() -> None:
    assert parse_names(["a=left,b=right", "c=top"]) == {"a": "left", "b": "right", "c": "top"}
    with pytest.raises(SimulationFileError, match="has no '='"):
        parse_names(["a"])


def test_a_recorded_gripper_that_stood_still_and_is_not_in_the_simulation_is_left_out(tmp_path: Path) -> None:
    """Joints that stood still and are in the simulation stay where they stood."""
    simulation, time = write_arm(tmp_path), np.arange(0.0, 12.0, 0.004)

    def record(joint: str, position: FloatArray) -> Recording:
        return Recording(time=time, position=position, torque=np.cos(time), metadata=RecordingMetadata(joint=joint))

    moving = [record("arm_shoulder", np.sin(time)), record("arm_elbow", np.cos(0.7 * time))]
    still = [record("arm_wrist", np.full(time.size, 0.4)), record("jaw", np.full(time.size, 0.02))]
    arm, recording = match_recordings([*moving, *still], simulation)
    assert arm.joints == ("shoulder", "elbow")
    assert recording.still == ("wrist", "jaw")
    with pytest.raises(SimulationFileError, match="'jaw'"):
        match_recordings([*moving, still[0], record("jaw", 0.3 * np.sin(time))], simulation)


@pytest.mark.parametrize(
    ("recorded", "simulated", "strangers"),
    [
        ("a b gripper", "a b", ("gripper",)),
        ("ur_a ur_b jaw", "a b", ("jaw",)),
        ("a b c", "shoulder elbow", ()),
        ("joint_0 joint_1 joint_2", "joint_1 joint_2", ()),
        ("a b jaw", "a b grip", ()),
        ("a b c d e", "a b", ()),
    ],
)
def test_joints_are_strangers_where_all_of_the_simulation_are_recorded_beside_them(
    recorded: str, simulated: str, strangers: tuple[str, ...]
) -> None:
    assert find_strangers(recorded.split(), simulated.split(), {}) == strangers


def test_a_recorded_gripper_that_moved_and_is_not_in_the_simulation_is_left_out(tmp_path: Path) -> None:
    simulation, time = write_urdf(tmp_path / "r.urdf"), np.arange(0.0, 12.0, 0.004)
    names = ("arm_joint_1", "arm_joint_2", "finger_left", "finger_right", "lamp")
    recordings = [
        Recording(time=time, position=np.sin((1.0 + 0.1 * k) * time), torque=np.cos(time), metadata=metadata)
        for k, metadata in enumerate(RecordingMetadata(joint=name) for name in names)
    ]
    arm, recording = match_recordings(recordings, simulation)
    assert arm.joints == names[:-1]
    assert recording.strangers == ("lamp",)
    assert recording.still == ()


def test_numbers_alone_are_the_joints_of_a_chain_in_its_order(tmp_path: Path) -> None:
    """Logs with columns q_1 to q_6 of an arm whose joints have names were refused."""
    assert match_in_order(("joint_2", "joint_1"), ("hip", "knee")) == {"joint_1": "hip", "joint_2": "knee"}
    assert match_in_order(("q_0", "q_1"), ("hip", "knee")) == {}
    assert match_in_order(("joint_0", "joint_1"), ("joint_a1", "joint_a2")) == {
        "joint_0": "joint_a1",
        "joint_1": "joint_a2",
    }
    for recorded, chain in (("1 3", "hip knee"), ("1 2", "hip knee foot"), ("1 2", "axis2 axis1"), ("1 lamp", "a b")):
        assert match_in_order([f"joint_{one}" for one in recorded.split()], chain.split()) == {}
    arm = read_arm(write_arm(tmp_path), ("joint_1", "joint_2", "joint_3", "joint_4"))
    assert arm.in_order
    assert arm.joints == ("shoulder", "elbow", "wrist", "grip")
    assert not read_arm(write_arm(tmp_path), arm.joints).in_order


def test_an_order_that_the_torques_contradict_is_refused(tmp_path: Path) -> None:
    simulation = write_arm(tmp_path)
    text = simulation.read_text(encoding="utf-8").replace(
        '<joint name="grip" type="slide" axis="1 0 0" range="0 0.04"/>', ""
    )
    simulation.write_text(text, encoding="utf-8")
    recordings = record_arm(simulation, duration=20.0)

    def number(order: tuple[int, ...]) -> list[Recording]:
        return [one.with_metadata(joint=f"joint_{k}") for k, one in zip(order, recordings, strict=True)]

    assert match_recordings(number((1, 2, 3)), simulation)[0].in_order
    with pytest.raises(SimulationFileError, match="elbow, shoulder, wrist explains them much better"):
        match_recordings(number((2, 1, 3)), simulation)

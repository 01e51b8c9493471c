"""The regressor of an arm is MuJoCo's inverse dynamics, link by link."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from fricomp.arm.rigid.regressor import compute_mass_matrices, compute_regressor
from fricomp.arm.rigid.simulated_arm import read_arm
from fricomp.errors import SimulationFileError

from ..moving_arm import JOINTS, write_arm


def test_torques_are_those_of_inverse_dynamics(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    arm = read_arm(path, JOINTS)
    q, v, a = np.random.default_rng(1).normal(size=(3, 20, 3))
    model: Any = mujoco.MjModel.from_xml_path(str(path))
    data: Any = mujoco.MjData(model)
    torques = compute_regressor(arm, q, v, a) @ arm.inertia.ravel()
    for k in range(20):
        data.qpos[:3], data.qvel[:3], data.qacc[:3] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        assert torques[k] == pytest.approx(data.qfrc_inverse[:3], abs=1e-10)


def test_mass_matrices_are_those_of_the_links(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    arm = read_arm(path, JOINTS)
    q = np.random.default_rng(2).normal(size=(10, 3))
    model: Any = mujoco.MjModel.from_xml_path(str(path))
    data: Any = mujoco.MjData(model)
    matrices = compute_mass_matrices(arm, q, arm.inertia)
    for k in range(10):
        data.qpos[:3] = q[k]
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
        assert matrices[k] == pytest.approx(full[:3, :3], abs=1e-10)


def test_joints_that_were_not_recorded_are_held_and_weigh_with_their_link(tmp_path: Path) -> None:
    arm = read_arm(write_arm(tmp_path), JOINTS)
    assert arm.held == ("grip",)
    assert arm.links == ("upper", "lower", "hand")
    assert arm.inertia[2, 0] == pytest.approx(1.2 + 0.05)


def test_an_unknown_joint_is_refused_with_the_names_there_are(tmp_path: Path) -> None:
    with pytest.raises(
        SimulationFileError,
        match=r"called 'joint_1'; still free are shoulder, elbow, wrist, grip.*--match joint_1=shoulder",
    ):
        read_arm(write_arm(tmp_path), ("joint_1",))


_CROOKED = """<mujoco><compiler angle="radian"/><option gravity="1 2 -9"/><worldbody>
<body name="a" pos="0.1 0 0.2" quat="0.9 0.1 0.3 0.2"><inertial pos="0.1 0 0.2" mass="3" diaginertia="0.1 0.1 0.1"/>
<joint name="one" axis="1 2 1" pos="0.05 -0.1 0.2" ref="0.3"/><joint name="two" type="slide" axis="0 1 1" pos="0 0 1"/>
<body name="b" pos="0 0.1 0.3" euler="0.4 0.2 0.1"><inertial pos="0 0.1 0.1" mass="2" diaginertia="0.1 0.1 0.05"/>
<joint name="loose" axis="1 0 1" pos="0.1 0 0" ref="0.4"/>
<body name="c" pos="0.2 0 0"><inertial pos="0 0 0.1" mass="1" diaginertia="0.02 0.02 0.01"/>
<joint name="three" axis="0 1 0" pos="0 0 -0.1"/></body></body></body></worldbody></mujoco>"""


def test_joints_off_their_bodies_origin_and_slides_move_what_comes_after_them(tmp_path: Path) -> None:
    """Anchors, references, two joints in one body, a joint that is held, and gravity that is askew."""
    path = tmp_path / "crooked.xml"
    path.write_text(_CROOKED)
    arm = read_arm(path, ("one", "two", "three"))
    q, v, a = np.random.default_rng(2).normal(size=(3, 8, 3))
    model: Any = mujoco.MjModel.from_xml_path(str(path))
    data: Any = mujoco.MjData(model)
    places = [int(model.joint(name).qposadr[0]) for name in ("one", "two", "three")]
    dofs = [int(model.joint(name).dofadr[0]) for name in ("one", "two", "three")]
    torques = compute_regressor(arm, q, v, a) @ arm.inertia.ravel()
    for k in range(8):
        data.qpos[:] = model.qpos0
        data.qpos[places], data.qvel[dofs], data.qacc[dofs] = q[k], v[k], a[k]
        mujoco.mj_inverse(model, data)
        assert torques[k] == pytest.approx(data.qfrc_inverse[dofs], abs=1e-10)

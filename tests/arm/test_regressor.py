"""The regressor of an arm is MuJoCo's inverse dynamics, link by link."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from fricomp.arm.regressor import compute_regressor
from fricomp.arm.simulated_arm import read_arm
from fricomp.errors import SimulationFileError

from .moving_arm import JOINTS, write_arm


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

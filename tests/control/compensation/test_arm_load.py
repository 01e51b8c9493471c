"""Loads of an arm's joints are MuJoCo's inverse dynamics, and friction under load follows them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.control import ArmCompensator, ArmLoad, Compensator
from fricomp.errors import ModelFileError, ParameterError, SimulationFileError
from fricomp.laws import BidirectionalStribeck, FrictionLaw, LoadCoulomb, StribeckCurve
from fricomp.model import FrictionModel, Validity, save_model

mujoco = pytest.importorskip("mujoco")

_BODY = '<inertial pos="0.02 0.01 0.1" mass="{0}" diaginertia="0.02 0.02 0.01"/>'
ARM = f"""<mujoco><worldbody>{{0}}<body>{_BODY.format(3)}<joint name="b" axis="0 1 0" armature="0.5"/>
<body pos="0 0 0.3">{_BODY.format(2)}<joint name="a" axis="1 0 0" armature="0.3"/>
<body pos="0 0 0.1">{_BODY.format(0.4)}<joint name="f1" type="slide" axis="1 0 0"/></body>
<body pos="0 0 0.1">{_BODY.format(0.4)}<joint name="f2" type="slide" axis="1 0 0"/></body>
</body></body>{{1}}</worldbody>
<equality><joint joint1="f2" joint2="f1" polycoef="0.01 -1 0.2 0 0"/></equality></mujoco>"""


def write_arm(folder: Path, before: str = "", after: str = "") -> Path:
    (folder / "arm.xml").write_text(ARM.format(before, after))
    return folder / "arm.xml"


def invert(path: Path, motion: dict[str, tuple[float, float, float]]) -> dict[str, float]:
    """Inverse dynamics without rotors."""
    model: Any = mujoco.MjModel.from_xml_path(str(path))
    model.dof_armature[:] = 0.0
    model.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    data: Any = mujoco.MjData(model)
    for name, (q, v, a) in motion.items():
        place, dof = model.joint(name).qposadr[0], model.joint(name).dofadr[0]
        data.qpos[place], data.qvel[dof], data.qacc[dof] = q, v, a
    mujoco.mj_inverse(model, data)
    return {name: float(data.qfrc_inverse[model.joint(name).dofadr[0]]) for name in motion}


def test_loads_are_inverse_dynamics_without_rotors_in_any_order(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    b, a = (0.3, -1.0, 2.0), (-0.4, 0.5, -3.0)
    truth = invert(path, {"a": a, "b": b})
    for names, motion in ((("b", "a"), (b, a)), (("a", "b"), (a, b))):
        found = ArmLoad(path, names).compute(*zip(*motion, strict=True))
        assert found == pytest.approx([truth[name] for name in names])


def test_a_joint_that_mimics_another_moves_with_it(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    q, v, a = 0.02, 0.3, -0.7
    slope, bend = -1.0 + 0.4 * q, 0.4
    follower = (0.01 - q + 0.2 * q * q, slope * v, slope * a + bend * v * v)
    truth = invert(path, {"b": (0.3, 1.0, 2.0), "a": (0.1, 1.0, 2.0), "f1": (q, v, a), "f2": follower})
    found = ArmLoad(path, ("b", "a", "f1")).compute((0.3, 0.1, q), (1.0, 1.0, v), (2.0, 2.0, a))
    assert found == pytest.approx([truth["b"], truth["a"], truth["f1"] + slope * truth["f2"]])


def model_of(joint: str, coefficient: float) -> FrictionModel:
    curve = StribeckCurve(1.0, 1.0, 1.0, 0.0)
    law = FrictionLaw((BidirectionalStribeck(curve, curve), LoadCoulomb(coefficient)))
    return FrictionModel(law, joint=joint, validity=Validity(velocity=(-5.0, 5.0), load_torque=(-99.0, 99.0)))


def test_friction_follows_the_load_of_the_arms_own_dynamics(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    for joint, coefficient in (("a", 0.1), ("b", 0.2)):
        (tmp_path / "joints" / joint).mkdir(parents=True)
        save_model(model_of(joint, coefficient), tmp_path / "joints" / joint / "friction.json")
    arm, out = ArmCompensator.read(tmp_path, gain=1.0), [0.0, 0.0]
    assert [joint.model.joint for joint in arm.joints] == ["b", "a"]
    arm.torque_into(out, [1.0, -1.0], None, None, None, [0.3, -0.4], [2.0, -3.0])
    load = invert(path, {"b": (0.3, 1.0, 2.0), "a": (-0.4, -1.0, -3.0)})
    assert arm.load == pytest.approx([load["b"], load["a"]])
    rotors = [mujoco.MjModel.from_xml_path(str(path)).joint(name).armature[0] for name in ("b", "a")]
    assert min(rotors) > 0.0
    assert arm.feed_forward == pytest.approx([load["b"] + 2.0 * rotors[0], load["a"] - 3.0 * rotors[1]])
    assert out == pytest.approx([1.0 + 0.2 * abs(load["b"]), -1.0 - 0.1 * abs(load["a"])], rel=1e-6)


def test_what_is_no_number_gives_no_torque(tmp_path: Path) -> None:
    arm = ArmCompensator(
        [Compensator(model_of("b", 0.1)), Compensator(model_of("a", 0.1))], ArmLoad(write_arm(tmp_path), ("b", "a"))
    )
    out = [9.0, 9.0]
    arm.torque_into(out, [1.0, 1.0], position=[math.nan, 0.0])
    assert out == [0.0, 0.0]
    arm.torque_into(out, [1.0, 1.0], position=[0.1, 0.0])
    assert np.all(np.abs(out) > 0.5)


def test_what_is_missing_is_asked_for(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    joints = [Compensator(model_of("b", 0.1)), Compensator(model_of("a", 0.1))]
    with pytest.raises(ParameterError, match="dynamics=ArmLoad"):
        ArmCompensator(joints)
    with pytest.raises(ParameterError, match="of 4 joints, the compensators of 2"):
        ArmCompensator(joints, ArmLoad(path))
    arm = ArmCompensator(joints, ArmLoad(path, ("b", "a")))
    with pytest.raises(ParameterError, match="give position="):
        arm.torque_into([0.0, 0.0], [1.0, 1.0])
    with pytest.raises(ParameterError, match="2 numbers each"):
        arm.torque_into([0.0, 0.0], [1.0, 1.0], position=[0.0])
    with pytest.raises(SimulationFileError, match="it has b, a, f1, f2"):
        ArmLoad(path, ("z",))
    with pytest.raises(ModelFileError, match="no joints/NAME"):
        ArmCompensator.read(tmp_path)

"""MJCF and URDF: what MuJoCo then simulates is what the export says, loss included."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from fricomp.errors import ExportError
from fricomp.export import MjcfWay, apply_to_mjcf, apply_to_urdf, export_mjcf, export_urdf
from fricomp.export.fidelity import sample_friction
from fricomp.laws import (
    BidirectionalStribeck,
    Cogging,
    Coulomb,
    DwellStiction,
    KinematicError,
    LaggedStribeck,
    LuGre,
    SmoothedCoulomb,
    SpringTorque,
    Stribeck,
    StribeckCurve,
    Term,
    ThermalFriction,
    Viscous,
)
from fricomp.model import FrictionModel

from .models import FORWARD, REVERSE, make_lugre, make_model

mujoco = pytest.importorskip("mujoco")

ROBOT = """<mujoco>
  <option timestep="0.001" integrator="implicitfast"><flag gravity="disable" contact="disable"/></option>
  <worldbody><body><joint name="elbow" axis="0 0 1" damping="7"/>
    <geom type="box" size="0.1 0.1 0.1" mass="10"/></body></worldbody>
  <actuator><motor name="drive" joint="elbow"/></actuator>
</mujoco>"""


def steady_torque(text: str, velocity: float) -> float:
    """Torque that MuJoCo's friction sets against a joint held at `velocity`."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    for _ in range(400 if abs(velocity) > 0.01 else 4000):  # until the bristle has settled
        data.qvel[0] = velocity
        mujoco.mj_step(model, data)
    data.qvel[0] = velocity
    mujoco.mj_forward(model, data)
    return -float(data.qfrc_actuator[0] + data.qfrc_passive[0] + data.qfrc_constraint[0])


def exported_torque(model: FrictionModel, way: MjcfWay, velocity: float) -> float:
    return steady_torque(apply_to_mjcf(export_mjcf(model, way), ROBOT, "elbow"), velocity)


@pytest.mark.parametrize("export", [export_mjcf, export_urdf])
def test_a_model_in_amperes_is_no_torque_for_a_simulator(export: Callable[[FrictionModel], object]) -> None:
    with pytest.raises(ExportError, match="in A, a simulator takes N·m"):
        export(replace(make_model(), torque_unit="A"))


@pytest.mark.parametrize("velocity", [0.01, 0.05, 0.3, -0.02, -0.4])
def test_symmetric_lugre_survives_as_a_passive_motor(velocity: float) -> None:
    model = make_lugre()
    assert exported_torque(model, "dcmotor", velocity) == pytest.approx(float(model.torque(velocity)), rel=2e-3)
    assert export_mjcf(model, "dcmotor").fidelity.relative_rms < 1e-12


@pytest.mark.parametrize("way", ["dcmotor", "damping"])
def test_stated_loss_is_the_simulated_loss(way: MjcfWay) -> None:
    model = make_model()
    export = export_mjcf(model, way)
    velocity, friction = sample_friction(model)
    picked = np.flatnonzero(np.abs(velocity) > 0.01)[::25]
    simulated = np.array([exported_torque(model, way, v) for v in velocity[picked]])
    assert np.max(np.abs(simulated - friction[picked])) <= export.fidelity.largest * 1.01
    worst = export.fidelity.at_velocity
    off = abs(exported_torque(model, way, worst) - float(model.torque(worst)))
    assert off == pytest.approx(export.fidelity.largest, rel=0.02, abs=1e-3)


@pytest.mark.parametrize("velocity", [0.02, 0.3, -0.1, -1.0])
def test_friction_loss_is_a_level_and_damping(velocity: float) -> None:
    export = export_mjcf(make_model(), "frictionloss")
    level, damping = float(export.joint["frictionloss"]), float(export.joint["damping"])
    expected = np.copysign(level, velocity) + damping * velocity
    assert exported_torque(make_model(), "frictionloss", velocity) == pytest.approx(expected, rel=1e-3)


def test_friction_loss_truly_sticks() -> None:
    text = apply_to_mjcf(export_mjcf(make_model(), "frictionloss"), ROBOT, "elbow")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.ctrl[0] = 0.9 * model.dof_frictionloss[0]
    for _ in range(1000):
        mujoco.mj_step(model, data)
    assert abs(data.qvel[0]) < 1e-4


def test_damping_never_drives_the_joint() -> None:
    model = make_model()
    for velocity in np.linspace(-1.0, 1.0, 21):
        assert exported_torque(model, "damping", float(velocity)) * velocity >= 0.0


def test_old_friction_of_the_joint_is_replaced() -> None:
    root = ET.fromstring(apply_to_mjcf(export_mjcf(make_model(), "dcmotor"), ROBOT, "elbow"))
    joint = root.find(".//joint")
    assert joint is not None
    assert joint.attrib["damping"] == "0.025"
    assert [element.tag for element in root.findall("actuator/*")] == ["motor", "dcmotor"]


@pytest.mark.parametrize("way", ["dcmotor", "damping", "frictionloss"])
def test_a_second_export_replaces_the_first(way: MjcfWay) -> None:
    once = apply_to_mjcf(export_mjcf(make_model(), "dcmotor"), ROBOT, "elbow")
    twice = apply_to_mjcf(export_mjcf(make_model(Stribeck(FORWARD)), way), once, "elbow")
    fresh = apply_to_mjcf(export_mjcf(make_model(Stribeck(FORWARD)), way), ROBOT, "elbow")
    assert steady_torque(twice, 0.3) == pytest.approx(steady_torque(fresh, 0.3), rel=1e-9)


SPRUNG = (Stribeck(FORWARD), SpringTorque(0.4, 0.2))


def test_the_spring_of_an_earlier_export_goes_and_one_of_the_joint_stays() -> None:
    plain = export_mjcf(make_model(), "dcmotor")
    once = apply_to_mjcf(export_mjcf(make_model(*SPRUNG)), ROBOT, "elbow")
    again = mujoco.MjModel.from_xml_string(apply_to_mjcf(plain, once, "elbow"))
    assert (again.jnt_stiffness[0], again.qpos_spring[0]) == (0.0, 0.0)
    own = ROBOT.replace('damping="7"', 'stiffness="3" springref="90"')
    kept = mujoco.MjModel.from_xml_string(apply_to_mjcf(plain, own, "elbow"))
    assert (kept.jnt_stiffness[0], kept.qpos_spring[0]) == pytest.approx((3.0, np.pi / 2))


def as_linear(model: FrictionModel) -> FrictionModel:
    return replace(model, motion="linear", torque_unit="N")


CLASSES = """<default><joint type="slide"/><default class="outer"><default class="inner"><joint damping="1"/></default>
</default><default class="turning"><joint type="hinge"/></default></default>"""


@pytest.mark.parametrize(
    ("body", "joint", "is_slide"),
    [
        ("", "", True),
        ("", 'class="inner"', True),
        ('childclass="turning"', "", False),
        ('childclass="turning"', 'class="inner"', True),
        ('childclass="turning"', 'type="slide"', True),
    ],
)
def test_a_joint_is_of_the_type_that_its_class_says(body: str, joint: str, is_slide: bool) -> None:
    text = ROBOT.replace("<worldbody><body>", f"{CLASSES}<worldbody><body {body}>").replace('axis="0 0 1"', joint)
    fitting, other = make_model(*SPRUNG), as_linear(make_model(*SPRUNG))
    if is_slide:
        fitting, other = other, fitting
    model = mujoco.MjModel.from_xml_string(apply_to_mjcf(export_mjcf(fitting), text, "elbow"))
    assert model.jnt_type[0] == (mujoco.mjtJoint.mjJNT_SLIDE if is_slide else mujoco.mjtJoint.mjJNT_HINGE)
    assert model.qpos_spring[0] == pytest.approx(0.2)
    with pytest.raises(ExportError, match="'elbow' in the file to write into is of type"):
        apply_to_mjcf(export_mjcf(other), text, "elbow")


def test_a_type_that_an_included_file_may_state_is_left_to_it() -> None:
    text = ROBOT.replace("<worldbody>", '<include file="defaults.xml"/><worldbody>')
    assert "elbow" in apply_to_mjcf(export_mjcf(as_linear(make_model())), text, "elbow")


@pytest.mark.parametrize(
    ("kind", "is_linear"), [("prismatic", False), ("fixed", False), ("revolute", True), ("continuous", True)]
)
def test_urdf_joint_of_another_kind_is_refused(kind: str, is_linear: bool) -> None:
    text = f'<robot name="r"><joint name="elbow" type="{kind}"/></robot>'
    wrong, right = make_model(), as_linear(make_model())
    if is_linear:
        wrong, right = right, wrong
    with pytest.raises(ExportError, match=f"of type {kind}; the friction model is of a"):
        apply_to_urdf(export_urdf(wrong), text, "elbow")
    assert kind == "fixed" or "dynamics" in apply_to_urdf(export_urdf(right), text, "elbow")


def test_a_ball_joint_is_refused_and_a_snippet_has_the_type_of_the_model() -> None:
    with pytest.raises(ExportError, match="of type ball"):
        apply_to_mjcf(export_mjcf(make_model()), ROBOT.replace('axis="0 0 1"', 'type="ball"'), "elbow")
    linear = as_linear(make_model())
    assert 'type="slide"' in apply_to_mjcf(export_mjcf(linear), None, "elbow")
    assert 'type="prismatic"' in apply_to_urdf(export_urdf(linear), None, "elbow")


def test_mjcf_friction_goes_to_the_joint_of_a_body() -> None:
    text = ROBOT.replace("<actuator>", '<equality><joint name="elbow" joint1="elbow"/></equality><actuator>')
    root = ET.fromstring(apply_to_mjcf(export_mjcf(make_model(), "frictionloss"), text, "elbow"))
    body, constraint = root.find("worldbody//joint"), root.find("equality/joint")
    assert body is not None
    assert constraint is not None
    assert "frictionloss" in body.attrib
    assert "frictionloss" not in constraint.attrib


def test_urdf_friction_goes_to_the_joint_and_not_to_its_interfaces() -> None:
    control = '<ros2_control name="c"><joint name="elbow"><command_interface name="effort"/></joint></ros2_control>'
    text = f'<robot name="r"><joint name="elbow" type="revolute"/>{control}</robot>'
    root = ET.fromstring(apply_to_urdf(export_urdf(make_model()), text, "elbow"))
    assert root.find("joint/dynamics") is not None
    assert root.find("ros2_control/joint/dynamics") is None


def test_urdf_keeps_limits_and_states_its_loss() -> None:
    text = '<robot name="r"><joint name="elbow" type="revolute"><limit effort="1" velocity="2"/></joint></robot>'
    export = export_urdf(make_model())
    joint = ET.fromstring(apply_to_urdf(export, text, "elbow")).find("joint")
    assert joint is not None
    assert {child.tag for child in joint} == {"limit", "dynamics"}
    assert "Stribeck" in str(export.fidelity)
    assert export.fidelity.relative_rms > 0.05


def test_urdf_of_viscous_friction_loses_nothing() -> None:
    export = export_urdf(make_model(Viscous(0.3)))
    assert export.fidelity.largest < 1e-12
    assert float(export.joint["damping"]) == pytest.approx(0.3)


def test_symmetric_curve_keeps_its_shape() -> None:
    assert export_mjcf(make_model(Stribeck(FORWARD)), "dcmotor").fidelity.largest < 1e-12


@pytest.mark.parametrize("angle", ["degree", "radian"])
@pytest.mark.parametrize("position", [-0.7, 0.0, 0.1, 1.3])
def test_cogging_and_spring_are_said_natively(position: float, angle: str) -> None:
    robot = ROBOT.replace("<option", f'<compiler angle="{angle}"/><option', 1)
    law = (Stribeck(FORWARD), Cogging(0.03, -0.05, 6.0), SpringTorque(0.4, 0.2, 0.5))
    export = export_mjcf(make_model(*law), "dcmotor")
    assert export.fidelity.largest < 1e-12
    model = mujoco.MjModel.from_xml_string(apply_to_mjcf(export, robot, "elbow"))
    data = mujoco.MjData(model)
    data.qpos[0] = position
    mujoco.mj_forward(model, data)
    expected = 0.03 * np.sin(6.0 * position) - 0.05 * np.cos(6.0 * position) + 0.4 * (position - 0.2)
    expected += 0.2 * (position - 0.2) ** 3
    assert -float(data.qfrc_actuator[0] + data.qfrc_passive[0]) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("way", ["dcmotor", "damping", "frictionloss"])
@pytest.mark.parametrize(
    "term",
    [
        LuGre(StribeckCurve(0.3, 0.3, 1.0, 0.0), StribeckCurve(0.2, 0.2, 1.0, 0.0), 100.0, 0.0),
        SmoothedCoulomb(0.3, 0.01),
        Coulomb(0.3),
    ],
    ids=lambda term: term.name,
)
def test_a_level_of_its_own_beside_the_curve_slides_as_part_of_it(term: Term, way: MjcfWay) -> None:
    """A bristle that holds a part of the friction was left out: the simulated joint slid with the rest alone."""
    curve = BidirectionalStribeck(FORWARD, REVERSE)
    export = export_mjcf(make_model(curve, term), way)
    assert f"how friction builds up after a reversal by {term.name}" in str(export.fidelity)
    assert "left out" not in str(export.fidelity)
    levels = (0.3, 0.2) if isinstance(term, LuGre) else (0.3, 0.3)
    ahead, back = (
        replace(one, coulomb_torque=one.coulomb_torque + level, static_torque=one.static_torque + level)
        for one, level in zip((FORWARD, REVERSE), levels, strict=True)
    )
    whole = export_mjcf(make_model(BidirectionalStribeck(ahead, back)), way)
    assert (export.joint, export.actuator) == (whole.joint, whole.actuator)


@pytest.mark.parametrize("way", ["damping", "frictionloss"])
def test_what_is_left_out_is_said(way: MjcfWay) -> None:
    export = export_mjcf(make_model(Stribeck(FORWARD), Cogging(0.03, -0.05, 6.0)), way)
    assert "left out: cogging" in str(export.fidelity)
    assert "left out: cogging" in str(export_urdf(make_model(Stribeck(FORWARD), Cogging(0.03, 0.0, 6.0))).fidelity)


@pytest.mark.parametrize("way", ["dcmotor", "damping", "frictionloss"])
@pytest.mark.parametrize(
    "term",
    [
        ThermalFriction(0.05, 0.08, 0.002, 0.001, 30.0),
        KinematicError(2e-3, -1e-3, 9.0, 0.3, 1.0, -0.5),
        DwellStiction(0.2, 0.3, 5e-3, 3e-3),
    ],
    ids=lambda term: term.name,
)
def test_a_term_that_a_simulator_cannot_hold_is_left_out_and_changes_nothing_else(term: Term, way: MjcfWay) -> None:
    plain, model = make_model(), make_model(BidirectionalStribeck(FORWARD, REVERSE), term)
    for export, without in (
        (export_mjcf(model, way), export_mjcf(plain, way)),
        (export_urdf(model), export_urdf(plain)),
    ):
        assert f"left out: {term.name}" in str(export.fidelity)
        assert (export.joint, export.actuator) == (without.joint, without.actuator)


def test_a_lag_is_lost_and_said() -> None:
    model = make_model(LaggedStribeck(FORWARD, REVERSE, lag=0.008))
    for export, prompt in (
        (export_mjcf(model), export_mjcf(make_model())),
        (export_urdf(model), export_urdf(make_model())),
    ):
        assert "friction does not lag the velocity, by 0.008 s in the model" in str(export.fidelity)
        assert export.joint == prompt.joint


@pytest.mark.parametrize(("text", "match"), [("<a", "not XML"), ("<robot/>", "root"), (ROBOT, "no joint 'knee'")])
def test_foreign_files_are_refused(text: str, match: str) -> None:
    with pytest.raises(ExportError, match=match):
        apply_to_mjcf(export_mjcf(make_model()), text, "knee")


@pytest.mark.parametrize("name", ["el\x1bbow", "el\x00bow", "el\nbow", "el\ufffebow", "el\ud800bow"])
def test_a_joint_whose_name_no_xml_holds_is_refused_by_name(name: str) -> None:
    for refuse in (apply_to_mjcf, apply_to_urdf):
        export = export_mjcf(make_model()) if refuse is apply_to_mjcf else export_urdf(make_model())
        with pytest.raises(
            ExportError, match=r"is called 'el\\.*bow', and no XML file holds '\\.*': give the model a plain name"
        ):
            refuse(export, None, name)

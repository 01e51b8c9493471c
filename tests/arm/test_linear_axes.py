"""Axes that slide have the friction of joints that turn, a bristle by its way in metres, but not what has an angle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import build_friction_model, examine_arm
from fricomp.arm.coordinates import ArmModel
from fricomp.arm.examination import match_recordings
from fricomp.arm.friction import JointForm
from fricomp.arm.identification import identify_arm
from fricomp.arm.rigid.simulated_arm import read_arm
from fricomp.arm.search.early_torque import EarlyTorques
from fricomp.arm.search.proposal import propose_models
from fricomp.laws import BidirectionalStribeck, FloatArray, LuGre

from .moving_arm import record_arm
from .test_examination import names_of

_AXES = ("bridge", "ram", "yaw")
_PITCH = 0.1
_MJCF = """<mujoco><worldbody><body name="a"><inertial pos="0 0 0" mass="4" diaginertia="0.1 0.1 0.1"/>
<joint name="bridge" type="slide" axis="1 0 0" armature="1"/>
<body name="b"><inertial pos="0 0 -0.1" mass="2" diaginertia="0.02 0.02 0.02"/>
<joint name="ram" type="slide" axis="0 0 1" armature="1"/>
<body name="c"><inertial pos="0.05 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>
<joint name="yaw" axis="0 0 1" armature="0.1"/></body></body></body></worldbody></mujoco>"""


def _fall_with_speed(joint: int, _: FloatArray, v: FloatArray, __: FloatArray) -> FloatArray:
    return np.asarray((0.5 if joint == 0 else 0.0) * np.exp(-((v / 0.11) ** 2)) * np.sign(v))


def _ripple(joint: int, q: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
    return np.asarray((0.6 if joint == 0 else 0.0) * np.cos(2.0 * np.pi * q / _PITCH + 0.4))


def _rub_late(joint: int, _: FloatArray, v: FloatArray, __: FloatArray) -> FloatArray:
    """Friction of the bridge as a bristle of a tenth of a millimetre has it: 8 ms after each reversal."""
    return np.asarray((1.2 if joint == 0 else 0.0) * (np.sign(np.roll(v, 2)) - np.sign(v)))


def _bend_at_reversals(joint: int, q: FloatArray, v: FloatArray, __: FloatArray) -> FloatArray:
    """Friction of the bridge that builds up over nine tenths of a millimetre."""
    z, turned = 0.0, np.zeros_like(q)
    for k, step in enumerate(np.diff(q, prepend=q[0])):
        z = np.sign(step) + (z - np.sign(step)) * np.exp(-abs(step) / 9e-4)
        turned[k] = z
    return np.asarray((1.2 if joint == 0 else 0.0) * (turned - np.sign(v)))


@pytest.fixture(scope="module")
def simulation(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("gantry") / "gantry.xml"
    path.write_text(_MJCF)
    return path


def test_a_linear_axis_has_its_stribeck_curve(simulation: Path) -> None:
    found = examine_arm(record_arm(simulation, _fall_with_speed, duration=30.0, joints=_AXES, seed=1), simulation)
    assert names_of(found.record) == {name: [] for name in _AXES}
    (core,) = build_friction_model(found.answer.identification, 0).law.terms
    assert isinstance(core, BidirectionalStribeck)
    assert core.forward.stribeck_velocity == pytest.approx(0.11, rel=0.2)
    assert core.forward.coulomb_torque == pytest.approx(1.2, rel=0.05)
    assert core.forward.static_torque - core.forward.coulomb_torque == pytest.approx(0.5, rel=0.2)
    assert found.record.joints[0].unit == "N"


def test_the_force_ripple_of_a_linear_axis_is_named_with_its_pitch(simulation: Path) -> None:
    found = examine_arm(record_arm(simulation, _ripple, duration=20.0, joints=_AXES), simulation)
    assert names_of(found.record) == {"bridge": ["cogging"], "ram": [], "yaw": []}
    order = found.record.joints[0].effects[0].parameters["order"]
    assert order.unit == "1/m"
    assert order.value == pytest.approx(2.0 * np.pi / _PITCH, rel=0.02)


def test_the_presliding_of_a_linear_axis_is_named_with_its_way(simulation: Path) -> None:
    recordings = record_arm(simulation, _bend_at_reversals, duration=30.0, joints=_AXES, size=0.2)
    found = examine_arm(recordings, simulation)
    assert names_of(found.record) == {"bridge": ["presliding_hysteresis"], "ram": [], "yaw": []}
    parameters = found.record.joints[0].effects[0].parameters
    assert parameters["breakaway_distance"].unit == "m"
    assert parameters["breakaway_distance"].ci95[0] < 9e-4 < parameters["breakaway_distance"].ci95[1]
    assert parameters["level"].value == pytest.approx(1.2, rel=0.1)
    terms = build_friction_model(found.answer.identification, 0).law.terms
    (bristle,) = (one for one in terms if isinstance(one, LuGre))
    way = bristle.forward.coulomb_torque / bristle.sigma_0
    assert way == pytest.approx(parameters["breakaway_distance"].value)


@pytest.mark.parametrize("whole", [True, False])
def test_a_torque_is_late_where_what_its_links_ask_for_is(simulation: Path, whole: bool) -> None:
    """And not where friction alone is."""
    recordings = record_arm(simulation, None if whole else _rub_late, duration=20.0, joints=_AXES)
    if whole:
        recordings[0] = recordings[0].with_channels(torque=np.roll(recordings[0].torque, 2))
    found = identify_arm(*match_recordings(recordings, simulation))
    assert EarlyTorques(found.rows, found.equations, found.fit).is_link_late(0) is whole


def test_what_goes_with_an_angle_is_not_tried_on_a_linear_axis(simulation: Path) -> None:
    model = ArmModel(tuple(JointForm() for _ in _AXES))
    tried = {name for name, _ in propose_models(read_arm(simulation, _AXES), model)}
    angular = ("position_coulomb", "backlash")
    assert {f"yaw: {name}" for name in angular} <= tried
    assert not {f"ram: {name}" for name in angular} & tried
    assert {
        "ram: presliding_hysteresis",
        "ram: stribeck",
        "ram: load_coulomb",
        "ram: cogging",
        "ram: quadratic_drag",
        "ram: torque_delay",
    } <= tried


def test_beside_a_rotor_that_is_held_at_none_nobody_knows_what_a_slide_weighs(tmp_path: Path) -> None:
    """Of 4 kg and 9 kg in the simulation: it came as 5.3 kg (4.6 to 6.1) beside a rotor of -1e-18 kg."""
    heavy, right = tmp_path / "heavy.xml", tmp_path / "right.xml"
    right.write_text(_MJCF)
    heavy.write_text(_MJCF.replace('mass="4"', 'mass="9"'))
    record = examine_arm(record_arm(right, duration=20.0, joints=_AXES), heavy).record
    assert names_of(record) == {name: [] for name in _AXES}
    low, high = record.links[0].mass.ci95
    assert low < 4.0 < high
    assert "mass" not in record.links[0].determined
    assert not any("states other numbers" in line for line in record.summary)

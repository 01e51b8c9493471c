"""A simulation's own spring: read, taken off the torque, and named only where the joint has another one."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fricomp.diagnosis import RigidJoint, diagnose
from fricomp.diagnosis.effects.forward_part import ForwardPart
from fricomp.diagnosis.effects.spring import combine_springs
from fricomp.diagnosis.forward.forward import add_spring
from fricomp.diagnosis.inputs.rigid import Spring, read_simulation
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Contribution, Plant
from fricomp.laws import OperatingPoint, SpringTorque

from ..toy_joint import ToyJoint, recording

_MJCF = """<mujoco><compiler angle="radian"/><worldbody><body><joint name="knee" type="hinge" axis="0 1 0" {spring}/>
<inertial pos="0 0 -0.2" mass="2" diaginertia="0.03 0.03 0.03"/></body></worldbody></mujoco>"""
_GRAVITY = (1.773, 5.732)
_PLANT = Plant(0.35, _GRAVITY, 0.1, (2.0, 2.9, 0.06, 1.1), (2.3, 3.3, 0.04, 1.3), 4e4)


def test_the_spring_of_a_simulation_is_read_with_its_reference(tmp_path: Path) -> None:
    path = tmp_path / "joint.xml"
    path.write_text(_MJCF.format(spring='stiffness="6" springref="0.3"'))
    spring = read_simulation(path).spring
    assert spring is not None
    assert (spring.stiffness, spring.reference) == (6.0, 0.3)
    np.testing.assert_allclose(spring.compute_torque(np.array([0.3, 0.5])), [0.0, 1.2], atol=1e-12)
    path.write_text(_MJCF.format(spring=""))
    assert read_simulation(path).spring is None


def test_its_torque_is_taken_off_the_recorded_one() -> None:
    measured = recording(ToyJoint(spring=(6.0, 0.3, 0.0)), "fourier", 10.0)
    (plain,), (track,) = build_tracks([measured]), build_tracks([measured], (), Spring((6.0,), 0.3))
    taken = plain.torque - track.torque
    np.testing.assert_allclose(taken, 6.0 * (plain.position - 0.3), atol=2e-3)
    np.testing.assert_allclose(taken, track.channels["simulated_spring"], atol=1e-12)
    assert track.torque_noise == plain.torque_noise


def test_a_forward_simulation_has_it_back() -> None:
    measured = recording(ToyJoint(spring=(6.0, 0.3, 0.0)), "fourier", 10.0)
    (plain,), (track,) = build_tracks([measured]), build_tracks([measured], (), Spring((6.0,), 0.3))
    whole, added = add_spring(track, ForwardPart(Contribution(additive=1.0)))
    np.testing.assert_allclose(whole.torque, plain.torque, atol=1e-12)
    np.testing.assert_allclose(added.along.additive, 1.0 + 6.0 * (plain.position - 0.3), atol=2e-3)
    assert add_spring(plain, added) == (plain, added)


@pytest.mark.parametrize("hardening", [0.0, 0.3])
def test_the_written_spring_stands_for_that_of_the_simulation_too(hardening: float) -> None:
    given, position = Spring((2.0,), 0.4), np.linspace(-1.0, 1.0, 9)
    found = {"stiffness": 1.5, "centre": -0.2, "hardening": hardening}
    term, plant = combine_springs(found, _PLANT, given)
    assert term is not None
    written = np.array([float(term.torque(OperatingPoint(velocity=1.0, position=q))) for q in position])
    stretch = position + 0.2
    wanted = given.compute_torque(position) + 1.5 * stretch * (1.0 + hardening * stretch**2) + _PLANT.offset
    np.testing.assert_allclose(written + plant.offset, wanted, atol=1e-9)


def test_a_spring_that_the_joint_lacks_is_written_as_none() -> None:
    term, _ = combine_springs({"stiffness": -2.1, "centre": 0.0, "hardening": 0.0}, _PLANT, Spring((2.0,), 0.4))
    assert term == SpringTorque(0.0, 0.4, 0.0)


@pytest.mark.slow
def test_the_same_spring_on_both_sides_is_not_missing() -> None:
    joint = ToyJoint(spring=(6.0, 0.3, 0.0))
    given = RigidJoint(joint.inertia, _GRAVITY, 0.0, 0.0, 0.0, True, Spring((6.0,), 0.3))
    diagnosis = diagnose(recording(joint, "fourier", 20.0, every=2), given)
    assert diagnosis.verdict == "consistent", diagnosis.sentences


@pytest.mark.slow
def test_a_spring_of_the_simulation_that_the_joint_lacks_is_said_plainly() -> None:
    joint = ToyJoint()
    given = RigidJoint(joint.inertia, _GRAVITY, 0.0, 0.0, 0.0, True, Spring((2.0,)))
    diagnosis = diagnose(recording(joint, "rich", 25.0, every=2), given)
    assert diagnosis.verdict == "parameters", diagnosis.sentences
    (effect,) = diagnosis.effects
    assert effect.name == "spring_torque"
    assert "that the joint does not show" in effect.sentence
    low, high = effect.parameters["stiffness_change"].ci95
    assert low <= -2.0 <= high
    assert diagnosis.extended_model is not None
    (term,) = [one for one in diagnosis.extended_model.law.terms if isinstance(one, SpringTorque)]
    assert term.stiffness < 0.2
    same = replace(given, spring=None)
    assert diagnose(recording(joint, "rich", 25.0, every=2), same).verdict == "consistent"

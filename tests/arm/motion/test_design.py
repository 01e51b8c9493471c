"""Motions of all joints: smooth, within limits and free of contact, and more telling than chance ones."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm.motion import FourierMotion, MotionLimits, design_excitation
from fricomp.arm.motion.design import _draw, _fit, _Judge
from fricomp.arm.motion.limits import ContactCheck
from fricomp.arm.rigid.simulated_arm import read_arm
from fricomp.errors import ParameterError

from ..moving_arm import JOINTS, write_arm

LIMITS = MotionLimits.from_ranges([(-1.5, 1.5), (-1.0, 2.0), None], [3.0, 3.0, 4.0], [60.0, 30.0, 8.0])


def test_a_motion_is_at_rest_at_both_ends_and_its_derivatives_are_its_own() -> None:
    rng = np.random.default_rng(0)
    sine, cosine = rng.normal(size=(2, 2, 5))
    motion = FourierMotion(np.array([0.3, -1.0]), sine, cosine, frequency=0.1, duration=25.0)
    time = np.linspace(0.0, 25.0, 20001)
    q, v, a = motion.sample(time)
    assert q[[0, -1]] == pytest.approx(np.tile(motion.centre, (2, 1)), abs=1e-9)
    assert np.abs(v[[0, -1]]).max() < 1e-9
    assert np.abs(a[[0, -1]]).max() < 1e-9
    assert np.gradient(q, time, axis=0)[5:-5] == pytest.approx(v[5:-5], abs=1e-3)
    assert np.gradient(v, time, axis=0)[5:-5] == pytest.approx(a[5:-5], abs=1e-2)


def test_the_chosen_motion_keeps_its_limits_and_tells_more_than_chance_ones(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    arm = read_arm(path, JOINTS)
    plan = design_excitation(arm, path, LIMITS, duration=20.0)
    time = np.linspace(0.0, 20.0, 4001)
    position, velocity, acceleration = plan.motion.sample(time)
    judge = _Judge(arm, LIMITS)
    torque = judge.compute_torque(position[::7], velocity[::7], acceleration[::7])
    assert np.all(position >= LIMITS.lowest)
    assert np.all(position <= LIMITS.highest)
    assert np.all(np.abs(velocity) <= 0.55 * LIMITS.speed)
    assert np.all(np.abs(torque) <= 0.7 * LIMITS.torque)
    rng, contacts = np.random.default_rng(5), ContactCheck(path, JOINTS)
    chance = [_fit(_draw(LIMITS, 20.0, rng), judge, contacts, None) for _ in range(10)]
    assert plan.information > max(one.information for one in chance if one is not None)


def test_a_motion_that_would_touch_the_ground_is_made_smaller(tmp_path: Path) -> None:
    """A floor just below the shoulder: at full swing the hand would be far below it."""
    text = write_arm(tmp_path).read_text()
    text = text.replace("<worldbody>", '<worldbody><geom type="plane" size="3 3 0.1" pos="0 0 -0.1"/>')
    text = text.replace('<joint name="wrist"', '<geom type="sphere" size="0.05" pos="0 0 0.1"/><joint name="wrist"')
    path = tmp_path / "floor.xml"
    path.write_text(text)
    arm, wide = read_arm(path, JOINTS), MotionLimits.from_ranges([(-3.0, 3.0)] * 3, [3.0] * 3, [200.0] * 3)
    plan = design_excitation(arm, path, wide, duration=12.0)
    contacts = ContactCheck(path, JOINTS)
    assert contacts.find(plan.motion.sample(np.linspace(0.0, 12.0, 150))[0]) == ""
    assert "hand" in contacts.find(np.array([[3.0, 0.0, 0.0]]))


def test_limits_that_leave_no_motion_are_refused(tmp_path: Path) -> None:
    path = write_arm(tmp_path)
    arm = read_arm(path, JOINTS)
    weak = MotionLimits.from_ranges([(-1.0, 1.0)] * 3, [1.0] * 3, [0.5] * 3)
    with pytest.raises(ParameterError, match="no motion fits into the limits"):
        design_excitation(arm, path, weak, duration=12.0)
    with pytest.raises(ParameterError, match="from 10 to 600 s"):
        design_excitation(arm, path, LIMITS, duration=1.0)
    with pytest.raises(ParameterError, match="above 0"):
        MotionLimits.from_ranges([(1.0, -1.0)], [1.0], [1.0])

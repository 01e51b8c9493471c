"""Friction of a simulator that creeps: its level is found where it is viscous over slow motion, nothing is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import build_friction_model, examine_arm
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm

_JOINT, _LEVEL, _SPEED, _LEAD, _RATE = 1, 2.3, 0.12, 0.0095, 250.0
_STUCK = 0.8
"""[N·m] of dry friction that every elbow has."""


def creep(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
    """As MuJoCo's friction loss: viscous below a speed, ahead of the velocity, and all that is dry of it."""
    ahead = v + _LEAD * np.gradient(v) * _RATE
    return (_LEVEL * np.clip(ahead / _SPEED, -1.0, 1.0) - _STUCK * np.sign(v)) * (joint == _JOINT)


def creep_in_part(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
    return creep(joint, q, v, load) + _STUCK * np.sign(v) * (joint == _JOINT)


def stick(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
    return (_LEVEL - _STUCK) * np.sign(v) * (joint == _JOINT)


@pytest.mark.parametrize("size", [0.3, 1.0])
def test_friction_that_creeps_has_its_level_and_no_name(tmp_path: Path, size: float) -> None:
    """With nothing for it, half of the level came as viscous friction where the motion is slow."""
    simulation = write_arm(tmp_path)
    found = examine_arm(record_arm(simulation, creep, rate=_RATE, size=size), simulation)
    sticking = examine_arm(record_arm(simulation, stick, rate=_RATE, size=size), simulation).record.joints[_JOINT]
    joint = found.record.joints[_JOINT]
    level = sticking.friction["coulomb"].value
    low, high = joint.friction["coulomb"].ci95
    assert low < level < high
    assert joint.friction["coulomb"].value == pytest.approx(level, rel=0.05)
    assert [one.effects for one in found.record.joints] == [(), (), ()]
    assert sticking.creep_velocity is None
    if size < 1.0:
        assert joint.creep_velocity == pytest.approx(_SPEED, rel=0.4)
        assert any("Friction creeps below a speed" in one and "elbow" in one for one in found.record.summary)
        law = build_friction_model(found.answer.identification, _JOINT).law
        assert "smoothed_coulomb" in {term.name for term in law.terms}


def test_friction_that_creeps_in_part_is_not_told_to_creep(tmp_path: Path) -> None:
    """A joint that sticks for a moment at reversals comes so: joints with a friction that holds were told to creep."""
    simulation = write_arm(tmp_path)
    found = examine_arm(record_arm(simulation, creep_in_part, rate=_RATE, size=0.3), simulation)
    assert "creep" in found.answer.identification.fit.model.forms[_JOINT].names
    assert found.record.joints[_JOINT].creep_velocity is None
    assert not any("creeps" in one for one in found.record.summary)


@pytest.mark.parametrize("part", [0.01, 0.03, 0.1])
def test_friction_that_is_a_hyperbolic_tangent_has_no_name(tmp_path: Path, part: float) -> None:
    """With the corner and the lead of MuJoCo's alone, joints of other simulators were told to have presliding."""
    simulation = write_arm(tmp_path)

    def round_off(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
        level = (1.2, 0.8, 0.3)[joint]
        rounded: FloatArray = np.tanh(v / (part * float(np.max(np.abs(v)))))
        return level * (rounded - np.sign(v))

    found = examine_arm(record_arm(simulation, round_off, rate=_RATE), simulation)
    assert [one.effects for one in found.record.joints] == [(), (), ()]
    for joint, level in zip(found.record.joints, (1.2, 0.8, 0.3), strict=True):
        assert joint.friction["coulomb"].value == pytest.approx(level, rel=0.03)

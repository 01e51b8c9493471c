"""Friction of a simulator that creeps: its level is found where it is viscous over slow motion, nothing is named."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fricomp.arm import build_friction_model, examine_arm
from fricomp.laws import FloatArray

from .moving_arm import record_arm, write_arm

_JOINT, _LEVEL, _SPEED, _LEAD, _RATE = 1, 1.5, 0.12, 0.0095, 250.0


def creep(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
    """As MuJoCo's friction loss: viscous below a speed, and ahead of the velocity."""
    ahead = v + _LEAD * np.gradient(v) * _RATE
    return _LEVEL * np.clip(ahead / _SPEED, -1.0, 1.0) * (joint == _JOINT)


def stick(joint: int, q: FloatArray, v: FloatArray, load: FloatArray) -> FloatArray:
    return _LEVEL * np.sign(v) * (joint == _JOINT)


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

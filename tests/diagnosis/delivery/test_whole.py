"""The written model held against all of a long recording."""

from __future__ import annotations

import numpy as np

from fricomp.diagnosis.delivery.whole import look_over_whole
from fricomp.diagnosis.inputs.checks import PART_OF
from fricomp.laws import Coulomb, FrictionLaw
from fricomp.model import FrictionModel, JointDynamics
from fricomp.recording import Recording

_MODEL = FrictionModel(FrictionLaw((Coulomb(1.0),)), dynamics=JointDynamics(inertia=0.1))


def _record(dragging: tuple[float, float], rise: float = 0.0) -> Recording:
    time = np.arange(0.0, 300.0, 0.005)
    velocity = 1.5 * np.cos(1.5 * time)
    drag = 0.8 * ((time >= dragging[0]) & (time < dragging[1])) + rise * time / 300.0
    torque = -0.1 * 2.25 * np.sin(1.5 * time) + (1.0 + drag) * np.sign(velocity)
    torque += 0.02 * np.random.default_rng(3).standard_normal(time.size)
    recording = Recording(time, np.sin(1.5 * time), torque)
    return recording.with_metadata(extra={PART_OF: 0})


def _look(recording: Recording) -> list[str]:
    searched = [recording.window(20.0, 40.0), recording.window(200.0, 220.0)]
    return look_over_whole(_MODEL, [recording], searched, 10.0, complete=True)


def test_a_joint_that_is_the_same_throughout_is_told_with_both_errors() -> None:
    (said,) = _look(_record((0.0, 0.0)))
    assert "40 s were searched" in said
    assert "in the other 260 s friction.json leaves" in said


def test_what_acts_at_one_time_alone_is_told_with_it() -> None:
    _, said = _look(_record((110.0, 128.0)))
    assert "between 110 and 130 s" in said


def test_friction_that_rises_is_told() -> None:
    _, said = _look(_record((0.0, 0.0), rise=0.4))
    assert "friction rises by 0.30" in said

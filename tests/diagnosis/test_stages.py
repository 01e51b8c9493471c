"""What ends a diagnosis before its search."""

import sys
from dataclasses import replace
from typing import Any

import pytest

from fricomp.diagnosis import RigidJoint, course, diagnose
from fricomp.diagnosis.course import Course
from fricomp.diagnosis.inputs.given import Given
from fricomp.diagnosis.record.result import Kind, NamedEffect
from fricomp.diagnosis.verdict.judging import join_channels, judge

from .known import PLANT, known_baseline, known_findings, known_fit, known_search
from .toy_joint import ToyJoint, recording

_STAGES = sys.modules["fricomp.diagnosis.diagnose"]  # the package has a function of this name


class _SearchedError(Exception):
    """The search has begun."""


@pytest.mark.parametrize("loudness", [1.0, 3.0])
def test_an_inertia_far_from_the_simulation_ends_a_base_that_leaves_noise(
    loudness: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What leaves more may have bent the inertia: a stop that is met for half of the time did, by twenty times."""

    def search(*_: Any) -> None:
        raise _SearchedError

    monkeypatch.setattr(Course, "choose_base", lambda *_: lambda **_: known_baseline(loudness=loudness))
    monkeypatch.setattr(_STAGES, "conclude", search)
    simulation = RigidJoint(30.0 * PLANT.inertia, (0.0, 0.0), 0.0, 1.0, 2.0, True)
    recorded = recording(ToyJoint(), "fourier", 10.0, every=2)
    if loudness > 1.0:
        with pytest.raises(_SearchedError):
            diagnose(recorded, simulation)
    else:
        assert "inertia 30 or more times smaller" in " ".join(diagnose(recorded, simulation).sentences)


def _name(name: str, kind: Kind) -> NamedEffect:
    return NamedEffect(name=name, kind=kind, parameters={})


def test_a_delay_of_the_base_stays_named_where_the_files_take_physics_back(monkeypatch: pytest.MonkeyPatch) -> None:
    """Taken back is what the written model does worse with; it has no part in how late the torque acts."""
    baseline = known_baseline()
    findings = known_findings(baseline)
    physics, late = _name("cogging", "physics"), _name("torque_delay", "measurement")
    plain = judge(findings)
    before = join_channels(replace(plain, effects=(physics,)), (late,))
    without = iter((known_search(known_fit(baseline, ("cogging",), 9.0)), None))
    monkeypatch.setattr(course, "deliver", lambda *_: None)
    monkeypatch.setattr(course, "leave_out_worse", lambda *_: next(without))
    monkeypatch.setattr(course, "_judge_case", lambda *_: (findings, plain))
    asked = Course(Given((), ()), None, 0, None)
    assert [one.name for one in course.hold_to_files(asked, (findings, before))[1].effects] == ["torque_delay"]

"""A motion is proposed only where it would tell explanations apart, whatever a refit makes of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.effects.structure import Candidate, Structure
from fricomp.diagnosis.joint.base import BASE_NAMES
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.diagnosis.search.refit import fit_from
from fricomp.diagnosis.verdict.experiment import _Motion, _rate, propose_motion
from fricomp.diagnosis.verdict.settings import EXPERIMENT

from ..toy_joint import FloatArray, ToyJoint, recording

_JOINT = ToyJoint(load_coulomb=0.01)


@pytest.fixture(scope="module")
def baseline() -> Baseline:
    tracks = build_tracks([recording(_JOINT, "slow", 15.0)])
    return prepare(tracks, observer=Observer(), nulls=12, seed=0)


@pytest.fixture(scope="module")
def fitted(baseline: Baseline) -> list[Explanation]:
    """Friction under load, friction that differs between driving and braking, and a drive that saturates."""
    driving = Candidate("load_quadratic", (("split", 1.0),))
    saturating = Candidate("torque_saturation", (("limit", 1e9),))  # without one, as its start is clipped
    candidates = (Candidate("load_coulomb", ()), driving, saturating)
    structures = [Structure(baseline.structure.contexts, (candidate,)) for candidate in candidates]
    return fit_from(baseline, [(one, baseline.fit.theta) for one in structures], baseline.box)


@pytest.mark.slow
def test_no_motion_tells_driving_and_braking_from_friction_under_load_and_another_gravity(
    baseline: Baseline, fitted: list[Explanation]
) -> None:
    linear, driving, _ = fitted
    assert driving.gain == pytest.approx(linear.gain, abs=1.0)
    assert propose_motion(baseline, linear, [driving], baseline.box) is None


def test_a_faster_motion_tells_what_a_slow_one_cannot(baseline: Baseline, fitted: list[Explanation]) -> None:
    linear, driving, saturating = fitted
    one_more = float(np.log(linear.fit.residual.size))  # what a parameter costs, such as a limit that is not reached
    assert saturating.gain == pytest.approx(linear.gain, abs=one_more)
    proposal = propose_motion(baseline, linear, [driving, saturating], baseline.box)
    assert proposal is not None
    assert proposal.separates == ("load_coulomb", "torque_saturation")
    assert 0.0 < proposal.difference < 1.0
    track = baseline.problem.tracks[0]
    wanted = proposal.motion["position_reference"]
    assert track.position.min() < wanted.min() < wanted.max() < track.position.max()
    assert np.ptp(np.diff(proposal.motion["time"])) < 1e-9


def test_a_rival_at_the_edge_of_its_domain_is_not_simulated_beyond_it(
    baseline: Baseline, fitted: list[Explanation], monkeypatch: pytest.MonkeyPatch
) -> None:
    linear, driving, _ = fitted
    box = baseline.box.join(driving.structure.build_box())
    late = np.arange(box.upper.size) == BASE_NAMES.index("delay")
    at_edge = replace(driving, fit=replace(driving.fit, theta=np.where(late, box.upper, driving.fit.theta)))
    simulated: list[FloatArray] = []
    rows = _Motion.predict_rows

    def watched(motion: _Motion, explanation: Explanation, points: Sequence[FloatArray]) -> FloatArray:
        simulated.extend(points if explanation is at_edge else ())
        return rows(motion, explanation, points)

    monkeypatch.setattr(_Motion, "predict_rows", watched)
    propose_motion(baseline, linear, [at_edge], baseline.box)
    assert len(simulated) > box.upper.size
    assert np.all(np.array(simulated) <= box.upper)


def test_a_rival_that_does_not_simulate_on_a_motion_is_not_told_by_it(
    baseline: Baseline, fitted: list[Explanation], monkeypatch: pytest.MonkeyPatch
) -> None:
    linear, driving, saturating = fitted
    rows = _Motion.predict_rows

    def runs_away(motion: _Motion, explanation: Explanation, points: Sequence[FloatArray]) -> FloatArray:
        result = rows(motion, explanation, points)
        result[1:] *= np.inf if explanation is saturating else 1.0
        return result

    monkeypatch.setattr(_Motion, "predict_rows", runs_away)
    assert propose_motion(baseline, linear, [driving, saturating], baseline.box) is None


def test_two_rivals_told_apart_are_worth_more_than_one_told_clearly() -> None:
    assert _rate([1.1 * EXPERIMENT.enough, 1.1 * EXPERIMENT.enough]) > _rate([0.0, 100.0 * EXPERIMENT.enough])
    assert _rate([1.1 * EXPERIMENT.enough, 0.5 * EXPERIMENT.enough]) > _rate([1.1 * EXPERIMENT.enough, 0.0])

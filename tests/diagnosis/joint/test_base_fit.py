"""Another try at the bristle of the base: taken where a fit ran away, and only there."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.diagnosis.joint.base import BASE_NAMES
from fricomp.diagnosis.joint.base_fit import fit_known, try_other_bristle
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.joint.settings import JOINT
from fricomp.diagnosis.joint.solver import Fit, minimise
from fricomp.diagnosis.search.preparation import Baseline, prepare

from ..toy_joint import ToyJoint, recording


@pytest.fixture(scope="module")
def baseline() -> Baseline:
    stiff = ToyJoint(sigma_0=2e6, torque_noise=0.02)
    tracks = build_tracks([recording(stiff, "fourier", 12.0, seed=4)], [None])
    return prepare(tracks, observer=Observer(), nulls=8, seed=0)


def _run_away(baseline: Baseline) -> Fit:
    """The fit from a soft bristle that is damped as much as it may be, held there."""
    box, theta = baseline.box, baseline.fit.theta.copy()
    held = [BASE_NAMES.index(name) for name in ("log_breakaway", "damping_time")]
    theta[held] = np.log(JOINT.softest_bristle), box.upper[held[1]]
    evaluate = baseline.problem.build_residual(baseline.problem.add_nothing)
    lower, upper = box.lower.copy(), box.upper.copy()
    lower[held], upper[held] = theta[held] - 1e-12, theta[held]
    return minimise(evaluate, theta, replace(box, lower=lower, upper=upper))


def test_a_fit_that_ran_away_is_brought_back(baseline: Baseline) -> None:
    away = _run_away(baseline)
    assert away.cost > 1.5 * baseline.fit.cost
    back = try_other_bristle(baseline.problem, away, baseline.box)
    assert back.cost < 1.1 * baseline.fit.cost
    travel = np.exp(back.theta[BASE_NAMES.index("log_breakaway")])
    assert travel < 0.1 * JOINT.softest_bristle


def test_a_quiet_fit_stays(baseline: Baseline) -> None:
    assert try_other_bristle(baseline.problem, baseline.fit, baseline.box) is baseline.fit


def test_a_loud_fit_with_little_damping_stays(baseline: Baseline) -> None:
    loud = replace(baseline.fit, residual=5.0 * baseline.fit.residual)
    assert try_other_bristle(baseline.problem, loud, baseline.box) is loud


def test_a_fit_goes_on_from_friction_that_creeps_and_is_not_ahead(baseline: Baseline) -> None:
    theta = baseline.fit.theta.copy()
    creep, lead = BASE_NAMES.index("creep_velocity"), BASE_NAMES.index("creep_lead")
    theta[[creep, lead]] = 1e-3, 0.0
    fit, box = fit_known(baseline.problem, theta, baseline.box)
    assert box.scale[lead] > 0.0
    assert np.all(np.isfinite(fit.jacobian))


def test_a_few_fast_strokes_are_not_how_fast_a_joint_usually_is(baseline: Baseline) -> None:
    """Beside them a fall of the friction over all that the joint did had passed for a narrow one."""
    (track,), problem = baseline.problem.tracks, baseline.problem
    fast = np.where(np.arange(track.size) < 0.02 * track.size, 20.0, track.velocity)
    usual = replace(problem, tracks=(replace(track, velocity=fast),)).usual_speed
    assert usual == pytest.approx(problem.usual_speed, rel=0.15)
    assert usual < 2.0

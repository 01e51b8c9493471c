"""The error before a parameter is put right: of a joint that has it as given and everything else refitted."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis import RigidJoint
from fricomp.diagnosis.evidence.as_given import fit_as_given
from fricomp.diagnosis.evidence.confirmation import confirm
from fricomp.diagnosis.joint.base import BASE_NAMES, unpack
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.observer import Observer
from fricomp.diagnosis.search.preparation import Baseline, prepare
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel

from ..toy_joint import ToyJoint, recording

pytestmark = pytest.mark.slow
_GRAVITY = (1.773, 5.732)


@pytest.fixture(scope="module")
def baseline() -> Baseline:
    tracks = build_tracks([recording(ToyJoint(), "fourier", 20.0)])
    given = RigidJoint(ToyJoint().inertia, _GRAVITY, 0.0, 0.0, 0.0, True)
    return prepare(tracks, observer=Observer(), nulls=8, seed=0, rigid=given)


def test_a_wrong_inertia_stays_and_the_rest_is_refitted(baseline: Baseline) -> None:
    wrong = RigidJoint(0.8 * ToyJoint().inertia, _GRAVITY, 0.0, 0.0, 0.0, True)
    fit = fit_as_given(baseline, ["inertia_error"], wrong, None)
    assert fit is not None
    assert unpack(fit.theta).inertia == pytest.approx(wrong.inertia, rel=1e-9)
    found = confirm(baseline, baseline.structure, baseline.fit, 0, given=fit)
    assert found.rmse_before > 2.0 * found.rmse_after
    assert found.explained > 0.9
    assert found.rmse_after == confirm(baseline, baseline.structure, baseline.fit, 0).rmse_after


def test_directions_that_differ_are_held_together(baseline: Baseline) -> None:
    forward, reverse = StribeckCurve(2.6, 2.6, 0.1, 0.5), StribeckCurve(1.7, 1.7, 0.1, 0.5)  # the joint: 2.0 and 2.3
    even = FrictionModel(FrictionLaw((BidirectionalStribeck(forward, reverse),)))
    fit = fit_as_given(baseline, ["direction_asymmetry"], None, even)
    assert fit is not None
    values = dict(zip(BASE_NAMES, fit.theta, strict=True))
    assert values["forward.coulomb_torque"] - values["reverse.coulomb_torque"] == pytest.approx(0.9)
    assert values["offset"] == 0.0
    found = confirm(baseline, baseline.structure, baseline.fit, 0, given=fit)
    assert np.isfinite(found.rmse_before)
    assert found.rmse_before > found.rmse_after


def test_gravity_of_a_simulation_does_not_take_up_a_constant_torque(baseline: Baseline) -> None:
    forward, reverse = StribeckCurve(2.6, 2.6, 0.1, 0.5), StribeckCurve(1.7, 1.7, 0.1, 0.5)
    uneven = FrictionModel(FrictionLaw((BidirectionalStribeck(forward, reverse),)))
    rigid = RigidJoint(ToyJoint().inertia, _GRAVITY, 0.0, 0.0, 0.0, True)
    free, held = (fit_as_given(baseline, ["direction_asymmetry"], one, uneven) for one in (None, rigid))
    assert free is not None
    assert held is not None
    np.testing.assert_array_equal(held.theta[:3], baseline.fit.theta[:3])
    assert held.cost > 2.0 * free.cost


def test_nothing_is_as_given_where_nothing_was(baseline: Baseline) -> None:
    assert fit_as_given(baseline, ["inertia_error", "direction_asymmetry"], None, None) is None
    assert fit_as_given(baseline, ["velocity_filter_lag"], RigidJoint(1.0, _GRAVITY, 0.0, 0.0, 0.0, True), None) is None

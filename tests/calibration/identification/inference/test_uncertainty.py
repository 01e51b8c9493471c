import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.calibration.identification import (
    block_bootstrap,
    choose_law,
    plan_informative_speeds,
    profile_interval,
)
from fricomp.calibration.identification.doubt import with_covariance, with_open_profiles
from fricomp.errors import IdentificationError

from ..paper import PROBLEM, noisy

NAME = "stribeck.forward.stribeck_velocity"


def test_profile_agrees_with_the_covariance_where_that_is_fair() -> None:
    draw = noisy("relative", 1)
    result = identify(draw.velocity, draw.torque, method="least_squares", noise="relative")
    interval, plain = profile_interval(result, NAME), result.interval(NAME)
    assert interval.upper - interval.lower == pytest.approx(plain.upper - plain.lower, rel=0.1)


def test_profile_is_as_wide_as_a_covariance_that_correlated_errors_widened() -> None:
    draw = noisy("relative", 1)
    result = identify(draw.velocity, draw.torque, method="least_squares", noise="relative")
    plain = profile_interval(result, NAME)
    wide = profile_interval(with_covariance(result, 4.0 * result.covariance), NAME)
    assert wide.upper - wide.lower == pytest.approx(2.0 * (plain.upper - plain.lower), rel=0.2)
    assert wide.lower < plain.lower < plain.upper < wide.upper


def test_an_interval_that_correlated_errors_leave_open_is_told() -> None:
    draw = noisy("relative", 1)
    fast = np.abs(draw.velocity) >= 0.06  # the bend lies below
    result = identify(draw.velocity[fast], draw.torque[fast], method="least_squares", noise="relative")
    assert with_open_profiles(result) is result
    name = "stribeck.reverse.stribeck_velocity"
    covariance, index = result.covariance.copy(), result.parameter_names.index(name)
    covariance[index, index] *= 60.0
    correlated = with_covariance(result, covariance)
    assert correlated.status == "converged"
    told = with_open_profiles(correlated)
    assert told.status == told.model.provenance.status == "not_identifiable"
    assert f"do not determine {name}: with what correlated errors add" in told.message


def test_block_bootstrap_widens_with_correlated_residuals() -> None:
    rng, draw = np.random.default_rng(0), noisy("relative", 0)
    exact = np.asarray(PROBLEM.law.torque(draw.velocity))
    slow = np.convolve(rng.normal(size=220), np.ones(20) / np.sqrt(20.0), mode="valid")
    result = identify(draw.velocity, exact * (1.0 + 0.02 * slow[:201]), method="least_squares", noise="relative")
    name = "stribeck.forward.coulomb_torque"
    deviation = block_bootstrap(result, 25, samples=60).standard_deviations()[name]
    assert deviation > 1.5 * result.standard_deviations[name]


def test_law_is_chosen_by_held_out_likelihood_and_says_why() -> None:
    draw = noisy("relative", 0)
    choice = choose_law(draw.velocity, draw.torque, laws=("coulomb", "coulomb_viscous", "stribeck"))
    assert choice.law == "stribeck"
    assert "held-out" in choice.reason
    velocity = np.linspace(-1.0, 1.0, 81)
    torque = np.sign(velocity) * 0.3 * (1.0 + 0.03 * np.random.default_rng(0).normal(size=81))
    assert choose_law(velocity, torque, laws=("coulomb", "coulomb_viscous", "stribeck")).law == "coulomb"


def test_planned_speeds_shrink_the_deviation_below_three_quarters_of_the_uniform_grid() -> None:
    draw = noisy("relative", 0)
    coarse = identify(draw.velocity[::4], draw.torque[::4], method="least_squares", noise="relative")
    plan = plan_informative_speeds(coarse.model, 1.0, 200)
    assert plan.ratio < 0.75
    assert plan.plateaus.sum() == 200
    assert np.max(np.abs(plan.velocity)) == pytest.approx(1.0)


def test_planning_refuses_what_it_cannot_plan() -> None:
    draw = noisy("relative", 0)
    coarse = identify(draw.velocity, draw.torque, method="least_squares", law="coulomb")
    with pytest.raises(IdentificationError, match="bidirectional"):
        plan_informative_speeds(coarse.model, 1.0, 200)

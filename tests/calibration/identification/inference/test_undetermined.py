"""What the data say nothing about is unknown, said to be so, and kept within what a real joint could have."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from fricomp.calibration.comparison import compare_models
from fricomp.calibration.identification import Status, expected_deviation, identify, save_identification
from fricomp.calibration.identification.estimation.form import separable_law
from fricomp.calibration.identification.estimation.information import (
    UNDETERMINED,
    compute_log_deviations,
    invert_information,
)
from fricomp.calibration.identification.estimation.likelihood import Noise
from fricomp.calibration.identification.estimation.observation import observe
from fricomp.calibration.identification.estimation.optimum import fit_likelihood, optimum_at
from fricomp.calibration.identification.inference.verdict import covariance_of, judge
from fricomp.calibration.sweep import SweepSettings, assume_friction, expected_deviations, plan_plateaus
from fricomp.calibration.sweep.planning.plan import Travel
from fricomp.control import Compensator
from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.trust import LARGEST_EXTRAPOLATION, find_doubt_in_status
from fricomp.errors import IdentificationError, ParameterError
from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel, load_model

from ..paper import noisy


def _fast(seed: int = 0) -> tuple[FloatArray, FloatArray]:
    """80 points, all of them above any bend."""
    velocity = np.concatenate([np.linspace(0.3, 1.0, 40), -np.linspace(0.3, 1.0, 40)])
    noise = np.random.default_rng(seed).normal(0.0, 0.003, velocity.size)
    return velocity, np.sign(velocity) * 0.2 + 0.05 * velocity + noise


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("law", ["stribeck", "symmetric_stribeck"])
def test_speeds_above_the_bend_give_no_boundless_friction(law: str, seed: int) -> None:
    velocity, torque = _fast(seed)
    result = identify(velocity, torque, law=law, seed=seed)
    assert result.status in (Status.NOT_IDENTIFIABLE, Status.WRONG_BASIN_SUSPECTED)
    assert "add speeds" in result.message or "second basin" in result.message
    dry = [value for name, value in result.parameters.items() if name.endswith(("coulomb_torque", "static_torque"))]
    assert max(dry) <= 10.0 * np.max(np.abs(torque)) * (1.0 + 1e-9)


@pytest.mark.slow
def test_an_undetermined_model_is_marked_refused_and_bounded(tmp_path: Path) -> None:
    velocity, torque = _fast()
    result = identify(velocity, torque, law="symmetric_stribeck")
    assert result.parameters["symmetric_stribeck.curve.static_torque"] > 5.0 * np.max(np.abs(torque))
    model = load_model(save_identification(result, tmp_path).model)
    assert model.provenance.status == "not_identifiable"
    assert model.provenance.message == result.message
    assert model.provenance.slowest_speeds == (0.3, 0.3)
    largest = np.max(np.abs(torque))
    assert model.provenance.largest_torque == pytest.approx(largest, rel=0.05)
    with pytest.raises(ParameterError, match=r"not usable .*any_status"):
        Compensator(model)
    everywhere = np.linspace(-1.0, 1.0, 2001)
    forced = Compensator(model, any_status=True, gain=1.0)
    assert max(abs(forced.torque(v, v)) for v in everywhere) <= LARGEST_EXTRAPOLATION * largest
    assert np.max(np.abs(result.network.torque(everywhere))) <= 1.01 * LARGEST_EXTRAPOLATION * largest
    assert choose_settings(model).gain == 0.5


def test_a_parameter_that_no_point_depends_on_is_unknown_not_exact() -> None:
    velocity, torque = _fast()
    result = identify(velocity, torque, method="least_squares", law="tanh")
    name = "smoothed_coulomb.smoothing_velocity"
    assert result.status is Status.NOT_IDENTIFIABLE
    assert name in result.message
    assert result.standard_deviations[name] == np.inf
    assert result.interval(name).upper == np.inf
    assert result.model.covariance is not None
    assert np.sqrt(np.diag(result.model.covariance.matrix))[1] == pytest.approx(UNDETERMINED * result.parameters[name])


def test_an_unknown_parameter_survives_the_model_file_and_shows_no_change(tmp_path: Path) -> None:
    files = []
    for seed in range(2):
        (tmp_path / str(seed)).mkdir()
        result = identify(*_fast(seed), method="least_squares", law="tanh")
        files.append(save_identification(result, tmp_path / str(seed)).model)
    assert "Infinity" not in files[0].read_text()
    json.loads(files[0].read_text())
    comparison = compare_models(load_model(files[0]), load_model(files[1]))
    change = next(c for c in comparison.changes if c.name.endswith("smoothing_velocity"))
    assert change.p_value == pytest.approx(1.0)


def test_parameters_that_only_act_together_are_all_unknown() -> None:
    rows = np.array([[1.0, 2.0, 0.0, 0.0], [1.0, 2.0, 1.0, 0.0]])  # the first two in step, the last without effect
    information = rows.T @ rows
    assert np.isinf(compute_log_deviations(information)).tolist() == [True, True, False, True]
    covariance = invert_information(information)
    deviations = np.sqrt(np.diag(covariance))
    assert np.all(deviations[[0, 1, 3]] >= 0.999 * UNDETERMINED)
    assert deviations[2] == pytest.approx(np.sqrt(2.0), rel=1e-3)
    assert rows[0] @ covariance @ rows[0] == pytest.approx(1.0, rel=0.01)  # what is measured stays known


def test_information_without_null_directions_is_inverted() -> None:
    rows = np.random.default_rng(0).normal(size=(30, 5)) * 10.0 ** np.arange(-4.0, 1.0)
    np.testing.assert_allclose(invert_information(rows.T @ rows), np.linalg.inv(rows.T @ rows), rtol=1e-8)


def test_a_plan_says_what_it_cannot_determine() -> None:
    travel = Travel(-2.0, 2.0, 8.0, quantum=2.4e-5)
    plan = plan_plateaus([0.03, 0.1], travel, SweepSettings(repeats=1))
    deviations = expected_deviations(plan, assume_friction(0.1, 10.0, 1000.0))
    assert deviations["stribeck.forward.static_torque"] == np.inf
    assert deviations["stribeck.reverse.stribeck_velocity"] == np.inf
    curve = StribeckCurve(0.15, 0.6, 0.05, 0.02)
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve),)))
    assert expected_deviation(model, np.array([-0.1, -0.03, 0.03, 0.1])) == np.inf


@pytest.mark.parametrize(("step", "status"), [(0.006, Status.CONVERGED), (0.2, Status.NOT_CONVERGED)])
def test_convergence_is_judged_by_the_distance_to_the_optimum(step: float, status: Status) -> None:
    draw = noisy("absolute", 0)
    points, form, noise = observe(draw.velocity, draw.torque), separable_law("stribeck"), Noise("absolute")
    best = fit_likelihood(form, points, noise)
    covariance = covariance_of(best)
    away = step * np.sqrt(covariance[0, 0]) / np.exp(best.logs[0])
    found = optimum_at(best.logs + away * np.eye(8)[0], form, points, noise)
    assert judge(found, best, covariance, form, points).status is status


def test_parameters_of_a_less_likely_basin_are_not_usable() -> None:
    draw = noisy("absolute", 0)
    points, form, noise = observe(draw.velocity, draw.torque), separable_law("stribeck"), Noise("absolute")
    best = fit_likelihood(form, points, noise)
    found = optimum_at(best.logs + 0.3, form, points, noise)
    verdict = judge(found, best, covariance_of(best), form, points)
    assert "another basin is more likely" in verdict.message
    assert find_doubt_in_status(verdict.status, verdict.message) is not None


def test_a_viscous_coefficient_near_zero_makes_no_model_unusable() -> None:
    velocity = np.concatenate([-np.geomspace(0.005, 1.0, 60), np.geomspace(0.005, 1.0, 60)])
    curve = StribeckCurve(0.2, 0.4, 0.05, 1e-5)
    torque = np.asarray(FrictionLaw((BidirectionalStribeck(curve, curve),)).torque(velocity))
    torque = torque + np.random.default_rng(0).normal(0.0, 0.003, velocity.size)
    assert identify(velocity, torque, method="least_squares").status is Status.CONVERGED


@pytest.mark.parametrize("sensitivity", [0.0, 0.01, 1.0])
def test_friction_that_does_not_depend_on_the_load_is_identified(sensitivity: float) -> None:
    speed, load = np.repeat(np.geomspace(0.005, 1.0, 15), 4), np.tile([5.0, 10.0, 15.0, 20.0], 15)
    magnitude = (0.15 + 0.45 * np.exp(-((speed / 0.05) ** 2))) * (
        1.0 + sensitivity * (load / 12.5 - 1.0)
    ) + 0.02 * speed
    noise = 1.0 + 0.02 * np.random.default_rng(3).standard_normal((2, speed.size))
    velocity, torque = np.concatenate([speed, -speed]), np.concatenate([magnitude, -magnitude]) * noise.ravel()
    found = identify(velocity, torque, np.concatenate([load, load]), method="least_squares")
    assert found.status is Status.CONVERGED, found.message
    assert found.parameters.get("stribeck.load.load_sensitivity", 1.0) == pytest.approx(sensitivity, abs=0.03)


@pytest.mark.parametrize(
    ("torque", "words"), [(0.0, "all torques are zero"), (1e-200, "all torques are zero"), (1e160, "no measured value")]
)
def test_a_torque_that_is_none_is_refused(torque: float, words: str) -> None:
    velocity = np.concatenate([np.linspace(0.1, 1.0, 20), -np.linspace(0.1, 1.0, 20)])
    with pytest.raises(IdentificationError, match=words):
        identify(velocity, np.sign(velocity) * torque)

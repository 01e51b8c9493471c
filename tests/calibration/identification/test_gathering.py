"""Tables of many points: gathered into few rows that say the same about the law."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.calibration import identify
from fricomp.calibration.identification import Status
from fricomp.calibration.identification.discrepancy import fit_discrepancy
from fricomp.calibration.identification.estimation.form import separable_law
from fricomp.calibration.identification.estimation.gathering import gather_points
from fricomp.calibration.identification.estimation.likelihood import Noise
from fricomp.calibration.identification.estimation.observation import Observations, observe
from fricomp.calibration.identification.estimation.optimum import fit_likelihood
from fricomp.laws import FloatArray

_TRUTH = np.array([0.8, 1.2, 0.05, 0.3, 0.7, 1.0, 0.07, 0.35])
_MANY = 12_000


def _compute_friction(speed: FloatArray, at: FloatArray) -> FloatArray:
    return np.asarray(at[0] + (at[1] - at[0]) * np.exp(-((speed / at[2]) ** 2)) + at[3] * speed)


def _draw(count: int, *, relative: float = 0.01, absolute: float = 0.0) -> tuple[FloatArray, FloatArray]:
    random = np.random.default_rng(7)
    velocity = np.exp(random.uniform(np.log(0.003), np.log(3.0), count)) * random.choice([-1.0, 1.0], count)
    speed = np.abs(velocity)
    magnitude = np.where(velocity > 0.0, _compute_friction(speed, _TRUTH[:4]), _compute_friction(speed, _TRUTH[4:]))
    magnitude *= 1.0 + relative * random.standard_normal(count)
    return velocity, np.sign(velocity) * (magnitude + absolute * random.standard_normal(count))


@pytest.mark.parametrize("noise", [Noise("relative"), Noise("absolute"), Noise("given", np.full(_MANY, 0.02))])
def test_gathered_rows_have_the_optimum_and_the_covariance_of_all_points(noise: Noise) -> None:
    points, form = observe(*_draw(_MANY)), separable_law("stribeck")
    whole = fit_likelihood(form, points, noise)
    rows = gather_points(points, lambda some: form.evaluate(whole.logs, some)[0])
    found = fit_likelihood(form, rows, noise.counting(rows))
    exact = whole.noise.information(whole.whitened, whole.magnitude, whole.jacobian)
    gathered = found.noise.information(found.whitened, found.magnitude, found.jacobian)
    assert rows.size < points.size / 3
    assert rows.total == points.size
    shift = found.logs - whole.logs
    assert np.sqrt(shift @ exact @ shift) < 0.05  # standard deviations, over all parameters
    np.testing.assert_allclose(np.diag(np.linalg.inv(gathered)), np.diag(np.linalg.inv(exact)), rtol=0.02)


def test_rows_keep_mean_and_scatter_of_each_cell() -> None:
    points = observe(*_draw(_MANY))
    rows = gather_points(points)
    assert rows.count is not None
    assert np.average(rows.magnitude, weights=rows.count) == pytest.approx(np.mean(points.magnitude), rel=1e-12)
    square = np.average(rows.magnitude**2, weights=rows.count)
    assert square == pytest.approx(float(np.mean(points.magnitude**2)), rel=1e-12)


def test_a_table_of_many_points_converges_at_the_truth() -> None:
    found = identify(*_draw(100_000))
    assert found.status is Status.CONVERGED
    assert found.observations.size == 100_000
    off = (np.array(list(found.parameters.values())) - _TRUTH) / np.array(list(found.standard_deviations.values()))
    assert np.max(np.abs(off)) < 4.0
    assert found.noise.kind == "relative"
    assert found.noise.level == pytest.approx(0.01, rel=0.01)


def test_points_behind_many_rows_are_still_at_hand() -> None:
    found = identify(*_draw(_MANY), method="least_squares")
    assert found.rows.size < found.observations.size
    assert found.at_points.magnitude.shape == (_MANY,)
    left = found.observations.magnitude / found.at_points.magnitude - 1.0
    assert np.std(left) == pytest.approx(0.01, rel=0.05)


def test_a_misfit_of_many_points_is_seen() -> None:
    velocity, torque = _draw(_MANY)
    torque = torque + np.sign(velocity) * 0.01 * np.sin(3.0 * np.log(np.abs(velocity)))
    assert identify(velocity, torque, method="least_squares").status is Status.LACK_OF_FIT


def test_loads_are_gathered_apart() -> None:
    velocity, torque = _draw(40_000)
    load = np.random.default_rng(3).uniform(5.0, 15.0, velocity.size)
    points = observe(velocity, torque * load / 10.0, load)
    rows = gather_points(points)
    assert rows.normal_load is not None
    assert rows.size < points.size / 3
    assert np.ptp(rows.normal_load) > 8.0


@pytest.mark.slow
def test_a_network_departs_from_means_of_many_points() -> None:
    velocity, torque = _draw(_MANY)
    torque = torque + np.sign(velocity) * 0.2 * np.exp(-(((np.abs(velocity) - 1.0) / 0.3) ** 2))
    free = fit_discrepancy(identify(velocity, torque, method="least_squares"))
    assert free.departs
    assert free.held_out[free.weight] < 1.3


def test_few_points_are_rows_of_their_own() -> None:
    points: Observations = observe(*_draw(500))
    assert gather_points(points) is points

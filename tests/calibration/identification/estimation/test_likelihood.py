"""The likelihood of friction points, against densities of scipy and differences of the likelihood itself."""

import numpy as np
import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import norm

from fricomp.calibration.identification.estimation.likelihood import Noise, NoiseKind, parse_noise
from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

SPEED = np.geomspace(0.05, 1.0, 30)
LOG_PARAMETERS = np.log([0.3, 0.2])
DEVIATION = 0.01 + 0.02 * SPEED
NOISES = (Noise("absolute"), Noise("relative"), Noise("given", DEVIATION))


def _magnitude(log_parameters: FloatArray) -> FloatArray:
    coulomb, viscous = np.exp(log_parameters)
    return np.asarray(coulomb + viscous * SPEED)


def _jacobian(log_parameters: FloatArray) -> FloatArray:
    coulomb, viscous = np.exp(log_parameters)
    return np.column_stack([np.full_like(SPEED, coulomb), viscous * SPEED])


def _deviation(kind: NoiseKind) -> FloatArray:
    """Of each point, where the noise is of this kind [N·m]."""
    if kind == "given":
        return DEVIATION
    return 0.05 * _magnitude(LOG_PARAMETERS) if kind == "relative" else np.full_like(SPEED, 0.02)


def _observed(kind: NoiseKind) -> FloatArray:
    magnitude, rng = _magnitude(LOG_PARAMETERS), np.random.default_rng(3)
    return np.asarray(magnitude + _deviation(kind) * rng.normal(size=SPEED.size))


def _likelihood(noise: Noise, log_parameters: FloatArray) -> float:
    magnitude = _magnitude(log_parameters)
    residual = noise.whiten(_observed(noise.kind), magnitude, _jacobian(log_parameters)).residual
    return noise.negative_log_likelihood(residual, 1.0)


@pytest.mark.parametrize("noise", NOISES, ids=lambda noise: noise.kind)
def test_it_is_the_density_of_the_points_at_the_best_level(noise: Noise) -> None:
    observed, magnitude = _observed(noise.kind), _magnitude(LOG_PARAMETERS)
    if noise.deviation is not None:
        expected = -float(np.sum(norm.logpdf(observed, magnitude, noise.deviation)))
    else:
        shape = magnitude if noise.kind == "relative" else np.ones_like(magnitude)
        best = minimize_scalar(
            lambda level: -float(np.sum(norm.logpdf(observed, magnitude, np.exp(level) * shape))),
            bounds=(-8.0, 0.0), method="bounded", options={"xatol": 1e-9},
        )  # fmt: skip
        expected = float(best.fun)
    assert _likelihood(noise, LOG_PARAMETERS) == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("noise", NOISES, ids=lambda noise: noise.kind)
def test_the_jacobian_is_the_slope_of_the_residuals(noise: Noise) -> None:
    observed, step = _observed(noise.kind), 1e-6
    found = noise.whiten(observed, _magnitude(LOG_PARAMETERS), _jacobian(LOG_PARAMETERS))
    for column in range(2):
        change = step * np.eye(2)[column]
        ends = [
            noise.whiten(observed, _magnitude(at), _jacobian(at)).residual
            for at in (LOG_PARAMETERS + change, LOG_PARAMETERS - change)
        ]
        np.testing.assert_allclose(found.jacobian[:, column], (ends[0] - ends[1]) / (2.0 * step), atol=1e-8)
    np.testing.assert_allclose(found.residual, found.weight * (observed - _magnitude(LOG_PARAMETERS)))


@pytest.mark.parametrize("noise", NOISES, ids=lambda noise: noise.kind)
def test_the_information_is_that_of_fits_to_many_draws(noise: Noise) -> None:
    magnitude, jacobian, rng = _magnitude(LOG_PARAMETERS), _jacobian(LOG_PARAMETERS), np.random.default_rng(5)
    shape = _deviation(noise.kind)
    found = []
    for _ in range(400):
        observed, at = magnitude + shape * rng.normal(size=SPEED.size), LOG_PARAMETERS
        for _ in range(4):  # Gauss-Newton from the truth
            whitened = noise.whiten(observed, _magnitude(at), _jacobian(at))
            at = at - np.linalg.lstsq(whitened.jacobian, whitened.residual)[0]
        found.append(at)
    whitened = noise.whiten(_observed(noise.kind), magnitude, jacobian)
    information = noise.information(whitened, magnitude, jacobian)
    spread = np.cov(np.array(found).T)
    np.testing.assert_allclose(np.sqrt(np.diag(np.linalg.inv(information))), np.sqrt(np.diag(spread)), rtol=0.3)


def test_relative_noise_tells_about_the_model_by_the_spread_of_the_points_too() -> None:
    magnitude, jacobian = _magnitude(LOG_PARAMETERS), _jacobian(LOG_PARAMETERS)
    whitened = Noise("relative").whiten(_observed("relative"), magnitude, jacobian)
    plain = whitened.weight[:, None] * jacobian
    by_level = plain.T @ plain / (whitened.residual @ whitened.residual / (SPEED.size - 2))
    ratio = jacobian / magnitude[:, None]
    spread = (SPEED.size - 1) * np.cov(ratio.T)
    np.testing.assert_allclose(Noise("relative").information(whitened, magnitude, jacobian), by_level + 2.0 * spread)


def test_the_variance_counts_the_parameters_and_is_one_where_it_was_given() -> None:
    residual = np.array([1.0, -2.0, 2.0, 0.0])
    assert Noise("absolute").variance(residual, 1) == 3.0
    assert Noise("relative").variance(residual, 4) == 9.0
    assert Noise("given", np.ones(4)).variance(residual, 1) == 1.0


def test_residuals_of_rounding_give_no_endless_likelihood() -> None:
    floor = Noise("absolute").negative_log_likelihood(np.zeros(10), 2.0)
    assert floor == pytest.approx(5.0 * (np.log(2.0 * np.pi * 4e-28) + 1.0))


def test_the_candidates_for_the_noise_are_what_was_asked_for() -> None:
    kept = np.array([0, 2])
    assert [each.kind for each in parse_noise("auto", kept, 3)] == ["relative", "absolute"]
    assert [each.kind for each in parse_noise("relative", kept, 3)] == ["relative"]
    assert [each.kind for each in parse_noise("absolute", kept, 3)] == ["absolute"]
    (given,) = parse_noise([0.1, 0.2, 0.3], kept, 3)
    np.testing.assert_array_equal(given.deviation, [0.1, 0.3])
    (single,) = parse_noise(0.5, kept, 3)
    np.testing.assert_array_equal(single.deviation, [0.5, 0.5])


@pytest.mark.parametrize("noise", ["pink", [0.1, 0.2], [0.1, 0.2, 0.0], [0.1, np.inf, 0.2], -1.0])
def test_noise_that_cannot_be_is_refused(noise: object) -> None:
    with pytest.raises(IdentificationError, match=r"unknown noise 'pink'|3 positive standard deviations"):
        parse_noise(noise, np.arange(3), 3)  # type: ignore[arg-type]

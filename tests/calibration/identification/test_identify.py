import numpy as np
import pytest

from fricomp.calibration import IdentificationOptions, identify
from fricomp.calibration.identification import Status
from fricomp.calibration.identification.estimation.start import starting_points
from fricomp.errors import IdentificationError
from fricomp.laws import BidirectionalStribeck, FrictionLaw, LoadScaling, StribeckCurve
from fricomp.sim_bench.studies.paper.oracle import find_optimum
from fricomp.sim_bench.studies.paper.study import contaminate, draw_random_start

from .paper import PROBLEM, TRUE, noisy, values_of


@pytest.mark.parametrize("seed", range(2))
def test_recovers_noise_free_parameters_from_random_starts(seed: int) -> None:
    draw = PROBLEM.draw("none", 0)
    result = identify(draw.velocity, draw.torque, noise="absolute", seed=seed, options=draw_random_start(seed))
    assert result.status is Status.CONVERGED
    assert result.traces is not None
    assert result.traces.start == "given"
    assert np.mean(PROBLEM.error_percent(values_of(result))) < 1e-3


@pytest.mark.parametrize("reading", ["relative", "absolute"])
def test_training_begins_away_from_the_optimum_that_it_reaches(reading: str) -> None:
    draw = noisy(reading, 7)
    result = identify(draw.velocity, draw.torque, noise=reading)
    assert result.traces is not None
    assert result.traces.start == "projection"
    points, noise = result.observations, result.optimum.noise
    start = np.exp(starting_points(result.form, points, noise, robust=False)[0])
    limit = PROBLEM.cramer_rao(draw.reading)
    assert np.max(np.abs(start - find_optimum(draw).values) / limit) > 1.0
    assert np.max(np.abs(values_of(result) - find_optimum(draw).values) / limit) < 0.02


def test_a_training_that_only_keeps_the_optimum_of_least_squares_says_so() -> None:
    # At these speeds nothing shows of the Stribeck effect, and training gets lost along what is left open.
    velocity = np.concatenate([-np.linspace(0.3, 1.0, 20), np.linspace(0.3, 1.0, 20)])
    noise = 0.01 * np.random.default_rng([0, 7]).normal(size=40)
    result = identify(velocity, np.asarray(PROBLEM.law.torque(velocity)) + noise, noise="absolute")
    assert result.status is Status.NOT_IDENTIFIABLE
    assert result.traces is not None
    assert result.traces.start == "least_squares"


@pytest.mark.parametrize("reading", ["relative", "absolute"])
@pytest.mark.parametrize("seed", [1, 2])
def test_pinn_ends_at_the_likelihood_optimum_of_an_independent_oracle(reading: str, seed: int) -> None:
    draw = noisy(reading, seed)
    result = identify(draw.velocity, draw.torque, noise=reading, seed=seed)
    best = find_optimum(draw)
    apart = np.abs(values_of(result) - best.values) / PROBLEM.cramer_rao(draw.reading)
    assert np.max(apart) < 0.02
    assert result.negative_log_likelihood < best.negative_log_likelihood + 1e-3


def test_cramer_rao_bound_is_the_one_of_the_paper_problem() -> None:
    for reading, forward, reverse in (("relative", 4.7, 4.5), ("absolute", 5.4, 3.8)):
        limit = 100.0 * PROBLEM.cramer_rao(reading) / TRUE * np.sqrt(2.0 / np.pi)  # type: ignore[arg-type]
        assert np.mean(limit[:4]) == pytest.approx(forward, abs=0.05)
        assert np.mean(limit[4:]) == pytest.approx(reverse, abs=0.06)


@pytest.mark.slow
@pytest.mark.parametrize("reading", ["relative", "absolute"])
def test_errors_and_intervals_are_those_of_the_cramer_rao_bound(reading: str) -> None:
    limit = PROBLEM.cramer_rao(reading)  # type: ignore[arg-type]
    errors, covered = [], []
    for seed in range(300):
        draw = noisy(reading, seed)
        result = identify(draw.velocity, draw.torque, method="least_squares", noise=reading)
        errors.append((values_of(result) - TRUE) / limit)
        intervals = [result.interval(name) for name in result.parameter_names]
        covered.append([i.lower <= t <= i.upper for i, t in zip(intervals, TRUE, strict=True)])
    ratio = np.sqrt(np.mean(np.square(errors), axis=0))
    assert np.all(np.abs(ratio - 1.0) < 4.0 / np.sqrt(2 * 300))
    assert np.all(np.abs(np.mean(covered, axis=0) - 0.95) < 4.0 * np.sqrt(0.95 * 0.05 / 300))


def test_a_start_in_the_wrong_basin_is_left() -> None:
    draw = noisy("relative", 3)
    names = PROBLEM.form.names
    start = dict(zip(names, [0.9, 0.1, 0.8, 0.001, 0.9, 0.1, 0.8, 0.001], strict=True))
    result = identify(draw.velocity, draw.torque, noise="relative", options=IdentificationOptions(start=start))
    assert result.status is Status.CONVERGED
    assert result.distance_to_optimum < 0.05


def test_noise_model_is_decided_by_likelihood() -> None:
    law = FrictionLaw((BidirectionalStribeck(StribeckCurve(0.1, 1.0, 0.2, 0.5), StribeckCurve(0.1, 1.0, 0.2, 0.5)),))
    velocity = np.linspace(-1.0, 1.0, 201)
    exact = np.asarray(law.torque(velocity))
    normal = np.random.default_rng(0).normal(size=201)
    assert identify(velocity, exact * (1.0 + 0.05 * normal), method="least_squares").noise.kind == "relative"
    assert identify(velocity, exact + 0.02 * normal, method="least_squares").noise.kind == "absolute"


def test_given_deviations_are_used_as_they_are() -> None:
    draw = noisy("absolute", 0)
    deviation = np.full(201, 0.02)
    once = identify(draw.velocity, draw.torque, method="least_squares", noise=deviation)
    twice = identify(draw.velocity, draw.torque, method="least_squares", noise=2.0 * deviation)
    np.testing.assert_allclose(4.0 * once.covariance, twice.covariance, rtol=1e-4)


def test_outliers_do_not_move_the_robust_fit() -> None:
    draw, clean = contaminate(noisy("relative", 4), PROBLEM)
    limit = PROBLEM.cramer_rao("relative", kept=clean[draw.velocity != 0.0].astype(np.float64))
    robust = identify(draw.velocity, draw.torque, method="least_squares", noise="relative", loss="robust")
    plain = identify(draw.velocity, draw.torque, method="least_squares", noise="relative")
    assert np.max(np.abs(values_of(robust) - TRUE) / limit) < 3.5
    assert np.max(np.abs(values_of(plain) - TRUE) / limit) > 3.5


def test_an_ambiguous_basin_is_not_returned_silently() -> None:
    # Two of the three slowest forward points of this draw are outliers on the same side.
    draw, _ = contaminate(noisy("absolute", 12), PROBLEM)
    result = identify(draw.velocity, draw.torque, method="least_squares", noise="absolute", loss="robust")
    assert result.status is Status.WRONG_BASIN_SUSPECTED
    assert "second basin" in result.message


@pytest.mark.parametrize("sensitivity", [1.0, 0.5])
def test_load_dependence_is_identified_from_several_loads(sensitivity: float) -> None:
    curves = StribeckCurve(*TRUE[:4]), StribeckCurve(*TRUE[4:])
    law = FrictionLaw((BidirectionalStribeck(*curves, LoadScaling(sensitivity, 10.0)),))
    velocity, load = np.tile(np.linspace(-1.0, 1.0, 81), 3), np.repeat([5.0, 10.0, 20.0], 81)
    torque = np.asarray(law.torque(velocity, normal_load=load))
    noise = 1.0 + 0.01 * np.random.default_rng(0).normal(size=len(torque))
    result = identify(velocity, torque * noise, load, "least_squares", "relative")
    check = np.asarray(law.torque(velocity, normal_load=2.0 * load))
    error = np.asarray(result.model.torque(velocity, normal_load=2.0 * load)) - check
    assert np.max(np.abs(error)) < 0.03 * np.max(np.abs(check))
    assert ("stribeck.load.load_sensitivity" in result.parameters) == (sensitivity != 1.0)


def test_data_that_cannot_tell_a_parameter_are_reported() -> None:
    velocity = np.concatenate([-np.linspace(0.5, 1.0, 20), np.linspace(0.5, 1.0, 20)])
    torque = np.sign(velocity) * (0.2 + 0.1 * np.abs(velocity))
    torque = torque * (1.0 + 0.02 * np.random.default_rng(0).normal(size=40))
    assert identify(velocity, torque).status is Status.NOT_IDENTIFIABLE


@pytest.mark.parametrize(
    ("velocity", "torque", "settings", "words"),
    [
        ([1.0, 2.0], [1.0], {}, "velocity has 2 values"),
        ([1.0, np.nan], [1.0, 1.0], {}, r"velocity\[1\] is nan"),
        ([0.0, 0.0], [1.0, 1.0], {}, "at rest"),
        ([1.0, -1.0], [-1.0, 1.0], {}, "sign of the velocity"),
        ([1.0, -1.0], [1.0, -1.0], {}, "4 parameters in forward direction"),
        ([1.0, -1.0], [1.0, -1.0], {"noise": "loud"}, "unknown noise"),
        ([1.0, -1.0], [1.0, -1.0], {"noise": [1.0]}, "2 positive standard deviations"),
        ([1.0, -1.0], [1.0, -1.0], {"law": "magic"}, "unknown static law"),
        ([1.0, -1.0], [1.0, -1.0], {"method": "guess"}, "unknown method"),
        ([1.0, -1.0], [1.0, -1.0], {"normal_load": [1.0, -1.0]}, "normal_load must be positive"),
        ([1.0, -1.0], [1.0, -1.0], {"law": "lugre"}, "identify_dynamic"),
    ],
)
def test_unusable_input_is_refused_with_a_reason(
    velocity: list[float], torque: list[float], settings: dict[str, object], words: str
) -> None:
    with pytest.raises(IdentificationError, match=words):
        identify(velocity, torque, **settings)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "law",
    [
        "coulomb",
        "coulomb_viscous",
        "asymmetric_coulomb_viscous",
        "tanh",
        "arctan",
        "symmetric_stribeck",
    ],
)
def test_every_static_law_recovers_itself(law: str) -> None:
    from fricomp.calibration.identification.estimation.form import separable_law

    form = separable_law(law)
    wanted = {name: 0.05 if name.endswith("_velocity") else 0.3 + 0.1 * k for k, name in enumerate(form.names)}
    velocity = np.linspace(-1.0, 1.0, 201)
    torque = np.asarray(form.law(wanted).torque(velocity))
    torque = torque * (1.0 + 0.01 * np.random.default_rng(0).normal(size=201))
    result = identify(velocity, torque, method="least_squares", law=law)
    for name, value in wanted.items():
        assert abs(result.parameters[name] - value) < 5.0 * result.standard_deviations[name]

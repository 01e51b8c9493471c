"""Points that do not follow the law, or do not show what it claims, are told from those that do."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.calibration.identification import IdentificationOptions, IdentificationResult, Status, identify
from fricomp.calibration.identification.report.page import parameter_rows
from fricomp.control.compensation.trust import find_doubt
from fricomp.laws import FloatArray
from fricomp.sim_bench.studies.paper.study import contaminate

from ..paper import PROBLEM, TRUE, noisy

PAPER = ((0.15, 0.6, 0.05, 0.02), (0.2, 0.7, 0.05, 0.03))
FLAT = ((0.3, 0.3, 0.05, 0.1),) * 2
LOGARITHMIC = np.geomspace(0.01, 1.0, 40)
UNIFORM = np.linspace(0.05, 1.0, 20)
Curves = tuple[tuple[float, ...], tuple[float, ...]]


def _points(
    seed: int,
    curves: Curves = PAPER,
    speed: FloatArray = LOGARITHMIC,
    *,
    noise: float = 0.01,
    relative: bool = False,
    exponent: float = 2.0,
) -> tuple[FloatArray, FloatArray]:
    """Velocity and torque: each speed in reverse and forward."""
    velocity = np.concatenate([-speed, speed])
    coulomb, static, bend, viscous = np.where(velocity > 0.0, *np.array(curves)[:, :, None])
    size = np.abs(velocity)
    magnitude = coulomb + (static - coulomb) * np.exp(-((size / bend) ** exponent)) + viscous * size
    error = noise * np.random.default_rng([seed, 7]).normal(size=len(velocity))
    return velocity, np.sign(velocity) * (magnitude * (1.0 + error) if relative else magnitude + error)


def _identify(points: tuple[FloatArray, FloatArray], law: str = "stribeck") -> IdentificationResult:
    return identify(*points, method="least_squares", law=law)


def _bent_at(bend: float) -> Curves:
    return tuple((coulomb, static, bend, viscous) for coulomb, static, _, viscous in PAPER)  # type: ignore[return-value]


@pytest.mark.parametrize("seed", range(3))
def test_points_of_another_stribeck_exponent_lack_fit_and_stay_usable(seed: int) -> None:
    result = _identify(_points(seed, exponent=1.0))
    assert result.status is Status.LACK_OF_FIT
    assert "intervals hold only where the law does" in result.message
    assert result.model.provenance.status == "lack_of_fit"
    assert find_doubt(result.model) is None


def test_a_hump_lacks_fit_unless_the_errors_may_be_shared() -> None:
    velocity, torque = _points(0)
    torque = torque + np.sign(velocity) * 0.15 * np.exp(-(((np.abs(velocity) - 0.45) / 0.12) ** 2))
    assert _identify((velocity, torque)).status is Status.LACK_OF_FIT
    shared = IdentificationOptions(independent=False)
    assert identify(velocity, torque, method="least_squares", options=shared).status is Status.CONVERGED


@pytest.mark.parametrize("relative", [False, True])
def test_points_of_the_law_raise_no_doubt(relative: bool) -> None:
    noise = 0.05 if relative else 0.01
    statuses = [_identify(_points(seed, noise=noise, relative=relative)).status for seed in range(20)]
    assert statuses == [Status.CONVERGED] * 20


@pytest.mark.slow
@pytest.mark.parametrize(("relative", "noise"), [(False, 0.01), (True, 0.05)])
def test_one_of_a_thousand_identifications_is_doubted_though_its_points_follow_the_law(
    relative: bool, noise: float
) -> None:
    speeds = (LOGARITHMIC, np.linspace(0.01, 1.0, 100), np.geomspace(0.01, 1.0, 8))
    draws = [
        _identify(_points(seed, speed=speed, noise=noise, relative=relative)) for speed in speeds for seed in range(200)
    ]
    assert sum(draw.status is Status.LACK_OF_FIT for draw in draws) <= 3


@pytest.mark.slow
@pytest.mark.parametrize(("speeds", "least", "most"), [(40, 60, 60), (20, 48, 60), (8, 0, 5)])
def test_another_stribeck_exponent_shows_in_many_speeds_and_not_in_few(speeds: int, least: int, most: int) -> None:
    speed = np.geomspace(0.01, 1.0, speeds)
    draws = [_identify(_points(seed, speed=speed, exponent=1.0)) for seed in range(60)]
    assert least <= sum(draw.status is Status.LACK_OF_FIT for draw in draws) <= most


@pytest.mark.parametrize("seed", range(6))
def test_a_joint_without_a_stribeck_effect_is_sent_to_a_law_without_one(seed: int) -> None:
    points = _points(seed, FLAT)
    result = _identify(points)
    assert result.status is Status.NOT_IDENTIFIABLE
    assert "no Stribeck effect shows" in result.message
    assert "coulomb_viscous" in result.message
    assert _identify(points, "coulomb_viscous").status is Status.CONVERGED


@pytest.mark.parametrize(
    ("curves", "speed", "seed", "words"),
    [(_bent_at(0.03), UNIFORM, k, "add speeds below 0.05") for k in range(8)]
    + [(_bent_at(3.0), LOGARITHMIC, k, "add speeds above 1|add speeds below 0.01") for k in range(4)],
)
def test_a_bend_outside_the_speeds_measured_is_not_determined(
    curves: Curves, speed: FloatArray, seed: int, words: str
) -> None:
    result = _identify(_points(seed, curves, speed))
    assert result.status is Status.NOT_IDENTIFIABLE
    assert any(word in result.message for word in words.split("|"))


def test_a_standard_deviation_below_the_value_does_not_hide_an_open_profile() -> None:
    result = _identify(_points(6, ((0.2, 0.9, 0.035, 0.05),) * 2, UNIFORM))
    name = "stribeck.forward.static_torque"
    assert result.standard_deviations[name] < result.parameters[name]
    assert result.status is Status.NOT_IDENTIFIABLE
    assert "they fit as well with a bend far from the speeds measured" in result.message
    row = next(row for row in parameter_rows(result) if row[0] == name)
    assert row[3].startswith("at least ")


@pytest.mark.parametrize("offset", [0.3, 0.4])
def test_an_offset_that_would_drive_the_joint_is_named(offset: float) -> None:
    velocity, torque = _points(0)
    result = _identify((velocity, torque + offset))
    assert result.status is Status.NOT_IDENTIFIABLE
    assert "in reverse has the sign that drives the joint: the torque holds an offset or gravity" in result.message


def test_asymmetry_is_the_offset_beside_friction_that_is_the_same_in_both_directions() -> None:
    velocity, torque = _points(0, (PAPER[0],) * 2)
    found = _identify((velocity, torque + 0.05)).observations.compute_asymmetry()
    assert found == pytest.approx(0.05, abs=0.005)
    assert _identify((np.abs(velocity), np.abs(torque)), "symmetric_stribeck").observations.compute_asymmetry() is None


@pytest.mark.slow
@pytest.mark.parametrize("slowest", [0.02, 0.03])
def test_intervals_hold_where_few_speeds_show_the_static_torque(slowest: float) -> None:
    covered = []
    for seed in range(300):
        result = _identify(_points(seed, speed=np.linspace(slowest, 1.0, 20)))
        if result.status is Status.CONVERGED:
            intervals = [result.interval(name) for name in result.parameter_names]
            covered.append([i.lower <= t <= i.upper for i, t in zip(intervals, np.ravel(PAPER), strict=True)])
    assert len(covered) > 200
    assert np.all(np.mean(np.array(covered, dtype=np.float64), axis=0) > 0.90)


@pytest.mark.slow
@pytest.mark.parametrize("reading", ["relative", "absolute"])
def test_intervals_of_the_robust_fit_hold_the_truth_a_little_less_often_than_they_say(reading: str) -> None:
    covered = []
    for seed in range(50):
        draw, _ = contaminate(noisy(reading, seed), PROBLEM)
        result = identify(draw.velocity, draw.torque, method="least_squares", noise=reading, loss="robust")
        if result.status is Status.CONVERGED:
            intervals = [result.interval(name) for name in result.parameter_names]
            covered.append([i.lower <= t <= i.upper for i, t in zip(intervals, TRUE, strict=True)])
    assert len(covered) > 40
    often = np.mean(np.array(covered, dtype=np.float64), axis=0)
    assert np.mean(often) > 0.92
    assert 0.8 < min(often) < 0.95

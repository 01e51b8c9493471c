"""Covariances of linear fits whose errors go together, against fits made again and against what was drawn."""

import numpy as np
import pytest

from fricomp.calibration.identification.estimation.correlated_fit import solve_correlated
from fricomp.laws import FloatArray

_REACH = 5


def _line(count: int) -> FloatArray:
    return np.stack([np.ones(count), np.linspace(-1.0, 1.0, count)], axis=1)


def test_independent_errors_have_the_deviations_of_least_squares() -> None:
    columns, target = _line(4000), np.random.default_rng(0).normal(size=4000)
    fit = solve_correlated(columns, target, np.arange(4000), _REACH)
    plain = np.sqrt(np.diag(np.linalg.inv(columns.T @ columns)))
    np.testing.assert_allclose(np.sqrt(np.diag(fit.covariance)), plain, rtol=0.15)
    best = np.linalg.lstsq(columns, target)[0]
    np.testing.assert_allclose(fit.solution, best)
    np.testing.assert_allclose(fit.error, target - columns @ best, atol=1e-12)
    assert fit.rank == 2


def test_no_deviation_is_below_that_of_fits_without_each_stroke() -> None:
    rng = np.random.default_rng(1)
    strokes = [np.arange(start, start + _REACH) for start in range(0, 400, 10)]  # each one is one block
    at = np.concatenate(strokes)
    columns = np.column_stack([_line(len(at)), np.where(np.arange(len(at)) < 2 * _REACH, 1.0, 0.02)])
    target = rng.normal(size=len(at)) + 3.0 * np.repeat(rng.normal(size=len(strokes)), _REACH)
    fit = solve_correlated(columns, target, at, _REACH)
    without = []
    for begin in range(0, len(at), _REACH):
        rows = np.r_[:begin, begin + _REACH : len(at)]
        without.append(np.linalg.lstsq(columns[rows], target[rows])[0])
    moved = np.array(without) - fit.solution
    jackknife = np.sqrt((1.0 - 1.0 / len(moved)) * np.sum(moved**2, axis=0))
    deviations = np.sqrt(np.diag(fit.covariance))
    assert np.all(deviations >= jackknife * (1.0 - 1e-9))
    assert deviations[2] == pytest.approx(jackknife[2])  # two strokes decide on it, so that little error is left there


def test_intervals_hold_where_one_stroke_has_most_of_the_say() -> None:
    rng, held, draws = np.random.default_rng(2), 0, 100
    strokes = np.repeat(np.arange(20), 10)
    at = strokes * 20 + np.tile(np.arange(10), 20)
    weight = np.where(strokes == 0, 1.0, 0.25)
    columns = np.stack([np.ones(200), weight * np.linspace(-1.0, 1.0, 200)], axis=1)
    for _ in range(draws):
        shared = rng.normal(size=20)[strokes]  # errors that go together within a stroke
        fit = solve_correlated(columns, shared + 0.1 * rng.normal(size=200), at, _REACH)
        held += int(abs(fit.solution[1]) < 1.96 * np.sqrt(fit.covariance[1, 1]))
    assert held >= 0.85 * draws


def test_a_column_that_adds_nothing_takes_no_part() -> None:
    columns = np.column_stack([_line(100), np.zeros(100), _line(100)[:, 1]])
    fit = solve_correlated(columns, 2.0 * columns[:, 1], np.arange(100), _REACH)
    assert fit.rank == 2
    assert np.all(np.isfinite(fit.covariance))
    np.testing.assert_allclose(columns @ fit.solution, 2.0 * columns[:, 1], atol=1e-12)

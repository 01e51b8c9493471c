"""Least squares for simulated residuals: known minima, priors that couple parameters, minimisations side by side."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.race import Entry, Race
from fricomp.diagnosis.joint.settings import JOINT
from fricomp.diagnosis.joint.solver import Box, descend, minimise, raise_diagonal, run_together, split_evaluation

_A = np.random.default_rng(3).standard_normal((20, 3)) @ np.diag([1.0, 4.0, 0.5])
_Y = np.random.default_rng(4).standard_normal(20)
_COUPLED = np.array([[30.0, -28.0, 0.0], [-28.0, 30.0, 0.0], [0.0, 0.0, 2.0]])
_CENTRE = np.array([0.5, -0.4, 0.2])


def _box(upper: float = 9.0, precision: FloatArray | None = None) -> Box:
    p = np.zeros((3, 3)) if precision is None else precision
    return Box(np.full(3, -9.0), np.full(3, upper), np.array([0.5, 0.1, 2.0]), _CENTRE, p, np.full(3, 100.0))


def _line(points: Sequence[FloatArray]) -> list[FloatArray]:
    return [_A @ point - _Y for point in points]


def _valley(points: Sequence[FloatArray]) -> list[FloatArray]:
    """Rosenbrock's, with its minimum at ones; the third parameter on its own."""
    return [np.array([10.0 * (p[1] - p[0] ** 2), 1.0 - p[0], p[2] - 1.0]) for p in points]


def test_a_prior_that_couples_parameters_is_met_in_closed_form() -> None:
    wanted = np.linalg.solve(_A.T @ _A + _COUPLED, _A.T @ _Y + _COUPLED @ _CENTRE)
    found = minimise(_line, np.zeros(3), _box(precision=_COUPLED), iterations=20)
    np.testing.assert_allclose(found.theta, wanted, atol=1e-4)
    away = wanted - _CENTRE
    left = _A @ wanted - _Y
    assert found.cost == pytest.approx(left @ left + away @ _COUPLED @ away, rel=1e-6)


def test_a_coupled_parameter_at_its_bound_pulls_the_others() -> None:
    free = np.linalg.solve(_A.T @ _A + _COUPLED, _A.T @ _Y + _COUPLED @ _CENTRE)
    box = _box(precision=_COUPLED)
    upper = box.upper.copy()
    upper[0] = free[0] - 0.3
    box = Box(box.lower, upper, box.scale, box.centre, box.precision, box.reach)
    H, g = _A.T @ _A + _COUPLED, _A.T @ _Y + _COUPLED @ _CENTRE
    rest = np.linalg.solve(H[1:, 1:], g[1:] - H[1:, 0] * upper[0])
    found = minimise(_line, np.full(3, -1.0), box, iterations=20)
    np.testing.assert_allclose(found.theta, [upper[0], *rest], atol=1e-4)


def test_minimisations_side_by_side_end_where_each_ends_alone() -> None:
    """The first needs few rounds, the second many: what has ended is asked for nothing more."""
    residuals, asked_of_first = (_line, _valley), []

    def evaluate(asked: list[list[FloatArray]]) -> list[list[FloatArray]]:
        asked_of_first.append(len(asked[0]))
        return [one(points) for one, points in zip(residuals, asked, strict=True)]

    start = np.array([-1.2, 1.0, 0.0])
    both = run_together([descend(start, _box(), iterations=40) for _ in residuals], evaluate)
    for one, found in zip(residuals, both, strict=True):
        alone = minimise(one, start, _box(), iterations=40)
        assert np.array_equal(found.theta, alone.theta)
        assert found.cost == alone.cost
    np.testing.assert_allclose(both[1].theta, 1.0, atol=1e-3)
    assert asked_of_first[0] == 4  # the start, and a step along each parameter
    assert asked_of_first[-1] == 0


def test_parts_of_a_step_follow_a_narrow_valley_round_its_bend() -> None:
    """Damped steps alone, whole ones of which leave the valley, stand at a cost of 0.4 after as many."""
    found = minimise(_valley, np.array([-1.2, 1.0, 0.0]), _box(), iterations=20)
    assert found.cost < 1e-6


def test_a_descent_ends_where_a_step_no_longer_gains_what_was_asked() -> None:
    counts = []
    for tolerance in (1e-2, 30.0):
        asked: list[int] = []

        def evaluate(points: Sequence[FloatArray], asked: list[int] = asked) -> list[FloatArray]:
            asked.append(len(points))
            return _valley(points)

        minimise(evaluate, np.array([-1.2, 1.0, 0.0]), _box(), iterations=40, tolerance=tolerance)
        counts.append(sum(asked))
    assert counts[1] < counts[0]


def test_columns_that_are_known_are_not_asked_for() -> None:
    descent = descend(np.zeros(3), _box(), jacobian=_A[:, :2])
    start, moved = next(descent)
    np.testing.assert_array_equal(np.flatnonzero(moved - start), [2])
    assert run_together([], lambda asked: []) == []


def test_a_step_to_where_nothing_simulates_is_not_taken() -> None:
    def evaluate(points: Sequence[FloatArray]) -> list[FloatArray]:
        return [_A @ p - _Y if p[1] < 0.3 else np.full(20, np.nan) for p in points]

    found = minimise(evaluate, np.array([0.0, 0.2, 0.0]), _box(), iterations=8)
    assert found.theta[1] < 0.3
    assert np.isfinite(found.cost)


def test_a_box_joined_to_another_keeps_both_priors_apart() -> None:
    first, second = _box(precision=_COUPLED), _box(upper=5.0, precision=np.eye(3))
    joined = first.join(second)
    np.testing.assert_array_equal(joined.upper, [9.0] * 3 + [5.0] * 3)
    np.testing.assert_array_equal(joined.precision[:3, :3], _COUPLED)
    np.testing.assert_array_equal(joined.precision[3:, 3:], np.eye(3))
    assert not joined.precision[:3, 3:].any()
    nothing = Box(*(np.zeros(0),) * 4, np.zeros((0, 0)), np.zeros(0))
    assert first.join(nothing).precision.shape == (3, 3)


def test_a_prior_is_measured_in_scales() -> None:
    away, box = np.array([1.0, 2.0, -1.0]), _box(precision=_COUPLED)
    move = away * box.scale
    assert away @ box.scaled_precision @ away == pytest.approx(move @ _COUPLED @ move)


def test_a_floor_raises_the_diagonal_alone() -> None:
    raised = raise_diagonal(np.array([[0.25, -0.25, 0.0], [-0.25, 0.25, 0.0], [0.0, 0.0, 0.0]]), 0.1)
    np.testing.assert_array_equal(raised, [[0.25, -0.25, 0.0], [-0.25, 0.25, 0.0], [0.0, 0.0, 0.1]])


def test_a_start_that_does_not_simulate_ends_its_own_descent_only() -> None:
    def evaluate(asked: list[list[FloatArray]]) -> list[list[FloatArray]]:
        return [[np.full(20, np.nan) for _ in asked[0]], _line(asked[1])]

    lost, found = run_together([descend(np.zeros(3), _box(), jacobian=_A), descend(np.zeros(3), _box())], evaluate)
    assert not np.isfinite(lost.cost)
    np.testing.assert_allclose(found.theta, np.linalg.lstsq(_A, _Y, rcond=None)[0], atol=1e-4)


def test_a_descent_that_cannot_win_ends_without_a_step() -> None:
    asked: list[int] = []

    def evaluate(points: Sequence[FloatArray]) -> list[FloatArray]:
        asked.append(len(points))
        return [np.concatenate([_line([point])[0], np.full(5, 10.0)]) for point in points]

    race = Race(start=600.0, lead=1.0, at_once=True)
    descent = descend(np.zeros(3), _box(), entry=Entry(race))
    (lost,) = run_together([descent], split_evaluation(evaluate))
    assert asked == [4]  # its own residual and three derivatives
    assert lost.cost > 500.0


def test_the_leader_of_a_race_runs_to_its_end() -> None:
    alone = minimise(_valley, np.array([-1.2, 1.0, 0.0]), _box(), iterations=20)
    race = Race(start=1e3)
    (found,) = run_together(
        [descend(np.array([-1.2, 1.0, 0.0]), _box(), iterations=20, entry=Entry(race))], split_evaluation(_valley)
    )
    np.testing.assert_array_equal(found.theta, alone.theta)


def test_a_rival_that_settles_behind_the_leader_needs_no_last_digits() -> None:
    start, lead = np.array([-1.2, 1.0, 0.0]), -1e3
    counts = []
    for hurried in (False, True):
        counted = _Counted(_valley)
        entry = Entry(Race(1e6, lead), hurried=hurried)
        (fit,) = run_together([descend(start, _box(), iterations=20, entry=entry)], split_evaluation(counted))
        counts.append((counted.points, fit.cost))
    (exact, least), (quick, near) = counts
    assert quick < exact
    assert least <= near < least + JOINT.catching_up * (near - lead)


class _Counted:
    """Residuals, and at how many points they were asked for."""

    def __init__(self, residuals: Callable[[Sequence[FloatArray]], list[FloatArray]]) -> None:
        self.residuals, self.points = residuals, 0

    def __call__(self, points: Sequence[FloatArray]) -> list[FloatArray]:
        self.points += len(points)
        return self.residuals(points)

"""What counts as evidence: rows in which the joint slides, a little from each, and on held-out data."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from scipy.linalg import solve_toeplitz
from scipy.ndimage import binary_dilation
from scipy.optimize import lsq_linear
from scipy.signal import lfilter

from fricomp.diagnosis.effects.structure import N_BASE, Structure, _compute_contributions
from fricomp.diagnosis.evidence.alias import list_aliases
from fricomp.diagnosis.evidence.confirmation import Confirmation, _predict_held_out, _split_folds, compute_covariance
from fricomp.diagnosis.evidence.foretelling import _foretells
from fricomp.diagnosis.evidence.gates import covers, is_confirmed, measure_left, stands_out
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.diagnosis.joint.base import BASE_NAMES
from fricomp.diagnosis.joint.observer import Contribution, Observer
from fricomp.diagnosis.joint.problem import Problem, build_problem
from fricomp.diagnosis.joint.settings import JOINT
from fricomp.diagnosis.joint.solver import Box, Fit
from fricomp.diagnosis.record.sentence import describe_trace
from fricomp.diagnosis.search.explanation import Explanation, _compute_left, compute_evidence
from fricomp.diagnosis.search.preparation import (
    Baseline,
    _build_colour_filter,
    _compute_typical,
    _correlate,
    _predict_stably,
)

from .known import PLANT, fit_of, known, known_baseline, known_search, to_and_fro


@pytest.fixture(scope="module")
def baseline() -> Baseline:
    return known_baseline()


def test_rows_whose_window_touches_rest_do_not_slide(baseline: Baseline) -> None:
    time = baseline.problem.grids[0].centres * 1e-3
    at_rest = (time > 4.05) & (time < 5.95)
    assert not baseline.sliding[at_rest].any()
    assert baseline.sliding[(time > 2.1) & (time < 2.9)].all()
    assert not baseline.sliding[np.abs(time - 3.0) < 0.01].any()  # it turns there


def test_a_joint_that_hardly_ever_slides_has_all_rows(baseline: Baseline) -> None:
    track = baseline.problem.tracks[0]
    still = replace(track, velocity=np.zeros(track.size))
    resting = replace(baseline, problem=replace(baseline.problem, tracks=(still,)))
    assert resting.sliding.all()


def test_rest_speaks_only_for_effects_that_show_there(baseline: Baseline) -> None:
    sliding = baseline.sliding
    before, after = np.full(sliding.size, 0.7), np.full(sliding.size, 0.7)
    after[~sliding] = 0.0
    fall = 0.49 * np.sum(~sliding)
    assert compute_evidence(baseline, ("frictional_lag",), fit_of(before), fit_of(after)) == 0.0
    assert compute_evidence(baseline, ("backlash",), fit_of(before), fit_of(after)) == pytest.approx(fall)
    assert compute_evidence(baseline, ("backlash", "frictional_lag"), fit_of(before), fit_of(after)) == pytest.approx(
        fall
    )


def test_a_fall_about_rest_that_no_bristle_reaches_speaks_for_any_effect(baseline: Baseline) -> None:
    loud = np.where(baseline.sliding, 1.0, 2.0)
    shown = compute_evidence(baseline, ("load_coulomb",), fit_of(loud), fit_of(np.ones(loud.size)))
    assert shown == pytest.approx(3.0 * np.sum(~baseline.sliding))


def test_no_row_counts_for_more_than_three_deviations(baseline: Baseline) -> None:
    before = np.zeros(baseline.sliding.size)
    first, second = np.flatnonzero(baseline.sliding)[:2]
    before[first] = 100.0
    assert compute_evidence(baseline, ("cogging",), fit_of(before), fit_of(0.0 * before)) == pytest.approx(9.0)
    before[second] = 2.0
    assert compute_evidence(baseline, ("cogging",), fit_of(before), fit_of(0.0 * before)) == pytest.approx(13.0)


@dataclass(frozen=True)
class _Line(Structure):
    """A structure whose residual is `bend` of a line in its parameters."""

    table: FloatArray = field(default_factory=lambda: np.zeros((0, 0)))
    torque: FloatArray = field(default_factory=lambda: np.zeros(0))
    bend: float = 0.0

    def compute_residuals(self, problem: Problem, points: Sequence[FloatArray]) -> list[FloatArray]:
        return [self.table @ p - self.torque + self.bend * np.abs(p).sum() for p in points]


def _predict(line: _Line, theta: FloatArray) -> FloatArray:
    size = theta.size
    box = Box(-np.full(size, 9.0), np.full(size, 9.0), np.ones(size), np.zeros(size), np.eye(size), np.ones(size))
    fit = Fit(theta, np.zeros(0), line.table, 0.0)
    return _predict_held_out(replace(known_baseline(), box=box), line, fit, _split_folds([line.torque.size]))


def test_a_line_leaves_what_a_fit_to_the_other_blocks_leaves() -> None:
    rng = np.random.default_rng(0)
    table, torque = 3.0 * rng.standard_normal((600, 3)), rng.standard_normal(600)
    theta = np.asarray(np.linalg.lstsq(table, torque, rcond=None)[0], dtype=np.float64)
    found = _predict(_Line((), (), table, torque), theta)
    for train, test in _split_folds([600]):
        fitted = np.linalg.lstsq(table[train], torque[train], rcond=None)[0]
        np.testing.assert_allclose(found[test], table[test] @ fitted - torque[test], atol=1e-3)


def test_numbers_that_trade_against_each_other_are_refitted_within_their_bounds() -> None:
    rng = np.random.default_rng(4)
    one, two, three = rng.standard_normal((3, 600))
    table, torque = 3.0 * np.column_stack([one, one + 0.004 * two, three]), rng.standard_normal(600)
    theta = np.asarray(np.linalg.lstsq(table, torque, rcond=None)[0], dtype=np.float64)
    assert np.all(np.abs(theta) < 8.0)
    found = _predict(_Line((), (), table, torque), theta)
    for train, test in _split_folds([600]):
        left = np.append(torque[train] - table[train] @ theta, np.zeros(3))  # the prior is one about the joint minimum
        step = lsq_linear(np.vstack([table[train], np.eye(3)]), left, (-1.0, 1.0)).x
        assert np.sum((left[:-3] - table[train] @ step) ** 2) < np.sum(left**2)
        np.testing.assert_allclose(found[test], table[test] @ (theta + step) - torque[test], atol=1e-3)


@pytest.mark.parametrize("everywhere", [True, False])
def test_a_ripple_at_some_angles_only_foretells_nothing(everywhere: bool) -> None:
    rng = np.random.default_rng(5)
    angle = rng.uniform(0.0, 1.0, 1200)
    wave = np.column_stack([np.sin(60.0 * angle), np.cos(60.0 * angle)])
    base = np.column_stack([np.ones_like(angle), angle, np.zeros((angle.size, N_BASE - 2))])
    there = np.ones_like(angle) if everywhere else np.abs(angle - 0.62) < 0.04
    torque = 0.5 * there * wave[:, 0] + rng.standard_normal(angle.size)
    jacobian = np.column_stack([base, wave])
    theta = np.asarray(np.linalg.lstsq(jacobian, torque, rcond=None)[0], dtype=np.float64)
    bounds = (-np.full(N_BASE + 2, 9.0), np.full(N_BASE + 2, 9.0))
    boxes = [
        Box(bounds[0][one], bounds[1][one], np.ones(n), np.zeros(n), np.zeros((n, n)), np.ones(n))
        for one, n in ((slice(N_BASE), N_BASE), (slice(N_BASE, None), 2))
    ]
    structure = SimpleNamespace(
        parameters=[("cogging", None)] * 2,
        build_box=lambda: boxes[1],
        compute_added=lambda _, at, __: wave @ at[N_BASE:],
    )
    fit = Fit(theta, jacobian @ theta - torque, jacobian, 0.0)
    chosen = cast(Explanation, SimpleNamespace(structure=structure, fit=fit, box=boxes[0]))
    band = np.argsort(np.argsort(angle)) * 6 // angle.size
    assert _foretells(known_baseline(), chosen, "cogging", band) == everywhere


@pytest.mark.parametrize(("rows", "blocks"), [(300, 1), (600, 1), (800, 2), (1209, 3), (4959, 6)])
def test_folds_hold_several_blocks_and_a_gap_about_each(rows: int, blocks: int) -> None:
    folds = _split_folds([rows])
    assert len(folds) == 6
    np.testing.assert_array_equal(sum(test.astype(int) for _, test in folds), np.ones(rows))
    for train, test in folds:
        assert np.sum(np.diff(np.concatenate([[0], test.astype(int), [0]])) == 1) == blocks
        near = binary_dilation(test, iterations=15)
        np.testing.assert_array_equal(train, np.logical_not(near))


def _covered(noise: FloatArray) -> float:
    """Part of the 95 % intervals of a line's parameters, fitted to each row of `noise`, that hold the truth."""
    time = np.linspace(0.0, 1.0, noise.shape[1])
    table = np.column_stack([np.ones_like(time), time, np.sin(40.0 * time)])
    box = Box(-np.full(3, 9.0), np.full(3, 9.0), np.ones(3), np.zeros(3), np.zeros((3, 3)), np.ones(3))
    held = []
    for one in noise:
        theta = np.asarray(np.linalg.lstsq(table, one, rcond=None)[0], dtype=np.float64)
        residual = table @ theta - one
        deviation = np.sqrt(np.diag(compute_covariance(Fit(theta, residual, table, float(residual @ residual)), box)))
        held.append(np.abs(theta) < 1.96 * deviation)
    return float(np.mean(held))


@pytest.mark.slow
def test_intervals_hold_the_truth_in_white_noise_and_in_what_leans_for_a_while() -> None:
    white = np.random.default_rng(5).standard_normal((300, 2500))
    assert 0.93 < _covered(white) < 0.99
    # Without the sums over blocks two thirds of them would not.
    leaning = lfilter([np.sqrt(1.0 - 0.9**2)], [1.0, -0.9], white, axis=1)
    assert 0.85 < _covered(leaning) < 0.99


def test_a_step_by_which_its_own_rows_lose_is_not_taken() -> None:
    rng = np.random.default_rng(1)
    table, torque = rng.standard_normal((600, 2)), rng.standard_normal(600)
    bent = _Line((), (), table, torque, bend=50.0)
    np.testing.assert_array_equal(_predict(bent, np.zeros(2)), -torque)


def test_three_recordings_are_left_out_whole() -> None:
    folds = _split_folds([50, 70, 60])
    assert [int(np.sum(test)) for _, test in folds] == [50, 70, 60]
    assert all(np.array_equal(train, np.logical_not(test)) for train, test in folds)


@pytest.mark.parametrize(
    ("low", "explained", "certain", "after", "loudness", "sure"),
    [
        (0.01, 0.1, 40.0, 0.9, 1.3, True),
        (0.01, 0.6, 400.0, 0.98, 1.3, False),  # most is left, and loud
        (0.01, 0.6, 400.0, 0.98, 1.0, True),  # only where the block that shows most did not help to fit
        (0.01, 0.75, 40.0, 0.98, 1.3, True),
        (-0.01, 0.8, 200.0, 0.9, 1.3, True),  # in few blocks, and strong there
        (-0.01, 0.8, 60.0, 0.9, 1.0, False),
        (-0.01, 0.6, 200.0, 0.9, 1.3, False),
        (-0.01, 0.6, 600.0, 0.9, 1.3, True),  # half of it, and overwhelming where it shows
        (-0.01, 0.8, 200.0, 1.1, 1.3, False),
    ],
)
def test_a_fall_is_sure_over_blocks_or_by_its_size(
    low: float, explained: float, certain: float, after: float, loudness: float, sure: bool
) -> None:
    held = Confirmation(1.0, after, 0.78, (low, 0.5), explained)
    assert is_confirmed(held, known(("backlash",), 500.0, certain=certain), 50.0, loudness) == sure


def test_samples_are_cut_finely_where_a_bristle_may_be_stretched() -> None:
    problem = build_problem([to_and_fro()], PLANT, Observer())
    stiff, soft = (problem.cut_samples_for(replace(PLANT, sigma_0=one)).tracks[0].substeps for one in (4e5, 1e4))
    assert stiff.min() == soft.min() >= 2
    assert stiff.max() > soft.max() > 2
    assert np.all(stiff >= soft)
    time = np.arange(stiff.size) * 1e-3
    assert np.all(stiff[(time > 3.99) & (time < 6.01)] == stiff.max())  # at rest, and 10 ms about it
    assert np.all(stiff[np.abs(time - 2.0) < 0.01] == stiff.max())  # where it turns
    assert np.all(stiff[(time > 2.1) & (time < 2.9)] == stiff.min())
    for cut, sigma_0, longest in ((soft, 1e4, problem.observer.step), (stiff, 4e5, JOINT.stable_substep)):
        assert 1e-3 / cut.max() * np.sqrt((3.0 * sigma_0 + problem.gains[0]) / PLANT.inertia) <= longest
    assert 1e-3 / stiff.max() >= problem.observer.row_width / JOINT.row_substeps  # rows show no more
    np.testing.assert_array_equal(problem.tracks[0].substeps, problem.cut_samples_for(PLANT).tracks[0].substeps)


def test_what_lies_mostly_about_rest_speaks_for_no_effect_of_sliding(baseline: Baseline) -> None:
    """Both bring 20 where the joint slides; the second far more about rest, as a bent bristle would."""
    rows = baseline.sliding
    none = fit_of(np.zeros(rows.size))
    some = np.where(rows, 20.0 / rows.sum(), 0.0)
    rest = some + np.where(rows, 0.0, 0.58)
    assert compute_evidence(baseline, {"frictional_lag"}, fit_of(np.sqrt(some)), none) == pytest.approx(20.0)
    assert compute_evidence(baseline, {"frictional_lag"}, fit_of(np.sqrt(rest)), none) == 0.0


@pytest.mark.parametrize("memory", [0.6, -0.4])
@pytest.mark.parametrize("wanted", [(0.0, 0.0, 0.0), (-0.2, -0.15, -0.1)])
def test_a_residual_of_another_colour_gets_that_of_the_nulls(memory: float, wanted: tuple[float, ...]) -> None:
    values = lfilter([1.0], [1.0, -memory], np.random.default_rng(3).standard_normal(4000))
    found = _build_colour_filter(values, np.array(wanted))
    filtered = lfilter(found, [1.0], values)
    np.testing.assert_allclose(_correlate(filtered), wanted, atol=0.12)
    assert _compute_typical(filtered) == pytest.approx(_compute_typical(values))
    np.testing.assert_array_equal(_build_colour_filter(values, _correlate(values)), [1.0])


@pytest.mark.parametrize("shift", [(0.3, 0.1, 0.0), (0.9, -0.6, 0.95), (-0.99, 0.99, -0.99)])
def test_the_residuals_own_colour_never_makes_a_filter_that_grows(shift: tuple[float, float, float]) -> None:
    extra = _predict_stably(np.array(shift))
    assert np.max(np.abs(np.roots([1.0, *-extra]))) < 1.0
    if shift[0] == 0.3:
        np.testing.assert_array_equal(extra, solve_toeplitz([1.0, *shift[:-1]], shift))


@pytest.mark.parametrize(("left", "null", "printed"), [(0.0, 0.0, False), (0.0, 25.0, True), (25.0, 0.0, True)])
def test_a_set_is_as_wide_as_what_the_best_explanation_leaves(left: float, null: float, printed: bool) -> None:
    best = known(("load_coulomb",), 1000.0, left=left)
    rival = known(("load_quadratic",), 980.0)
    assert list_aliases(known_search(best, rival, null=null), "load_coulomb") == (
        ("load_quadratic",) if printed else ()
    )


def test_a_set_is_never_wider_than_another_form_of_a_law() -> None:
    best = known(("load_coulomb",), 1000.0, left=500.0)
    rival = known(("load_quadratic",), 960.0)
    assert list_aliases(known_search(best, rival), "load_coulomb") == ()


@pytest.mark.parametrize("seen", ["sliding", "about rest"])
def test_the_form_of_the_bristle_is_not_held_against_an_explanation(seen: str, baseline: Baseline) -> None:
    rows = baseline.sliding if seen == "sliding" else np.logical_not(baseline.sliding)
    generic = rows[:, None] / np.sqrt(np.sum(rows))
    base = known_baseline()
    base.__dict__["generic"] = generic  # as if its splines were this one column
    energy = 0.2 * float(np.sum(rows))
    left = _compute_left(base, fit_of(np.sqrt(0.2) * rows))
    assert left == pytest.approx(energy - 1.0 if seen == "sliding" else 0.0)
    loud = _compute_left(base, fit_of(rows.astype(float)))
    allowed = 0.0 if seen == "sliding" else 0.3 * float(np.sum(rows))
    assert loud == pytest.approx(np.sum(rows) - 1.0 - allowed)


@pytest.mark.parametrize(
    ("coverage", "left", "certain", "named"),
    [
        (0.92, 500.0, 40.0, True),
        (0.86, 500.0, 40.0, False),
        (0.55, 10.0, 40.0, True),  # nulls leave as much
        (0.45, 10.0, 40.0, False),
        (0.75, 50.0, 60.0, True),  # faint beside a clear gain
        (0.75, 50.0, 40.0, False),
        (0.65, 50.0, 60.0, False),
    ],
)
def test_what_is_named_covers_the_mismatch(coverage: float, left: float, certain: float, named: bool) -> None:
    best = known(("cogging",), 100.0, certain=certain, coverage=coverage, left=left)
    assert covers(best, known_search(best, null=20.0), known_baseline()) == named


@pytest.mark.parametrize(
    ("names", "gain", "refused", "named"),
    [
        (("cogging",), 1200.0, "no period of it lies within the recorded range", False),
        (("cogging",), 1100.0, "no period of it lies within the recorded range", True),  # not clearly more
        (("cogging",), 1200.0, "", True),  # which the choice has weighed
        (("cogging", "end_stop"), 1200.0, "the stop would pull outwards", True),  # no fewer
    ],
)
def test_a_sum_is_not_named_where_fewer_explain_clearly_more_with_numbers_that_they_cannot_have(
    names: tuple[str, ...], gain: float, refused: str, named: bool
) -> None:
    best, other = known(("end_stop", "kinematic_error"), 1000.0), known(names, gain, refused=refused)
    assert covers(best, known_search(best, other), known_baseline()) == named


@pytest.mark.parametrize(
    ("ratio", "structured", "explainable", "null", "unknown"),
    [
        (1.10, False, 130.0, 20.0, True),
        (1.08, False, 130.0, 20.0, False),  # as loud as nulls now and then are
        (1.10, False, 100.0, 20.0, False),  # as much as nulls of few rows
        (1.10, False, 130.0, 50.0, False),
        (1.24, False, 0.0, 0.0, False),  # nothing smooth
        (1.26, False, 0.0, 0.0, True),
        (1.05, True, 0.0, 0.0, True),  # swings as no noise does
        (1.03, True, 0.0, 0.0, False),
    ],
)
def test_something_smooth_or_swinging_that_is_heard_is_unknown(
    ratio: float, structured: bool, explainable: float, null: float, unknown: bool
) -> None:
    found = known_search(best=False, explainable=explainable, null=null)
    base = known_baseline(loudness=ratio, structured=structured)
    assert stands_out(found, base) == unknown


@pytest.mark.parametrize(
    ("noise", "quiet", "of_torque", "unknown"),
    [
        (0.02, True, 1.0, True),
        (0.01, True, 1.0, False),  # the arithmetic of a simulator
        (0.01, False, 1.0, True),
        (0.002, False, 1.0, False),
    ],
)
def test_what_is_left_must_matter_beside_the_friction(
    noise: float, quiet: bool, of_torque: float, unknown: bool
) -> None:
    """Without noise, a part of it that a user would look for; with noise, much less."""
    base = known_baseline(loudness=2.0)
    weights = replace(base.nulls.weights, spread=(np.full_like(base.nulls.weights.spread[0], noise),))
    nulls = replace(base.nulls, rows=(noise * base.nulls.rows[0],), weights=weights, quiet=quiet, of_torque=of_torque)
    heard = replace(base, nulls=nulls)
    left, share = measure_left(heard)
    assert left == pytest.approx(np.sqrt(3.0) * noise)
    assert share == pytest.approx(left / PLANT.level)
    assert stands_out(known_search(best=False), heard) == unknown
    assert stands_out(known_search(best=False), heard, covered=True)  # effects of the catalogue cover it


@pytest.mark.parametrize(("of_torque", "unknown"), [(0.0, False), (0.5, False), (0.9, True)])
def test_what_an_encoders_steps_may_leave_is_nothing_unknown(of_torque: float, unknown: bool) -> None:
    """A loop that chatters at them makes torque that hangs on their phase, which nobody knows."""
    base = known_baseline(loudness=1.1, structured=True)  # leaves 0.46 of the noise
    steps = replace(base, nulls=replace(base.nulls, of_torque=of_torque))
    assert stands_out(known_search(best=False), steps) == unknown


def test_beside_no_friction_at_all_everything_that_is_left_matters() -> None:
    base = known_baseline(loudness=2.0)
    theta = base.fit.theta.copy()
    theta[[BASE_NAMES.index("forward.coulomb_torque"), BASE_NAMES.index("reverse.coulomb_torque")]] = 0.0
    free = replace(base, fit=replace(base.fit, theta=theta))
    left, share = measure_left(free)
    assert left > 0.0
    assert share == np.inf
    assert "Coulomb" not in describe_trace(left, share, "N·m")


def test_points_that_move_the_base_alone_share_their_effects(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[FloatArray] = []

    def contributions(_: Structure, theta: FloatArray) -> list[Contribution]:
        asked.append(theta)
        return [Contribution(delay=float(theta[N_BASE]))]

    monkeypatch.setattr(Structure, "compute_contributions", contributions)
    structure, effects = Structure(()), (1.0, 1.0, 2.0, 1.0)
    points = [np.concatenate([np.full(N_BASE, float(i)), [size]]) for i, size in enumerate(effects)]
    found = list(_compute_contributions([(structure, point) for point in points], at_once=4))
    assert len(asked) == 2
    assert [one[0].delay for one in found] == list(effects)

"""Which explanation is chosen: what more effects must add, and where they must show."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest

from fricomp.diagnosis.search.choice import choose, rank_acceptable, select_finalists
from fricomp.diagnosis.search.explanation import compute_evidence
from fricomp.diagnosis.search.preparation import Baseline

from ..known import fit_of, known

_ROWS = 400
_SLIDING = np.arange(_ROWS) % 4 > 0
_QUIET = np.zeros(_ROWS)
_LOUD_NULLS = (np.full(_ROWS, 9.0),)  # beside which no explanation leaves anything
_PREPARED = cast(Baseline, SimpleNamespace(sliding=_SLIDING, null_residuals=_LOUD_NULLS))


def test_what_rest_alone_gains_does_not_make_a_pair() -> None:
    only_rest, everywhere = np.where(_SLIDING, 0.0, 0.76), np.full(_ROWS, 2.0)
    pair = known(("cogging", "frictional_lag"), 500.0, _QUIET, coverage=0.99)
    shown, hidden = (known(("cogging",), 100.0, residual) for residual in (everywhere, only_rest))
    assert choose(_PREPARED, [shown, pair], 50.0) is pair
    assert choose(_PREPARED, [hidden, pair], 50.0) is hidden
    ended = known(("cogging", "end_stop"), 500.0, _QUIET, coverage=0.99)
    assert choose(_PREPARED, [hidden, ended], 50.0) is ended


def test_an_effect_like_a_bristle_yields_what_the_form_of_the_bristle_leaves() -> None:
    rest = int(np.sum(~_SLIDING))
    for per_row in (0.76, 0.2):
        before = fit_of(np.where(_SLIDING, 0.0, np.sqrt(per_row)))
        rises = compute_evidence(_PREPARED, ["dwell_stiction"], before, fit_of(np.zeros(_ROWS)))
        stops = compute_evidence(_PREPARED, ["end_stop"], before, fit_of(np.zeros(_ROWS)))
        assert stops == pytest.approx(per_row * rest)
        assert rises == pytest.approx((per_row - 0.1) * rest)


@pytest.mark.parametrize(("gain", "named"), [(20_600.0, False), (22_000.0, True)])
def test_what_completes_a_strong_effect_at_rest_alone_is_no_small_part_of_it(gain: float, named: bool) -> None:
    only_rest = np.where(_SLIDING, 0.0, 0.76)
    lag = known(("drive_lag",), 20_000.0, only_rest, left=600.0, coverage=0.96)
    pair = known(("drive_lag", "frictional_lag"), gain, _QUIET, left=10.0, coverage=1.0)
    assert (choose(_PREPARED, [lag, pair], 50.0) is pair) == named


def test_a_second_effect_that_brings_a_large_part_of_all_counts_wherever_it_shows() -> None:
    """A late torque shows where the joint turns round, which a generic basis hardly sees."""
    only_rest = np.where(_SLIDING, 0.0, 0.76)
    ripple = known(("kinematic_error",), 3000.0, only_rest, coverage=1.0)
    for gain, named in ((4700.0, True), (3700.0, False)):
        pair = known(("kinematic_error", "torque_delay"), gain, _QUIET, coverage=1.0)
        assert (choose(_PREPARED, [ripple, pair], 50.0) is pair) == named


def test_what_two_explanations_leave_is_no_evidence_for_one_of_them() -> None:
    at_the_end = np.where(np.arange(_ROWS) < 40, 5.0, 0.0)
    stop = known(("end_stop",), 90_000.0, np.full(_ROWS, 2.2), coverage=1.0, reached=at_the_end)
    pair = known(("end_stop", "thermal_friction"), 90_350.0, np.full(_ROWS, 2.0), coverage=1.0)
    assert choose(_PREPARED, [stop, pair], 50.0) is stop


def test_only_what_is_certain_passes_the_threshold() -> None:
    loud = known(("backlash",), 900.0, _QUIET, certain=20.0)
    sure = known(("cogging",), 400.0, _QUIET, certain=300.0)
    refused = known(("end_stop",), 999.0, _QUIET, refused="pulls outwards")
    assert rank_acceptable([loud, sure, refused], 30.0) == [sure]


@pytest.mark.parametrize(("filling", "share"), [("position_coulomb", 0.99), ("external_disturbance", 0.85)])
def test_what_fills_in_for_others_yields_to_what_fits_about_as_well(filling: str, share: float) -> None:
    fills = known((filling,), 1000.0, _QUIET)
    plain = known(("load_coulomb",), share * 1000.0, _QUIET)
    assert rank_acceptable([fills, plain], 30.0) == [plain, fills]
    clear = known(("load_coulomb",), 0.7 * 1000.0, _QUIET)
    assert rank_acceptable([fills, clear], 30.0) == [fills, clear]


@pytest.mark.parametrize(("second", "chosen"), [("thermal_friction", True), ("position_coulomb", False)])
def test_a_second_effect_counts_where_the_first_one_does_not_reach(second: str, chosen: bool) -> None:
    """A stop explains 90000 at one end of the range; beside it 300 elsewhere are no form of the stop."""
    at_the_end = np.where(np.arange(_ROWS) < 40, 5.0, 0.0)
    stop = known(("end_stop",), 90_000.0, np.ones(_ROWS), coverage=1.0, reached=at_the_end)
    pair = known(("end_stop", second), 90_300.0, _QUIET, coverage=1.0)
    assert (choose(_PREPARED, [stop, pair], 50.0) is pair) == chosen
    everywhere = replace(stop, reached=np.full(_ROWS, 5.0))
    assert choose(_PREPARED, [everywhere, pair], 50.0) is everywhere


def test_an_effect_that_a_generic_basis_does_not_see_counts_by_its_gain() -> None:
    """Ripple of a high order beside load friction that covers all the basis sees."""
    load = known(("load_coulomb",), 4000.0, np.full(_ROWS, 1.5), coverage=0.99)
    pair = known(("kinematic_error", "load_coulomb"), 4900.0, _QUIET, coverage=0.995)
    assert choose(_PREPARED, [load, pair], 50.0) is pair
    little = known(("kinematic_error", "load_coulomb"), 4200.0, _QUIET, coverage=0.995)
    assert choose(_PREPARED, [load, little], 50.0) is load


@pytest.mark.parametrize(
    ("further", "left", "gain", "named"),
    [
        ("stribeck_shape", 20.0, 9700.0, True),  # takes away nearly all that is left
        ("stribeck_shape", 200.0, 9700.0, False),  # some of it, as another form of the first effect would
        ("stribeck_shape", 20.0, 9080.0, False),  # but little weight speaks for it
        ("position_coulomb", 20.0, 9700.0, False),  # would fill in for any form
    ],
)
def test_a_faint_effect_beside_a_strong_one_must_complete_it(
    further: str, left: float, gain: float, named: bool
) -> None:
    first = known(("end_stop",), 9000.0, np.ones(_ROWS), left=400.0, coverage=0.96)
    pair = known(("end_stop", further), gain, _QUIET, left=left, coverage=1.0)
    assert (choose(_PREPARED, [first, pair], 30.0) is pair) == named


@pytest.mark.parametrize(("left", "named"), [(1700.0, False), (900.0, True)])
def test_a_further_effect_takes_at_least_half_of_what_the_first_one_leaves(left: float, named: bool) -> None:
    """A stop beside a ripple of six orders, of which the model has one: no more of it is a stop than is not."""
    before, after = np.full(_ROWS, 3.0), np.full(_ROWS, 2.0)
    ripple = known(("cogging",), 13_900.0, before, left=2700.0, coverage=0.84)
    pair = known(("cogging", "end_stop"), 15_700.0, after, left=left, coverage=0.9)
    # Both reach all rows: no part of the further effect stands apart.
    assert (choose(_PREPARED, [ripple, pair], 50.0) is pair) == named


@pytest.mark.parametrize(
    ("before", "after", "further", "named"),
    [
        (1.3, 1.05, "load_stribeck", True),  # most of what was louder than the noise is gone
        (1.3, 1.2, "load_stribeck", False),  # some of it
        (1.05, 1.0, "load_stribeck", False),  # there was next to nothing
        (1.3, 1.05, "position_coulomb", False),  # would fill in for any form
    ],
)
def test_a_further_effect_may_complete_what_no_generic_basis_sees(
    before: float, after: float, further: str, named: bool
) -> None:
    baseline = cast(Baseline, SimpleNamespace(sliding=_SLIDING, null_residuals=(np.ones(_ROWS),)))
    first = known(("quadratic_drag",), 9000.0, np.full(_ROWS, before), coverage=1.0)
    pair = known(("quadratic_drag", further), 9500.0, np.full(_ROWS, after), coverage=1.0)
    assert (choose(baseline, [first, pair], 30.0) is pair) == named


def test_an_effect_that_is_only_carried_is_not_named() -> None:
    """What one effect explains all but alone stays unnamed where that effect is refused."""
    refused = "the exponent is two within its tolerance"
    alone = known(("stribeck_shape",), 440.0, _QUIET, refused=refused)
    carried = known(("joint_elasticity", "stribeck_shape"), 450.0, _QUIET, coverage=0.99)
    assert choose(_PREPARED, [alone, carried], 30.0) is None
    worth = known(("joint_elasticity", "stribeck_shape"), 900.0, _QUIET, coverage=0.99)
    assert choose(_PREPARED, [alone, worth], 30.0) is worth


@pytest.mark.parametrize(("gain", "named"), [(370.0, False), (400.0, True)])
def test_a_ripple_that_grows_with_a_torque_which_hardly_changes_is_one_of_the_torque(gain: float, named: bool) -> None:
    plain, growing = known(("cogging",), 368.0, _QUIET), known(("torque_ripple",), gain, _QUIET)
    assert (choose(_PREPARED, [plain, growing], 50.0) is growing) == named


def test_what_leaves_less_than_the_best_with_no_more_effects_may_still_win() -> None:
    best = known(("torque_ripple",), 1000.0, left=45.0)
    unfinished = known(("position_coulomb",), 800.0, left=20.0)
    larger = known(("position_coulomb", "torque_ripple"), 800.0, left=10.0)
    worse = known(("cogging",), 850.0, left=60.0)
    assert select_finalists(best, [best, worse, unfinished, larger]) == [best, unfinished]

"""Logs as they come: the friction that is right comes out, or what is wrong is named."""

from __future__ import annotations

from itertools import combinations

import pytest

from fricomp.sim_bench.studies.logs.flaws import FLAWS
from fricomp.sim_bench.studies.logs.trial import Trial, list_cases, try_case

PAIRS = [(one, other) for (i, one), (j, other) in combinations(enumerate(FLAWS), 2) if (i + j) % 3 == 0]
"""Every flaw beside six or seven others; `fricomp bench logs` has all pairs."""


def _assert_good(trial: Trial) -> None:
    assert trial.is_good, trial


@pytest.mark.parametrize("flaw", FLAWS)
def test_a_flaw_leaves_the_right_friction_or_is_named(flaw: str) -> None:
    _assert_good(try_case((flaw,), 400.0, 21))


@pytest.mark.slow
@pytest.mark.parametrize("pair", PAIRS, ids="+".join)
def test_two_flaws_leave_the_right_friction_or_one_is_named(pair: tuple[str, str]) -> None:
    _assert_good(try_case(pair, 400.0, 22))


def test_cases_are_each_flaw_alone_and_each_pair_with_other_rates_in_turn() -> None:
    cases = list(list_cases(420, 5))
    assert len({flaws for flaws, _, _ in cases}) == 210
    assert len({(rate, seed) for _, rate, seed in cases}) == 2

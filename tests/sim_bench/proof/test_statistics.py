"""Intervals of medians, and of what shares a case."""

import numpy as np
import pytest

from fricomp.sim_bench.proof.statistics import bootstrap_ratio, compute_median, compute_share


def test_the_interval_of_a_median_holds_it_as_often_as_it_says() -> None:
    drawn = np.random.default_rng(3).standard_normal((2000, 25))
    found = [compute_median(row.tolist()) for row in drawn]
    assert np.mean([each.low <= 0.0 <= each.high for each in found]) == pytest.approx(0.957, abs=0.015)
    assert str(compute_median([1.0, 2.0, 3.0])) == "median 2 (1 to 3, all; 3 cases)"
    assert str(compute_median([float("nan")])) == "– (no case)"


def test_parameters_that_fail_together_widen_the_interval() -> None:
    apart = bootstrap_ratio([1] * 54 + [0] * 6, [1] * 60)
    together = bootstrap_ratio([3] * 18 + [0] * 2, [3] * 20)
    assert together[1] - together[0] > 1.4 * (apart[1] - apart[0])
    assert bootstrap_ratio([1] * 54 + [0] * 6, [1] * 60) == apart


def test_where_all_hit_the_interval_is_that_of_the_cases() -> None:
    assert bootstrap_ratio([3] * 10, [3] * 10) == (compute_share(10, 10).low, 1.0)
    assert bootstrap_ratio([0] * 10, [3] * 10) == (0.0, compute_share(0, 10).high)

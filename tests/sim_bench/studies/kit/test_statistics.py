"""Intervals of medians, and of what shares a case."""

import numpy as np
import pytest

from fricomp.sim_bench.studies.kit.statistics import (
    compute_clustered_share,
    compute_mean,
    compute_median,
    compute_share,
)


def test_the_interval_of_a_median_holds_it_as_often_as_it_says() -> None:
    drawn = np.random.default_rng(3).standard_normal((2000, 25))
    found = [compute_median(row.tolist()) for row in drawn]
    assert np.mean([each.low <= 0.0 <= each.high for each in found]) == pytest.approx(0.957, abs=0.015)
    assert str(compute_median([1.0, 2.0, 3.0])) == "median 2 (1 to 3, all; 3 cases)"
    assert str(compute_median([float("nan")])) == "– (no case)"


def test_parameters_that_fail_together_widen_the_interval() -> None:
    apart = compute_clustered_share([1] * 54 + [0] * 6, [1] * 60)
    together = compute_clustered_share([3] * 18 + [0] * 2, [3] * 20)
    assert together.high - together.low > 1.4 * (apart.high - apart.low)
    assert (together.hits, together.total) == (54, 60)
    exact = compute_share(54, 60)
    assert (apart.low, apart.high) == pytest.approx((exact.low, exact.high), abs=5e-3)


def test_where_all_hit_the_interval_is_that_of_the_cases() -> None:
    all_hit, none = compute_clustered_share([3] * 10, [3] * 10), compute_clustered_share([0] * 10, [3] * 10)
    assert (all_hit.low, all_hit.high) == (compute_share(10, 10).low, 1.0)
    assert (none.low, none.high) == (0.0, compute_share(0, 10).high)
    assert compute_clustered_share([], []).total == 0


def test_the_interval_of_clustered_shares_holds_the_share_as_often_as_it_says() -> None:
    """Beta-binomial clusters of four: a share of 0.9 and half of the variance between clusters."""
    rng = np.random.default_rng(5)
    held = 0
    for _ in range(400):
        shares = rng.beta(0.9, 0.1, 60)
        found = compute_clustered_share(rng.binomial(4, shares).tolist(), [4] * 60)
        held += found.low <= 0.9 <= found.high
    assert 0.93 <= held / 400 <= 1.0


def test_few_clusters_widen_the_interval_as_little_is_known_of_how_they_differ() -> None:
    """Six clusters of eight, a share of 0.6 and a third of the variance between clusters."""
    rng = np.random.default_rng(6)
    held = 0
    for _ in range(400):
        found = compute_clustered_share(rng.binomial(8, rng.beta(1.2, 0.8, 6)).tolist(), [8] * 6)
        held += found.low <= 0.6 <= found.high
    assert 0.93 <= held / 400 <= 1.0


def test_the_interval_of_a_mean_is_seeded_and_holds_it() -> None:
    values = [1.0, 1.0, 2.0, 3.0] * 10
    middle, low, high = compute_mean(values)
    assert middle == pytest.approx(1.75)
    assert low < middle < high
    assert compute_mean(values) == (middle, low, high)
    assert compute_mean([2.0]) == (2.0, 2.0, 2.0)

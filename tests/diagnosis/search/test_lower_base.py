"""A search that led to another valley of the base is made again from there."""

from __future__ import annotations

from dataclasses import replace

import pytest

from fricomp.diagnosis.search import rounds
from fricomp.diagnosis.search.again import lower_base
from fricomp.diagnosis.search.again.lower_base import find_lower_base
from fricomp.diagnosis.search.preparation import Baseline
from fricomp.diagnosis.search.rounds import _search_from_lower_base

from ..known import known_baseline, known_fit, known_search


@pytest.mark.parametrize(("times", "lower"), [(0.5, True), (0.999, False), (2.0, False)])
def test_a_base_is_lower_where_it_leaves_clearly_less(
    monkeypatch: pytest.MonkeyPatch, times: float, lower: bool
) -> None:
    baseline = known_baseline()
    other = replace(baseline.fit, theta=baseline.fit.theta + 1.0, cost=times * baseline.fit.cost)
    monkeypatch.setattr(lower_base, "fit_base", lambda *_: other)
    late = known_fit(baseline, ("torque_delay",), 900.0)
    assert find_lower_base(baseline, known_search(late)) is None  # it leaves no less itself
    led = replace(late, fit=replace(late.fit, cost=0.4 * baseline.fit.cost))
    found = find_lower_base(baseline, known_search(led))
    assert found is (other.theta if lower else None)
    assert find_lower_base(baseline, known_search(best=False)) is None


@pytest.mark.parametrize(("loudness", "kept"), [(1.0, True), (3.0, False)])
def test_a_search_from_a_lower_base_is_kept_where_that_leaves_less_by_weights_of_its_own(
    monkeypatch: pytest.MonkeyPatch, loudness: float, kept: bool
) -> None:
    """A joint with nothing missing had been given a delay of no length, by which its base came out of a valley."""
    baseline, other = known_baseline(loudness=2.0), known_baseline(loudness=loudness)
    found, again = known_search(known_fit(baseline, ("torque_delay",), 900.0)), known_search(best=False)
    asked = []

    def base(known: object = None) -> Baseline:
        asked.append(known)
        return other

    monkeypatch.setattr(rounds, "find_lower_base", lambda *_: baseline.fit.theta)
    monkeypatch.setattr(rounds, "search", lambda *_: again)
    lowered, left, result = _search_from_lower_base(baseline, found, base, lambda _: None)
    assert (left, result) == ((other, again) if kept else (baseline, found))
    assert asked == [baseline.fit.theta]
    assert (lowered is base) is not kept

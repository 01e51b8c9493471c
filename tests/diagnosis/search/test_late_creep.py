"""A search with friction that creeps takes the place of one without where it leaves less, and only there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis.search import rounds
from fricomp.diagnosis.search.explanation import Explanation
from fricomp.diagnosis.search.preparation import Baseline
from fricomp.diagnosis.search.rounds import _search_with_creep
from fricomp.diagnosis.search.search import SearchResult

from ..known import known_baseline, known_fit, known_search


def _cost(one: Explanation, times: float) -> Explanation:
    """The explanation with a cost so many times as large."""
    return replace(one, fit=replace(one.fit, cost=times * one.fit.cost))


def _search(
    monkeypatch: pytest.MonkeyPatch, times: float, left: tuple[float, float] = (1.0, 2.0), fails: Any = None
) -> bool:
    """Whether the search with creep is kept, whose explanation costs `times` as much in the same rows, where what is
    left without and with creep, each by its own noise, is `left`."""
    baseline = known_baseline()
    other = replace(baseline)
    found, again = _result(baseline), _result(other)

    def base(known: object = None) -> Baseline:
        if fails is not None:
            raise fails
        return other

    monkeypatch.setattr(rounds, "find_late_creep", lambda *_: _cost(found.explanations[0], times))
    monkeypatch.setattr(rounds, "search", lambda *_: again)
    monkeypatch.setattr(rounds, "measure_left", lambda one, _: left[one is other])
    return _search_with_creep(baseline, found, base, lambda _: None)[2] is again


def _result(baseline: Baseline) -> SearchResult:
    """A search that found a drag."""
    return known_search(known_fit(baseline, ("quadratic_drag",), 900.0))


@pytest.mark.parametrize(
    ("times", "left", "kept"),
    [(0.4, (1.0, 2.0), True), (0.6, (1.0, 2.0), False), (0.6, (2.0, 1.0), True)],
    ids=["far less", "less by another noise alone", "less by either"],
)
def test_a_search_with_creep_is_kept_where_it_leaves_less(
    monkeypatch: pytest.MonkeyPatch, times: float, left: tuple[float, float], kept: bool
) -> None:
    assert _search(monkeypatch, times, left) is kept


@pytest.mark.parametrize("error", [FloatingPointError("it runs away"), np.linalg.LinAlgError("SVD did not converge")])
def test_a_joint_that_runs_away_without_its_effects_is_not_searched(
    monkeypatch: pytest.MonkeyPatch, error: Exception
) -> None:
    """A joint that presses on a stop all the time has no base without it."""
    assert not _search(monkeypatch, 0.4, fails=error)

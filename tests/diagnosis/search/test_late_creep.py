"""A search with friction that creeps takes the place of one without where it leaves less, and only there."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis.joint.base import BASE_NAMES
from fricomp.diagnosis.search import rounds
from fricomp.diagnosis.search.again import late_creep
from fricomp.diagnosis.search.again.late_creep import propose_creep
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


@pytest.mark.parametrize(("left", "kept"), [(0.8, True), (0.9, False)])
def test_a_base_that_takes_the_torque_too_early_is_tried_with_creep(
    monkeypatch: pytest.MonkeyPatch, left: float, kept: bool
) -> None:
    """Where no creep is in sight from what was found, the torque that is left decides, not what passes for noise."""
    baseline = known_baseline()
    other = replace(baseline)
    monkeypatch.setattr(rounds, "find_late_creep", lambda *_: None)
    monkeypatch.setattr(rounds, "propose_creep", lambda *_: baseline.fit.theta)
    monkeypatch.setattr(rounds, "search", lambda *_: _result(other))
    monkeypatch.setattr(rounds, "measure_plain_left", lambda one, _: left if one is other else 1.0)
    searched = _search_with_creep(baseline, _result(baseline), lambda **_: other, lambda _: None)
    assert (searched[1] is other) is kept


@pytest.mark.parametrize(
    ("early", "loudness", "names", "proposed"),
    [
        (1.0, 2.0, ["cogging", "quadratic_drag"], True),
        (0.5, 2.0, ["cogging", "quadratic_drag"], False),
        (1.0, 1.0, ["cogging", "quadratic_drag"], False),
        (1.0, 1.12, ["torque_delay"], False),
    ],
    ids=["loud and early", "not early", "not loud", "one effect leaves noise alone"],
)
def test_creep_is_proposed_where_a_loud_base_takes_the_torque_as_early_as_it_may(
    monkeypatch: pytest.MonkeyPatch, early: float, loudness: float, names: list[str], proposed: bool
) -> None:
    baseline = known_baseline(loudness=loudness)
    theta = baseline.fit.theta.copy()
    theta[BASE_NAMES.index("delay")] = early * baseline.box.lower[BASE_NAMES.index("delay")]
    baseline = replace(baseline, fit=replace(baseline.fit, theta=theta))
    creeping = np.ones_like(theta)
    monkeypatch.setattr(late_creep, "fit_creep", lambda *_: (replace(baseline.fit, theta=creeping), baseline.box))
    wanted = propose_creep(baseline, known_search(known_fit(baseline, names, 900.0)))
    assert (wanted is creeping) is proposed

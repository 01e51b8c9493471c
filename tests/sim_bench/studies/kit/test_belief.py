"""Probabilities beside what is true."""

from __future__ import annotations

from typing import Any

import pytest

from fricomp.sim_bench.studies.kit.belief import Belief, compute_brier, list_beliefs, tabulate_beliefs


def _said(*names: str, **probability: float) -> dict[str, Any]:
    return {"effects": [{"name": name} for name in names], "probability": probability}


def test_each_probability_stands_beside_what_is_true() -> None:
    said = _said("cogging", cogging=0.95, end_stop=0.3, nothing=0.0, unknown=0.1)
    found = {one.name: (one.right, one.named) for one in list_beliefs(said, {"cogging"}, "missing_physics")}
    assert found == {
        "cogging": (True, True), "end_stop": (False, False), "nothing": (False, False), "unknown": (False, False),
    }  # fmt: skip


def test_nothing_is_right_only_where_no_parameter_is_off_either() -> None:
    said = _said(nothing=1.0)
    assert list_beliefs(said, set(), "consistent")[0].right
    assert not list_beliefs(said, {"payload_error"}, "parameters")[0].right


def test_an_answer_without_probabilities_has_no_beliefs() -> None:
    assert list_beliefs({"effects": []}, {"cogging"}, "missing_physics") == ()


def test_the_brier_score_is_the_mean_squared_distance() -> None:
    assert compute_brier([Belief("a", 0.8, True), Belief("b", 0.4, False)]) == pytest.approx((0.04 + 0.16) / 2)


def test_tenths_are_counted_apart() -> None:
    beliefs = [Belief("a", 0.05, False), Belief("b", 0.95, True), Belief("c", 1.0, True), Belief("d", 0.92, False)]
    rows = tabulate_beliefs(beliefs)
    assert [tenth for tenth, _ in rows] == ["0.0 to 0.1", "0.9 to 1.0"]
    assert rows[1][1].startswith("67 %") or "2 of 3" in rows[1][1]

"""Probabilities of names, of nothing, and of something unknown."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest

from fricomp.diagnosis.evidence.repetition import Repetitions
from fricomp.diagnosis.evidence.trial import Trial
from fricomp.diagnosis.samples.sample_finding import SampleFinding
from fricomp.diagnosis.verdict.probability import NOTHING, UNKNOWN, compute_probability, list_probabilities

from ..known import known_baseline, known_findings


def test_more_repetitions_are_a_larger_probability() -> None:
    values = [compute_probability(share) for share in (0.0, 0.3, 0.6, 0.9, 1.0)]
    assert values == sorted(values)
    assert 0.0 <= values[0] < values[-1] <= 1.0


def test_every_name_that_came_up_has_one_and_so_have_nothing_and_unknown() -> None:
    again = Repetitions(20, {("cogging",): 12, ("cogging", "load_coulomb"): 2}, nothing=4, unknown=2)
    findings = replace(known_findings(known_baseline()), trial=Trial(again))
    found = list_probabilities(findings, (), None)
    assert list(found) == ["cogging", "load_coulomb", NOTHING, UNKNOWN]
    assert found["cogging"] == pytest.approx(compute_probability(0.7))
    assert found[NOTHING] == pytest.approx(compute_probability(0.2))


def test_a_parameter_that_moves_leaves_less_for_nothing() -> None:
    findings = replace(
        known_findings(known_baseline()), trial=Trial(Repetitions(10, nothing=10)), shift_shares={"inertia_error": 1.0}
    )
    found = list_probabilities(findings, (), None)
    assert found["inertia_error"] == compute_probability(1.0)
    assert found[NOTHING] == compute_probability(0.0)


def test_what_the_samples_show_leaves_less_for_nothing_and_for_something_unknown() -> None:
    findings = replace(known_findings(known_baseline()), trial=Trial(Repetitions(10, nothing=3, unknown=7)))
    found = list_probabilities(findings, (), cast(SampleFinding, SimpleNamespace(name="cogging", share=1.0)))
    assert found["cogging"] == compute_probability(1.0)
    assert found[NOTHING] == found[UNKNOWN] == compute_probability(0.0)

"""Scores of known joints, summed up."""

import pytest

from fricomp.sim_bench.studies.identification.seed_study import Score, SeedStudy


def test_a_study_sums_up_its_seeds() -> None:
    scores = (Score(0, "a", 0.01, 1.0, True), Score(1, "a", -0.03, -3.0, False), Score(0, "b", 0.0, 0.0, True))
    study = SeedStudy(scores, ("converged", "converged"))
    assert study.names == ("a", "b")
    assert study.mean_error("a") == pytest.approx(0.02)
    assert study.root_mean_square("a") == pytest.approx(5.0**0.5)
    assert study.coverage() == pytest.approx(2.0 / 3.0)
    assert study.to_builtins()["parameters"]["a"]["covered"] == 1


def test_where_there_is_a_profile_it_is_what_holds() -> None:
    assert Score(0, "a", 0.5, 5.0, covered=False, profiled=True).held
    assert not Score(0, "a", 0.5, 1.0, covered=True, profiled=False).held
    assert Score(0, "a", 0.5, 1.0, covered=True).held

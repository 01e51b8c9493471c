"""The quick proof with the diagnosis itself: joints made, sealed, diagnosed in another process, opened and scored."""

from pathlib import Path

import pytest

from fricomp.fleet import open_executor
from fricomp.sim_bench.studies.proof import RunSettings, Score, plan_run, run_proof

_CASES = 8


@pytest.fixture(scope="module")
def scores(tmp_path_factory: pytest.TempPathFactory) -> list[Score]:
    folder: Path = tmp_path_factory.mktemp("proof")
    planned = plan_run(RunSettings(_CASES, quick=True))
    with open_executor("serial") as executor:
        return run_proof(planned, folder, executor, salt="quick")


@pytest.mark.slow
def test_every_case_of_the_quick_proof_gets_an_answer(scores: list[Score]) -> None:
    assert len(scores) == _CASES
    assert all(score.verdict != "failed" for score in scores), [score.error for score in scores]


@pytest.mark.slow
def test_nothing_is_named_where_nothing_is_missing(scores: list[Score]) -> None:
    nothing = [score for score in scores if score.group in ("null", "hard_null")]
    assert nothing
    assert all(score.false_names == 0 for score in nothing), [score.command for score in nothing if score.false_names]
    assert all(score.verdict in ("consistent", "parameters") for score in nothing)


@pytest.mark.slow
def test_what_can_be_seen_is_named_first(scores: list[Score]) -> None:
    """All but one: an asymmetry of 1.5 % stays within what a comparison with the given friction doubts."""
    seen = [score for score in scores if score.group == "single" and score.enr >= 0.95]
    assert len(seen) >= 3
    right = [score for score in seen if score.top_right or (score.verdict_right and not score.named)]
    assert len(right) >= len(seen) - 1, [score.command for score in seen if score not in right]

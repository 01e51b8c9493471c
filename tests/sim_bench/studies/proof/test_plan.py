"""What is tried, on which seeds, and in which order it is sealed."""

import itertools
import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError
from fricomp.sim_bench.cases import CATALOGUE, CHOICES, EXCITATIONS, OUTSIDE, CaseSpec, derive_case_id
from fricomp.sim_bench.studies.proof import (
    GROUPS,
    PlannedCase,
    RunSettings,
    draw_seeds,
    list_development_seeds,
    plan_cases,
    plan_clear_cases,
)
from fricomp.sim_bench.studies.proof.plan import NULLS
from fricomp.sim_bench.studies.proof.seal import SealBook


def _specs(planned: Iterable[PlannedCase]) -> list[CaseSpec]:
    return [each.spec for each in planned if isinstance(each.spec, CaseSpec)]


def _names(planned: Iterable[PlannedCase], group: str) -> list[str]:
    return [name for spec in _specs(each for each in planned if each.group == group) for name in spec.effects]


def test_two_thousand_cases_hold_enough_of_each_group() -> None:
    planned = plan_cases(2000, list_development_seeds())
    groups = Counter(each.group for each in planned)
    assert groups["null"] + groups["hard_null"] >= 500
    assert groups["pair"] >= 200
    assert groups["outside"] >= 100
    assert {spec.excitation for spec in _specs(planned)} == set(EXCITATIONS)
    assert len({each.spec.strength for each in planned if each.group == "single"}) >= 6
    assert set(_names(planned, "single")) == set(CATALOGUE)
    assert set(_names(planned, "outside")) == set(OUTSIDE)


def test_the_clear_plan_holds_every_effect_once_and_nulls() -> None:
    planned = plan_clear_cases(list_development_seeds(1000))
    singles = _names(planned, "single")
    assert sorted(singles) == sorted(CATALOGUE)
    assert {each.spec.strength for each in planned} == {"clear"}
    nulls = _specs(each for each in planned if each.group == "null")
    assert len(nulls) == len(CATALOGUE) // 3
    for specs in (nulls, _specs(each for each in planned if each.group == "single")):
        assert {spec.core for spec in specs} == {"dahl", "lugre", "gms", "set_valued"}


def test_a_plan_of_nulls_alone_turns_through_motions_and_cores() -> None:
    planned = plan_cases(300, list_development_seeds(), groups=NULLS)
    assert {each.group for each in planned} == set(NULLS)
    assert all(not spec.effects for spec in _specs(planned))
    assert {spec.excitation for spec in _specs(planned)} == set(EXCITATIONS)
    assert {spec.core for spec in _specs(planned)} == {"dahl", "lugre", "gms", "set_valued"}


def test_every_case_of_a_plan_is_another() -> None:
    planned = plan_cases(500, list_development_seeds())
    assert len({derive_case_id(spec) for spec in _specs(planned)}) == 500


def test_a_short_plan_is_the_beginning_of_a_long_one_in_fair_shares() -> None:
    short, long = plan_cases(100, list_development_seeds()), plan_cases(400, list_development_seeds())
    assert long[:100] == short
    groups = Counter(each.group for each in short)
    assert all(abs(groups[name] - 100 * share) <= 1.0 for name, share in GROUPS.items())


def test_a_run_that_is_cut_short_has_weak_and_strong_effects_alike() -> None:
    planned = plan_cases(120, list_development_seeds())
    strengths = Counter(each.spec.strength for each in planned if each.group == "single")
    assert len(strengths) == 7
    assert max(strengths.values()) - min(strengths.values()) <= 3


def test_every_effect_meets_every_friction_core_and_motion() -> None:
    met: dict[str, set[str]] = {name: set() for name in CATALOGUE}
    for each in plan_cases(2000, list_development_seeds(), order=26):
        if each.group == "single" and isinstance(each.spec, CaseSpec):
            met[each.spec.effects[0]] |= {str(each.spec.core), each.spec.excitation}
    assert all(some == {*CHOICES["core"], *EXCITATIONS} for some in met.values())


@pytest.mark.parametrize("number", [1, 13, 14])
def test_an_order_has_designs_of_its_own_in_the_same_shares(number: int) -> None:
    first, other = plan_cases(400, list_development_seeds()), plan_cases(400, list_development_seeds(), order=number)
    assert [each.group for each in other] == [each.group for each in first]
    assert plan_cases(400, list_development_seeds(), order=number)[:50] == other[:50]
    same = sum(replace(a, seed=0) == replace(b, seed=0) for a, b in zip(_specs(first), _specs(other), strict=True))
    assert same <= 12  # nulls have few enough settings that some meet
    assert set(_names(other, "single")) == set(CATALOGUE)
    strengths = Counter(each.spec.strength for each in other if each.group == "single")
    assert len(strengths) == 7


def test_seeds_of_a_scored_run_are_no_development_seeds_and_follow_from_its_key() -> None:
    def draw(key: str, count: int = 5) -> list[int]:
        return list(itertools.islice(draw_seeds(RunSettings(1, scored=True, key=key)), count))

    first = draw("abc", 1000)
    assert min(first) >= 1 << 62
    assert len(set(first)) == 1000
    assert draw("abd") != first[:5] == draw("abc")
    with pytest.raises(DiagnosisError, match="development seeds"):
        list_development_seeds(1 << 62)


def test_a_changed_answer_does_not_open(tmp_path: Path) -> None:
    book = SealBook(tmp_path / "seals.jsonl")
    book.seal("case-1", b"the answer")
    reopened = SealBook(tmp_path / "seals.jsonl")
    reopened.open("case-1", b"the answer")
    with pytest.raises(DiagnosisError, match="does not match its seal"):
        reopened.open("case-1", b"another answer")
    with pytest.raises(DiagnosisError, match="does not match its seal"):
        reopened.open("case-2", b"the answer")
    with pytest.raises(DiagnosisError, match="start a new folder"):
        reopened.seal("case-1", b"another answer")


def test_a_case_that_was_never_opened_is_sealed_again_in_a_second_line(tmp_path: Path) -> None:
    path = tmp_path / "seals.jsonl"
    SealBook(path).seal("case-1", b"rounded here")
    again = SealBook(path)
    again.seal("case-1", b"rounded there")
    again.seal("case-1", b"rounded there")
    first, second = map(json.loads, path.read_text().splitlines())
    assert first["case"] == second["case"] == "case-1"
    assert first["sha256"] != second["sha256"]
    SealBook(path).open("case-1", b"rounded there")
    with pytest.raises(DiagnosisError, match="does not match its seal"):
        SealBook(path).open("case-1", b"rounded here")

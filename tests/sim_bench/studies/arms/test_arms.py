"""Sealed arms: what was said is held against the truth, and a run can be stopped, resumed and written as a page."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError
from fricomp.fleet import open_executor
from fricomp.sim_bench.studies.arms import (
    ArmScore,
    compute_figures,
    read_arm_scores,
    run_arms,
    score_arm,
    write_page,
)
from fricomp.sim_bench.studies.arms.page import explain_miss
from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from fricomp.sim_bench.studies.proof import RunSettings

FRICTION = {"coulomb_forward": 2.1, "coulomb_reverse": 1.9, "viscous": 1.0}


def quantity(value: float, width: float) -> dict[str, object]:
    return {"value": value, "unit": "1", "ci95": [value - width, value + width]}


def say(joint: str, *names: str, others: tuple[str, ...] = ()) -> dict[str, object]:
    return {
        "name": joint,
        "effects": [{"name": name, "indistinguishable_from": others} for name in names],
        "friction": {"coulomb": quantity(2.05, 0.1), "viscous": quantity(0.8, 0.1)},
        "error_simulation": 0.4,
        "error_model": 0.1,
    }


def score(*joints: dict[str, object], effects: tuple[tuple[str, str, float], ...], error: str = "") -> ArmScore:
    names = ("base", "elbow")
    answer = {
        "id": "arm-1",
        "spec": {"seed": 3},
        "effects": [{"joint": joint, "name": name, "enr": enr} for joint, name, enr in effects],
        "links": {"forearm": {"mass": 3.0, "x": 0.1, "y": 0.0, "z": 0.5}},
        "friction": dict.fromkeys(names, FRICTION),
    }
    link = {
        "name": "forearm",
        "state": "off",
        "determined": ["mass", "z"],
        "mass": quantity(3.1, 0.2),
        "first_moment": {"x": quantity(0.0, 0.01), "y": quantity(0.0, 0.01), "z": quantity(0.4, 0.05)},
    }
    said = b"" if error else json.dumps({"joints": joints, "links": [link]}).encode()
    return score_arm(json.dumps(answer).encode(), BlindAnswer(said, b"", 20.0, error))


def test_an_effect_is_exact_with_its_name_and_nothing_beside_it() -> None:
    hidden = (("elbow", "load_coulomb", 2.0),)
    right = score(say("base"), say("elbow", "load_coulomb"), effects=hidden)
    alike = score(say("base"), say("elbow", "load_quadratic", others=("load_coulomb",)), effects=hidden)
    beside = score(say("base"), say("elbow", "load_coulomb", "cogging"), effects=hidden)
    missed = score(say("base"), say("elbow"), effects=hidden)
    assert [one.is_exact(one.truth[0]) for one in (right, alike, beside, missed)] == [True, True, False, False]
    assert [one.is_found(one.truth[0]) for one in (right, alike, beside, missed)] == [True, True, True, False]
    assert explain_miss(beside, beside.truth[0]) == "named, with `cogging`"
    assert explain_miss(missed, missed.truth[0]) == "nothing named in the joint"


def test_a_name_in_a_healthy_joint_is_false() -> None:
    one = score(say("base", "cogging"), say("elbow", "load_coulomb"), effects=(("elbow", "load_coulomb", 2.0),))
    assert [(each.joint, each.name) for each in one.false_names] == [("base", "cogging")]
    assert not one.is_right


def test_only_what_the_motion_determines_counts_for_coverage() -> None:
    one = score(say("base"), say("elbow"), effects=(("elbow", "load_coulomb", 0.1),))
    assert [(each.parameter, each.covers) for each in one.links] == [("mass", True), ("z", False)]
    assert {(each.effect, each.parameter, each.covers) for each in one.friction} == {
        ("base", "coulomb", True),
        ("base", "viscous", False),
    }
    assert one.is_right  # a weak effect need not be named


def test_an_arm_without_an_answer_is_a_miss(tmp_path: Path) -> None:
    one = score(effects=(("elbow", "load_coulomb", 2.0),), error="exit status 2: bad | worse")
    figures = {each.name: each for each in compute_figures([one])}
    assert figures["no answer"].reached is False
    write_page([one], RunSettings(4), tmp_path / "arms-proof.md", "fricomp bench arms run")
    page = (tmp_path / "arms-proof.md").read_text()
    assert "1 arms of 4" in page
    assert "no answer: exit status 2: bad / worse" in page


@pytest.mark.slow
def test_a_run_is_sealed_scored_and_goes_on(tmp_path: Path) -> None:
    settings = RunSettings(1, salt="00")
    with open_executor("serial") as pool:
        first = run_arms(settings, tmp_path, pool, duration=12.0)
        again = run_arms(settings, tmp_path, pool, duration=12.0)
    assert first == again == read_arm_scores(tmp_path)
    assert len((tmp_path / "seals.jsonl").read_text().splitlines()) == 1
    assert not first[0].error
    assert set(first[0].errors) == {"base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3"}


def test_a_folder_without_scores_is_refused(tmp_path: Path) -> None:
    with pytest.raises(DiagnosisError, match="no scores"):
        read_arm_scores(tmp_path)

"""Cases, scores and page of the second generator: what is made of known answers."""

import json
from pathlib import Path
from typing import Any

import pytest

from fricomp.errors import DiagnosisError
from fricomp.fleet import SerialExecutor
from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from fricomp.sim_bench.studies.kit.commit import find_commit
from fricomp.sim_bench.studies.second_generator import (
    EFFECTS,
    Case,
    Score,
    choose_cases,
    compute_figures,
    list_cases,
    run,
    run_all,
    run_case,
    score_case,
    write_files,
    write_page,
)
from fricomp.sim_bench.studies.second_generator.forms import FORMS

_LAG = "velocity_filter_lag"


def _answer(verdict: str, named: dict[str, Any], **more: Any) -> BlindAnswer:
    """A diagnosis with effects, each with its parameters' intervals or with what it cannot be told from."""
    effects = []
    for name, said in named.items():
        values = said if isinstance(said, dict) else {}
        given = {key: {"value": sum(ends) / 2.0, "unit": "1", "ci95": ends} for key, ends in values.items()}
        others = [] if isinstance(said, dict) else said
        effects.append({"name": name, "kind": "physics", "parameters": given, "indistinguishable_from": others})
    record = {"schema": "fricomp.diagnosis/1", "verdict": verdict, "effects": effects} | more
    return BlindAnswer(json.dumps(record).encode(), b"", 12.0, "")


def _score(effect: str, verdict: str, named: dict[str, Any], *, velocity: bool = True, **truth: float) -> Score:
    return score_case(Case(effect, "rich", 1, velocity), truth, _answer(verdict, named))


def test_names_of_cases_are_their_own_and_every_effect_but_further_forms_is_on_both_motions() -> None:
    cases = list_cases()
    assert len({case.name for case in cases}) == len(cases)
    for name, effect in EFFECTS.items():
        motions = {case.motion for case in cases if case.effect == name and case.velocity}
        assert motions == ({"rich"} if effect in FORMS else {"rich", "fourier"})
    assert {case.duration for case in list_cases(quick=True)} == {20.0}
    assert sum(case.effect == "nothing" and case.velocity for case in cases) == 6
    assert sum(effect.group == "outside" for effect in EFFECTS.values()) >= 4


def test_another_form_of_an_effect_is_right_by_the_name_of_the_catalogue() -> None:
    score = _score("backlash_soft", "missing_physics", {"backlash": {}}, velocity=False)
    assert (score.first_right, score.false_names, score.wrong) == (True, (), False)
    assert _score("backlash_soft", "missing_physics", {"end_stop": {}}, velocity=False).false_names == ("end_stop",)
    assert all(form.group == "outside" or form.form_of in EFFECTS for form in FORMS)


def test_cases_are_chosen_by_their_name_or_their_effect() -> None:
    assert [case.name for case in choose_cases(["backlash-rich"])] == ["backlash-rich"]
    assert [case.name for case in choose_cases(["backlash"])] == ["backlash-rich", "backlash-fourier"]
    assert choose_cases([]) == list_cases()
    with pytest.raises(DiagnosisError, match=r"no case or effect 'backlas': .*backlash.*nothing-rich-1"):
        choose_cases(["backlas"])


def test_the_filter_of_a_recorded_velocity_is_right_and_without_one_it_is_a_false_name() -> None:
    assert not _score("nothing", "measurement", {_LAG: {}}).wrong
    assert not _score("nothing", "consistent", {}).wrong
    assert _score("nothing", "measurement", {}).wrong
    without = _score("nothing", "measurement", {_LAG: {}}, velocity=False)
    assert without.wrong
    assert without.false_names == (_LAG,)
    assert not _score("payload_error", "measurement", {"payload_error": {}, _LAG: {}}).wrong
    assert not _score("payload_error", "parameters", {"payload_error": {}}, velocity=False).wrong
    assert _score("payload_error", "measurement", {"payload_error": {}}, velocity=False).wrong


def test_a_name_is_right_by_itself_or_by_its_set_and_first_counts() -> None:
    right = _score("backlash", "missing_physics", {"backlash": {}, _LAG: {}})
    alias = _score("backlash", "missing_physics", {"joint_elasticity": ["backlash"]})
    late = _score("backlash", "missing_physics", {"cogging": {}, "backlash": {}})
    missed = _score("backlash", "measurement", {_LAG: {}})
    assert [one.first_right for one in (right, alias, late, missed)] == [True, True, False, False]
    assert [one.found for one in (right, alias, late, missed)] == [True, True, True, False]
    assert [one.wrong for one in (right, alias, late, missed)] == [False, False, True, True]
    assert late.false_names == ("cogging",)


def test_what_is_outside_must_be_unknown_and_what_a_simulation_says_of_friction_is_asked_for() -> None:
    assert not _score("eddy_brake", "unknown_physics", {_LAG: {}}).wrong
    assert _score("eddy_brake", "measurement", {_LAG: {}}).wrong
    assert _score("eddy_brake", "missing_physics", {"power_law_viscous": {}}).false_names == ("power_law_viscous",)
    bent = _score("eddy_brake", "unknown_physics", {"payload_error": {}})
    assert (bent.wrong, bent.false_names, bent.false_beyond_parameters) == (True, ("payload_error",), ())
    assert not _score("swinging_load", "unknown_physics", {"payload_error": {}}).wrong
    assert _score("torque_offset", "measurement", {_LAG: {}}).wrong
    assert not _score("torque_offset", "measurement", {"torque_offset": {}, _LAG: {}}).wrong
    assert _score("torque_offset", "missing_physics", {"cogging": {}}).wrong


def test_parameters_are_compared_where_they_are_known_and_have_an_interval() -> None:
    named = {"load_coulomb": {"coefficient": (0.09, 0.12), "inertia_share": (0.1, 0.2), "other": (0.0, 1.0)}}
    score = _score("load_coulomb", "missing_physics", named, coefficient=0.1, inertia_share=0.0)
    assert [(value.parameter, value.covers) for value in score.values] == [
        ("coefficient", True),
        ("inertia_share", False),
    ]
    fixed = _score("load_coulomb", "missing_physics", {"load_coulomb": {"coefficient": (0.1, 0.1)}}, coefficient=0.1)
    assert fixed.values == ()
    lag = _score("nothing", "measurement", {_LAG: {"time_constant": (2.7e-3, 3.3e-3)}})
    assert lag.values[0].covers


def test_no_answer_is_wrong_and_says_why() -> None:
    score = score_case(Case("cogging", "rich", 1), {}, BlindAnswer(b"", b"", 900.0, "no answer within 900 s"))
    assert score.verdict == "failed"
    assert score.wrong
    figures = {figure.name: figure.value for figure in compute_figures([score])}
    assert figures["no answer at all"].startswith("100.0% (1 of 1;")


def test_the_page_lists_all_cases_and_how_to_make_the_wrong_ones_again(tmp_path: Path) -> None:
    held = {"heldout": {"rmse_before": 0.2, "rmse_after": 0.01, "noise_floor": 0.009}}
    named = {"load_coulomb": {"coefficient": (0.09, 0.12)}, _LAG: {"time_constant": (2.7e-3, 3.3e-3)}}
    scores = [
        score_case(Case("load_coulomb", "rich", 1), {"coefficient": 0.1}, _answer("missing_physics", named, **held)),
        _score("nothing", "measurement", {_LAG: {}}),
        _score("backlash", "missing_physics", {"cogging": ["presliding_hysteresis"], _LAG: {}}),
    ]
    write_page(scores, tmp_path / "second_generator.md", ["4962d2c"])
    text = (tmp_path / "second_generator.md").read_text(encoding="utf-8")
    assert "| load_coulomb-rich | `missing_physics` | `load_coulomb`, `velocity_filter_lag` | yes |" in text
    assert "| 0.2 → 0.01 (0.009) | 12 |" in text
    assert "| load_coulomb-rich | coefficient | 0.1 | 0.105 (0.09 to 0.12) | yes |" in text
    assert "| right name or set first, all of the catalogue | 50.0% (1 of 2; 1.3% to 98.7%) |" in text
    assert "1 of 3 answers." in text
    assert "| backlash-rich | named `cogging`; not found | `fricomp bench second-generator --only backlash-rich" in text
    assert "95 % interval of a parameter holds the truth | 100.0% (1 of 1;" in text
    write_page([scores[1]], tmp_path / "none.md", ["4962d2c"], quick=True)
    assert (tmp_path / "none.md").read_text(encoding="utf-8").rstrip().endswith("None.")


def test_a_run_that_is_resumed_keeps_its_scores(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[set[str]] = []

    def diagnose(files: dict[str, bytes]) -> BlindAnswer:
        seen.append(set(files))
        return _answer("measurement", {_LAG: {}})

    monkeypatch.setattr(run, "diagnose_blind", diagnose)

    def go(case: Case, *, resume: bool = True) -> Score:
        (score,), commits = run_all([case], tmp_path, (SerialExecutor(), 1), resume=resume)
        assert commits == [find_commit()]
        return score

    case = Case("nothing", "fourier", 1, duration=1.0)
    first = go(case)
    assert seen == [{"recording.parquet", "joint.xml"}]
    assert go(case) == first
    go(Case("nothing", "fourier", 1, duration=1.5))  # of the same name, but another
    go(case, resume=False)
    assert len(seen) == 3


def test_the_simulation_says_nothing_of_what_is_missing(tmp_path: Path) -> None:
    for name in ("nothing", "spring_torque", "backlash"):
        write_files(Case(name, "rich", 1, duration=1.0), tmp_path / name)
    texts = {(tmp_path / name / "joint.xml").read_text() for name in ("nothing", "spring_torque", "backlash")}
    assert len(texts) == 1


@pytest.mark.slow
def test_friction_under_load_is_found_from_the_files_alone(tmp_path: Path) -> None:
    (case,) = choose_cases(["load_coulomb-rich"], quick=True)
    score = run_case(case, tmp_path)
    assert score.error == ""
    assert score.first_right
    (coefficient,) = [value for value in score.values if value.parameter == "coefficient"]
    assert coefficient.value == pytest.approx(0.1, abs=0.02)

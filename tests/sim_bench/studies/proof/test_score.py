"""What counts as right: names, sets, verdicts, places, parameters."""

import json
import math
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fricomp.errors import DiagnosisError
from fricomp.sim_bench.cases import CaseSpec
from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from fricomp.sim_bench.studies.kit.statistics import compute_share
from fricomp.sim_bench.studies.proof import PlannedCase, Score, compute_figures, compute_power, is_wrong, write_page
from fricomp.sim_bench.studies.proof.power import compute_oracle_power
from fricomp.sim_bench.studies.proof.score import compute_overlap, read_score, score_again, score_case
from tests.sim_bench.studies.proof.answering import answer


def _effect(name: str, kind: str = "physics", **fields: Any) -> dict[str, Any]:
    return {
        "name": name,
        "kind": kind,
        "form": "linear",
        "shared_form": True,
        "enr": 2.0,
        "separable_enr": 2.0,
        "localised": False,
        "accepted": [],
        "comparable": {},
    } | fields


def _truth(*effects: dict[str, Any], verdict: str = "missing_physics", **fields: Any) -> bytes:
    record = {
        "id": "case-1",
        "verdict": verdict,
        "effects": list(effects),
        "shifted_parameters": [],
        "enr": 2.0 if effects else 0.0,
        "rows": 2800,
        "location": {"time": [[1.0, 2.0]]},
        "joint": {"noise_kind": "white", "core": "lugre"},
        "spec": {"seed": 1, "excitation": "rich", "duration": 60.0, "strength": "2"},
    }
    return json.dumps(record | fields).encode()


def _score(truth: bytes, blind: BlindAnswer, group: str = "single") -> Score:
    names = tuple(each["name"] for each in json.loads(truth)["effects"])
    return score_case(PlannedCase(group, CaseSpec(1, names, "2")), truth, blind)


def test_the_right_name_is_right() -> None:
    score = _score(_truth(_effect("cogging")), answer("missing_physics", ["cogging"]))
    assert score.top_right
    assert score.exact
    assert score.in_set
    assert score.verdict_right
    assert score.false_names == 0
    assert score.set_size == 1.0
    assert not is_wrong(score)


def test_a_wrong_name_is_a_false_one() -> None:
    score = _score(_truth(_effect("cogging")), answer("missing_physics", ["backlash"]))
    assert not score.top_right
    assert not score.in_set
    assert score.false_names == 1
    assert is_wrong(score)


def test_a_wrong_name_with_the_truth_in_its_set_is_not_false() -> None:
    blind = answer("missing_physics", ["backlash"])
    said = json.loads(blind.diagnosis)
    said["effects"][0]["indistinguishable_from"] = ["cogging"]
    score = _score(_truth(_effect("cogging")), BlindAnswer(json.dumps(said).encode(), b"", 1.0, ""))
    assert not score.top_right
    assert score.in_set
    assert score.set_size == 2.0
    assert score.false_names == 0


def test_nothing_named_is_a_miss_and_no_false_name() -> None:
    score = _score(_truth(_effect("cogging")), answer("consistent"))
    assert score.false_names == 0
    assert not score.in_set
    assert is_wrong(score)


def test_a_name_where_nothing_is_missing_is_a_false_alarm() -> None:
    null = _truth(verdict="consistent")
    assert _score(null, answer("missing_physics", ["cogging"]), "null").false_names == 1
    assert not is_wrong(_score(null, answer("consistent"), "null"))


def test_refitted_parameters_are_no_false_alarm() -> None:
    hard = _truth(verdict="parameters", shifted_parameters=["inertia_error", "payload_error"])
    score = _score(hard, answer("parameters", ["inertia_error"]), "hard_null")
    assert score.false_names == 0
    assert score.verdict_right
    assert not is_wrong(score)


def test_a_pair_is_exact_only_with_both_and_nothing_else() -> None:
    pair = _truth(_effect("cogging"), _effect("load_coulomb"))
    assert _score(pair, answer("missing_physics", ["load_coulomb", "cogging"]), "pair").exact
    assert not _score(pair, answer("missing_physics", ["cogging"]), "pair").exact
    assert not _score(pair, answer("missing_physics", ["cogging", "load_coulomb", "backlash"]), "pair").exact


def test_outside_the_catalogue_unknown_is_right_and_a_name_is_not() -> None:
    outside = _truth(_effect("cable_memory", "outside"), verdict="unknown_physics")
    assert not is_wrong(_score(outside, answer("unknown_physics"), "outside"))
    named = _score(outside, answer("missing_physics", ["cogging"]), "outside")
    assert named.false_names == 1
    assert is_wrong(named)


def test_unknown_is_right_where_the_channel_that_tells_is_hidden() -> None:
    hidden = _truth(_effect("thermal_friction", accepted=["unknown_physics"]))
    assert not is_wrong(_score(hidden, answer("unknown_physics"), "hidden"))
    assert is_wrong(_score(hidden, answer("missing_physics", ["cogging"]), "hidden"))
    assert is_wrong(_score(hidden, answer("consistent"), "hidden"))


def test_one_of_two_is_a_wrong_answer() -> None:
    pair = _truth(_effect("cogging"), _effect("load_coulomb"))
    assert is_wrong(_score(pair, answer("missing_physics", ["cogging"]), "pair"))


def test_no_diagnosis_at_all_is_wrong() -> None:
    score = _score(_truth(_effect("cogging")), BlindAnswer(b"", b"", 3.0, "exit status 1"))
    assert score.verdict == "failed"
    assert is_wrong(score)


def test_a_diagnosis_of_another_schema_is_not_scored() -> None:
    with pytest.raises(DiagnosisError, match=r"fricomp\.diagnosis/1"):
        _score(_truth(), BlindAnswer(b'{"schema": "other/1"}', b"", 1.0, ""))


def test_overlap_is_intersection_over_union() -> None:
    assert compute_overlap([[0.0, 2.0]], [[1.0, 3.0]], 10.0) == pytest.approx(1.0 / 3.0, rel=1e-2)
    assert compute_overlap([[1.0, 2.0]], [[1.0, 2.0]], 10.0) == 1.0
    assert compute_overlap([], [], 10.0) == 0.0


def test_location_counts_for_localised_effects_only() -> None:
    said = answer("missing_physics", ["end_stop"], location={"time": [[1.0, 2.0]]})
    assert _score(_truth(_effect("end_stop", localised=True)), said).overlap == 1.0
    assert math.isnan(_score(_truth(_effect("end_stop")), said).overlap)
    assert _score(_truth(_effect("end_stop", localised=True)), answer("consistent")).overlap == 0.0


def test_joints_with_nothing_missing_alone_have_a_page_of_their_own(tmp_path: Path) -> None:
    nothing, something = (
        _score(_truth(verdict="consistent"), answer("consistent"), "null"),
        _score(_truth(_effect("cogging")), answer("missing_physics", ["cogging"])),
    )
    page = tmp_path / "nulls.md"
    for scores, heading in (
        ([nothing], "# False alarms on joints with nothing missing"),
        ([nothing, something], "# Proof on concealed cases"),
    ):
        write_page(scores, page, title="A test.", reproduce="fricomp bench mismatch")
        assert page.read_text().splitlines()[0] == heading


def test_an_interval_counts_where_the_parameter_can_be_compared() -> None:
    parameters = {"coefficient": {"value": 0.1, "unit": "1"}}
    blind = answer("missing_physics", ["load_coulomb"])
    said = json.loads(blind.diagnosis)
    said["effects"][0]["parameters"] = {"coefficient": {"value": 0.11, "unit": "1", "ci95": [0.09, 0.12]}}
    blind = BlindAnswer(json.dumps(said).encode(), b"", 1.0, "")
    shared = _score(_truth(_effect("load_coulomb", comparable=parameters)), blind)
    (found,) = shared.intervals
    assert found.covers
    assert found.relative_error == pytest.approx(0.1)
    assert found.error == pytest.approx(0.5)
    other = _score(_truth(_effect("load_coulomb", parameters=parameters, shared_form=False)), blind)
    assert other.intervals == ()


def test_pushes_are_compared_where_as_many_were_found() -> None:
    pushes = {name: {"value": value, "unit": "s"} for name, value in (("start_1", 2.0), ("start_2", 5.0))}
    truth, blind = _truth(_effect("external_disturbance", comparable=pushes)), answer("missing_physics", ["cogging"])
    for found, compared in (({"start_1": 5.0}, 0), ({"start_1": 2.0, "start_2": 5.1}, 2)):
        said = json.loads(blind.diagnosis)
        numbers = {name: {"value": at, "unit": "s", "ci95": [at - 0.2, at + 0.2]} for name, at in found.items()}
        said["effects"][0] |= {"name": "external_disturbance", "parameters": numbers}
        score = _score(truth, BlindAnswer(json.dumps(said).encode(), b"", 1.0, ""))
        assert [each.covers for each in score.intervals] == [True] * compared


def test_exact_intervals_agree_with_the_tables() -> None:
    none = compute_share(0, 500)
    assert none.high == pytest.approx(1.0 - 0.025 ** (1.0 / 500.0), rel=1e-9)
    some = compute_share(8, 40)
    assert (some.low, some.high) == pytest.approx((0.0905, 0.3565), abs=5e-4)
    assert str(compute_share(0, 0)) == "– (no case)"


def test_the_oracle_reaches_its_false_alarm_rate_and_full_power() -> None:
    assert compute_oracle_power(0.0, 2800) == pytest.approx(0.02 / 32)
    powers = [compute_oracle_power(enr, 2800) for enr in (0.02, 0.05, 0.1, 0.2, 0.5)]
    assert powers == sorted(powers)
    assert powers[-1] == pytest.approx(1.0)


def test_the_oracle_is_the_likelihood_ratio_test_over_windows_that_overlap() -> None:
    """Against a simulation of the test it stands for, for slow effects on correlated rows."""
    window = np.sin(np.pi * (np.arange(42) + 0.5) / 42) ** 2
    shared = window[21:] @ window[:21] / (window @ window)
    assert shared == pytest.approx(1.0 / 6.0)
    rows, enr = 400, 0.19
    place = np.arange(rows)
    columns = np.stack([np.sin(2.0 * np.pi * 3.0 * place / rows), np.cos(2.0 * np.pi * 3.0 * place / rows)], axis=1)
    factor = np.linalg.cholesky(np.eye(rows) + shared * (np.eye(rows, k=1) + np.eye(rows, k=-1)))
    basis = np.linalg.qr(np.linalg.solve(factor, columns))[0]
    noise = np.random.default_rng(1).standard_normal((20000, rows))
    whitened = noise + np.linalg.solve(factor, np.sqrt(2.0) * enr * columns[:, 0])
    statistic = np.sum((whitened @ basis) ** 2, axis=1)
    threshold = -2.0 * np.log(0.02 / 32)  # chi-squared with two degrees of freedom
    assert compute_oracle_power(enr, rows) == pytest.approx(np.mean(statistic > threshold), abs=0.015)


def test_figures_follow_the_scores() -> None:
    nulls = [_score(_truth(verdict="consistent"), answer("consistent"), "null")] * 99
    nulls.append(_score(_truth(verdict="consistent"), answer("missing_physics", ["cogging"]), "null"))
    singles = [_score(_truth(_effect("cogging")), answer("missing_physics", ["cogging"]))] * 3
    figures = {figure.name: figure for figure in compute_figures([*nulls, *singles])}
    alarms = figures["false name where nothing is missing"]
    assert alarms.value.startswith("1.0% (1 of 100")
    assert alarms.reached is False  # the upper bound is above 4 %
    assert figures["right name, rich motion, ENR ≥ 0.2"].value.startswith("100.0% (3 of 3")
    power = compute_power(singles)
    assert [point.band for point in power] == ["ENR 2 to 5"]
    assert power[0].named.hits == 3


@pytest.mark.parametrize(("verdict", "right"), [("unknown_physics", True), ("consistent", False)])
def test_what_cannot_be_named_is_right_when_it_is_called_unknown(verdict: str, right: bool) -> None:
    truth = _truth(_effect("neighbour_coupling", accepted=["unknown_physics"]))
    score = _score(truth, answer(verdict, []))
    figures = {figure.name: figure for figure in compute_figures([score])}
    unlogged = next(figure for name, figure in figures.items() if name.startswith("motion of a neighbour not logged"))
    assert unlogged.value.startswith("100.0% (1 of 1" if right else "0.0% (0 of 1")
    assert figures["right name, rich motion, ENR ≥ 0.2"].cases == ()  # it is no figure of names
    assert compute_power([score]) == []
    assert is_wrong(score) is not right


def test_a_push_that_is_called_unknown_has_no_right_name() -> None:
    score = _score(_truth(_effect("external_disturbance", accepted=["unknown_physics"])), answer("unknown_physics"))
    figures = {figure.name: figure for figure in compute_figures([score])}
    assert figures["right name, rich motion, ENR ≥ 0.2"].value.startswith("0.0% (0 of 1")
    assert is_wrong(score)


def test_a_parameter_that_the_simulation_has_right_is_a_false_name() -> None:
    null = _score(_truth(verdict="consistent"), answer("parameters", ["torque_offset"]), "null")
    assert (null.false_names, null.false_parameters) == (1, 1)
    hard = _truth(verdict="parameters", shifted_parameters=["inertia_error", "payload_error"])
    shifted = _score(hard, answer("parameters", ["inertia_error", "torque_offset"]), "hard_null")
    assert (shifted.false_names, shifted.false_parameters) == (1, 1)
    beside = _score(_truth(_effect("cogging")), answer("missing_physics", ["cogging", "payload_error"]))
    assert (beside.top_right, beside.exact, beside.false_parameters) == (True, False, 1)
    before = _score(_truth(_effect("cogging")), answer("missing_physics", ["payload_error", "cogging"]))
    assert not before.top_right


def test_both_counts_of_false_alarms_are_printed_where_they_differ() -> None:
    quiet = _score(_truth(verdict="consistent"), answer("consistent"), "null")
    offset = _score(_truth(verdict="consistent"), answer("parameters", ["torque_offset"]), "null")
    values = [
        next(f.value for f in compute_figures(scores) if f.name == "false name where nothing is missing")
        for scores in ([quiet] * 4, [quiet] * 3 + [offset])
    ]
    assert "without names of parameters" not in values[0]
    assert values[1].startswith("25.0% (1 of 4")
    assert "without names of parameters 0.0% (0 of 4" in values[1]


def _unsure(name: str, *others: str, motion: bytes = b"") -> BlindAnswer:
    said = json.loads(answer("missing_physics", [name]).diagnosis)
    said["effects"][0]["indistinguishable_from"] = list(others)
    return BlindAnswer(json.dumps(said).encode(), motion, 1.0, "")


def test_a_proposed_motion_that_could_not_be_recorded_counts() -> None:
    asked = _score(_truth(_effect("cogging")), _unsure("backlash", "cogging", motion=b"time"))
    wrong = _score(_truth(_effect("cogging")), _unsure("backlash", "end_stop"))
    assert (asked.proposed, asked.recorded, asked.resolved) == (True, False, False)
    assert (asked.printed, asked.printed_right, wrong.printed, wrong.printed_right) == (1, 1, 1, 0)
    figures = {figure.name: figure for figure in compute_figures([asked, wrong])}
    assert figures["cannot tell: every set of two or more holds a truth"].value.startswith("50.0% (1 of 2")
    assert figures["cannot tell: with a proposed motion"].value.startswith("50.0% (1 of 2")
    settled = figures["proposed motion tells the set apart"]
    assert settled.reached is False
    assert settled.value.endswith("1 of them could not be recorded and count as no")


def test_coverage_is_kept_for_each_effect_of_a_pair() -> None:
    interval = {"value": 1.0, "ci95": [0.9, 1.1]}
    said = json.loads(answer("missing_physics", ["cogging", "drive_lag"]).diagnosis)
    for each, name in zip(said["effects"], ("sine", "time_constant"), strict=True):
        each["parameters"] = {name: interval}
    truth = _truth(
        _effect("cogging", comparable={"sine": {"value": 1.0}}),
        _effect("drive_lag", comparable={"time_constant": {"value": 2.0}}),
    )
    score = _score(truth, BlindAnswer(json.dumps(said).encode(), b"", 1.0, ""), "pair")
    assert [(each.effect, each.covers) for each in score.intervals] == [("cogging", True), ("drive_lag", False)]
    figures = {figure.name: figure.value for figure in compute_figures([score])}
    assert figures["95 % interval of an effect's parameter holds the truth"].startswith("50.0% (1 of 2 in 1 cases")
    assert figures["intervals that miss the truth by more than 2 half widths"].startswith("50.0% (1 of 2;")
    assert figures["answers with a right name of which a parameter is compared"].startswith("100.0% (1 of 1;")


def _joint(**fields: float) -> dict[str, Any]:
    return {"noise_kind": "white", "core": "lugre", "inertia": 0.2, "gravity": 3.0, "gravity_angle": 0.1} | fields


def _change(name: str, value: float, half: float) -> dict[str, Any]:
    return {"name": name, "given": 0.0, "refitted": {"value": value, "unit": "", "ci95": [value - half, value + half]}}


def test_inertia_and_gravity_of_a_shifted_simulation_are_compared_where_they_are_found_to_be_off() -> None:
    truth = _truth(verdict="parameters", shifted_parameters=["inertia_error", "payload_error"], joint=_joint())
    changes = [_change("inertia", 0.2001, 1e-3), _change("gravity_sin", 3.0 * math.cos(0.1), 1e-3)]
    changes += [_change("gravity_cos", 0.0, 1e-3), _change("forward.coulomb_torque", 1.0, 0.1)]
    found = _score(truth, answer("parameters", ["payload_error"], changes=changes), "hard_null")
    assert [(each.effect, each.covers) for each in found.intervals] == [
        ("simulation", True),
        ("simulation", True),
        ("simulation", False),
    ]
    figures = {figure.name: figure.value for figure in compute_figures([found])}
    assert figures["the same, inertia and gravity of the simulation"].startswith("66.7% (2 of 3 in 1 cases")
    assert figures["95 % interval of an effect's parameter holds the truth"] == "– (no case)"
    assert figures["answers with a right name of which a parameter is compared"] == "– (no case)"
    silent = _score(truth, answer("consistent", [], changes=changes), "hard_null")
    assert silent.intervals == ()


def test_an_answer_is_scored_again_by_the_rules_of_today() -> None:
    truth, said = _truth(_effect("cogging")), answer("missing_physics", ["cogging"])
    score = _score(truth, said)
    stale = replace(score, top_right=False, false_names=3, seconds=7.0, resolved=True)
    assert str(score_again(asdict(stale), truth, said.diagnosis)) == str(replace(score, seconds=7.0))


@pytest.mark.parametrize(
    ("second", "resolved"),
    [
        (["load_coulomb"], True),
        (["load_coulomb", "drive_lag"], True),
        (["torque_gain_error"], False),
        (["drive_lag"], False),  # of the set nothing is left
        ([], False),
    ],
)
def test_a_motion_settles_a_set_when_nothing_but_the_truth_is_left_of_it(second: list[str], resolved: bool) -> None:
    truth = _truth(_effect("load_coulomb"), _effect("drive_lag"))
    first = json.loads(answer("missing_physics", ["drive_lag", "load_coulomb"]).diagnosis)
    first["effects"][1]["indistinguishable_from"] = ["torque_gain_error"]
    planned = PlannedCase("pair", CaseSpec(1, ("load_coulomb", "drive_lag"), "2"))
    blind = BlindAnswer(json.dumps(first).encode(), b"time", 1.0, "")
    assert score_case(planned, truth, blind, answer("missing_physics", second)).resolved is resolved
    assert not score_case(planned, truth, blind, _unsure("load_coulomb", "torque_gain_error")).resolved


def test_a_score_comes_back_from_its_row_as_it_was() -> None:
    named = {"coefficient": {"value": 0.1, "unit": "1", "ci95": [0.05, 0.2]}}
    said = json.loads(answer("missing_physics", ["load_coulomb"]).diagnosis)
    said["effects"][0]["parameters"] = named
    truth = _truth(_effect("load_coulomb", comparable={"coefficient": {"value": 0.12, "unit": "1"}}, localised=True))
    score = _score(truth, BlindAnswer(json.dumps(said).encode(), b"", 1.0, ""))
    assert score.intervals
    assert str(read_score(json.loads(json.dumps(asdict(score))))) == str(score)  # not all numbers equal themselves

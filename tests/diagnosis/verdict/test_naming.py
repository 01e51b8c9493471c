"""What is named of the evidence, by which share, and how a spring is told."""

from __future__ import annotations

import pytest

from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence.comparison import Comparison, Shift
from fricomp.diagnosis.evidence.effect_evidence import EffectEvidence
from fricomp.diagnosis.evidence.overtone import Overtone
from fricomp.diagnosis.evidence.trial import Trial
from fricomp.diagnosis.inputs.rigid import Spring
from fricomp.diagnosis.record.result import NamedEffect, Quantity
from fricomp.diagnosis.verdict.naming import SpringWords, compare_spring, describe_spring, name_effects

from ..known import known_baseline, known_case, known_findings, known_fit

_LOAD = Shift("payload_error", {}, "the load is not the simulation's", alike=("torque_gain_error",))
_OFFSET = Shift("torque_offset", {"offset": Quantity(0.1, "N·m", (0.0, 0.2))}, "a constant torque is missing")
_GAIN = Shift("torque_gain_error", {}, "the recorded torque is scaled", "measurement")


def _measure(name: str, energy: float, overtone: Overtone | None = None) -> EffectEvidence:
    return EffectEvidence(EFFECTS[name], {}, energy, {"time": [(0.0, energy)]}, (), overtone)


def test_inertia_and_gravity_alone_are_told_beside_effects_that_explain_as_much() -> None:
    baseline = known_baseline()
    case = known_case(baseline, instead=("frictional_lag",))
    findings = known_findings(baseline, case, comparison=Comparison((_LOAD, _OFFSET)), parts=(0.25, 0.75))
    named = name_effects(findings, 0.8)
    assert [one.name for one in named] == ["torque_offset", "payload_error"]  # the larger share first
    assert [one.share for one in named] == pytest.approx([0.6, 0.2])
    assert [one.indistinguishable_from for one in named] == [(), ("torque_gain_error", "frictional_lag")]


@pytest.mark.parametrize(
    ("shares", "named"),
    [
        ({"inertia_error": 0.7, "payload_error": 0.3}, ["payload_error"]),
        ({"torque_offset": 1.0}, []),
        ({"inertia_error": 0.1}, []),
    ],
)
def test_inertia_or_gravity_comes_again_under_any_name(shares: dict[str, float], named: list[str]) -> None:
    """An inertia 18 % too large had no name, and nothing was missing, where parts named another one than the whole."""
    findings = known_findings(known_baseline(), comparison=Comparison((_LOAD,)), shift_shares=shares)
    assert [one.name for one in name_effects(findings, 0.0)] == named


def test_nothing_is_named_of_parameters_that_something_unknown_biases() -> None:
    assert name_effects(known_findings(known_baseline(), unknown=True, comparison=Comparison((_LOAD,))), 0.0) == ()


def test_chosen_effects_share_what_is_explained_by_their_energy() -> None:
    effects = (_measure("cogging", 3.0), _measure("load_coulomb", 1.0))
    named = name_effects(known_findings(known_baseline(), effects=effects), 0.8)
    assert [(one.name, one.kind) for one in named] == [("cogging", "physics"), ("load_coulomb", "physics")]
    assert [one.share for one in named] == pytest.approx([0.6, 0.2])
    assert named[0].location == {"time": [(0.0, 3.0)]}


def test_an_overtone_belongs_to_the_stronger_ripple_and_counts_for_it() -> None:
    effects = (_measure("cogging", 3.0), _measure("kinematic_error", 1.0, Overtone("cogging", 36.0)))
    (named,) = name_effects(known_findings(known_baseline(), effects=effects), 0.8)
    assert named.share == pytest.approx(0.8)
    assert named.indistinguishable_from == ("kinematic_error",)
    assert named.sentence.endswith("its form shows at the order 36 too")


def test_a_payload_that_the_search_and_the_comparison_name_is_named_once() -> None:
    effects = (_measure("payload_error", 1.0),)
    (named,) = name_effects(known_findings(known_baseline(), effects=effects, comparison=Comparison((_LOAD,))), 0.8)
    assert named.sentence.endswith("; the load is not the simulation's")
    assert named.share == pytest.approx(0.8)


def test_beside_an_effect_that_scales_the_torque_no_gain_is_named() -> None:
    baseline, heating = known_baseline(), (_measure("torque_constant_heating", 1.0),)
    named = name_effects(known_findings(baseline, effects=heating, comparison=Comparison((_GAIN, _OFFSET))), 0.8)
    assert [one.name for one in named] == ["torque_constant_heating", "torque_offset"]
    alone = name_effects(known_findings(baseline, comparison=Comparison((_GAIN,))), 0.0)
    assert [one.name for one in alone] == ["torque_gain_error"]


def test_a_late_velocity_is_named_beside_anything() -> None:
    lag = Shift("velocity_filter_lag", {}, "it lags", "measurement", equation="v = q'", citation="hollerbach2016")
    (named,) = name_effects(known_findings(known_baseline(), unknown=True, lag=lag), 0.0)
    assert (named.name, named.kind, named.share, named.citation) == (lag.name, "measurement", 0.0, "hollerbach2016")


def _named(change: float, half: float, hardening: tuple[float, float] = (-0.01, 0.01)) -> SpringWords:
    parameters = {
        "stiffness": Quantity(change, "N·m/rad", (change - half, change + half)),
        "centre": Quantity(0.1, "rad", (0.0, 0.2)),
        "hardening": Quantity(sum(hardening) / 2, "1/rad²", hardening),
    }
    return SpringWords("physics", parameters, "a spring pulls the joint", "tau = k (q - q_0)")


@pytest.mark.parametrize(("change", "words"), [(-1.96, "does not show"), (1.0, "3 N·m/rad")])
def test_another_spring_than_the_simulation_s_is_a_parameter(change: float, words: str) -> None:
    given = Spring((2.0,))
    found = describe_spring(_named(change, 0.2), given)
    assert found.kind == "parameter"
    assert words in found.sentence
    assert found.parameters["stiffness_change"].value == change
    effect = NamedEffect(name="spring_torque", kind="parameter", parameters=found.parameters)
    (moved,) = compare_spring([effect], given)
    assert moved.given == 2.0
    assert moved.refitted.value == pytest.approx(2.0 + change)


def test_a_spring_beside_a_simulation_without_one_and_one_that_stiffens_are_physics() -> None:
    assert describe_spring(_named(1.5, 0.1), None).kind == "physics"
    assert compare_spring([], None) == ()
    assert describe_spring(_named(1.5, 0.1, (0.2, 0.4)), Spring((2.0,))).kind == "physics"


def test_the_centre_of_a_straight_spring_is_no_number_and_that_of_one_that_stiffens_is() -> None:
    straight = describe_spring(_named(1.5, 0.1), None)
    assert set(straight.parameters) == {"stiffness", "hardening"}
    assert "centre is not determined" in straight.sentence
    stiffens = _named(1.5, 0.1, (0.2, 0.4))
    assert describe_spring(stiffens, None) == stiffens
    assert "centre" not in describe_spring(_named(-1.5, 0.1), Spring((2.0,))).parameters


def test_a_constant_torque_beside_a_spring_is_its_centre_and_not_named() -> None:
    numbers = {name: Quantity(1.0, "1", (0.9, 1.1)) for name in ("stiffness", "centre", "hardening")}
    spring = EffectEvidence(EFFECTS["spring_torque"], numbers, 1.0, {}, (), None)
    named = name_effects(known_findings(known_baseline(), effects=(spring,), comparison=Comparison((_OFFSET,))), 0.8)
    assert [one.name for one in named] == ["spring_torque"]


@pytest.mark.parametrize(("split", "unit"), [(0.0, "1/N·m"), (1.0, "N·m/N·m"), (2.0, "N·m/N·m")])
def test_of_two_forms_that_which_was_found_is_printed_with_its_own_number(split: float, unit: str) -> None:
    """The forms of driving and braking are fitted in the joint's usual load, which no equation has."""
    baseline = known_baseline()
    chosen = known_fit(baseline, ["load_quadratic"], 100.0)
    load = 1.0 if split == 0.0 else chosen.structure.contexts[0].usual_load
    numbers = {"coefficient": Quantity(0.02, "1/N·m", (0.01, 0.03)), "split": Quantity(split, "1", (split, split))}
    found = EffectEvidence(EFFECTS["load_quadratic"], numbers, 1.0, {}, (), None)
    (named,) = name_effects(known_findings(baseline, effects=(found,), trial=Trial(chosen=chosen)), 0.8)
    (only,) = named.parameters.values()
    assert (only.value, *only.ci95) == pytest.approx((0.02 * load, 0.01 * load, 0.03 * load))
    assert only.unit == unit
    assert ("[tau_l v > 0]" in named.equation, "[tau_l v < 0]" in named.equation) == (split == 1.0, split == 2.0)
    assert " or " not in named.equation

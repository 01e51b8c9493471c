"""The verdict is a function of the evidence, and the record says what the verdict rests on."""

from __future__ import annotations

import pytest

from fricomp.diagnosis.delivery.models import Delivery
from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence.comparison import Comparison, Shift
from fricomp.diagnosis.evidence.effect_evidence import EffectEvidence
from fricomp.diagnosis.evidence.trial import Trial
from fricomp.diagnosis.inputs.given import Given
from fricomp.diagnosis.record.file_errors import FileErrors, ModelErrors
from fricomp.diagnosis.record.result import Forward, Kind, NamedEffect, Quantity, VerdictName
from fricomp.diagnosis.record.sentence import NO_MOTION, NOTHING_BUT_SHARED
from fricomp.diagnosis.verdict.delivering import WORSE, leave_out_worse, list_beyond_law
from fricomp.diagnosis.verdict.experiment import Proposal
from fricomp.diagnosis.verdict.judging import choose_verdict, join_channels, judge
from fricomp.diagnosis.verdict.shared_effect import SimulationEffects
from fricomp.diagnosis.verdict.writing import write_diagnosis, write_refusal
from fricomp.evaluation.result import TorqueError
from fricomp.laws import Coulomb, FrictionLaw
from fricomp.model import FrictionModel

from ..known import known_baseline, known_case, known_findings, known_fit, known_search

_FORWARD = Forward(rmse_before=0.2, rmse_after=0.1, unit="rad", controller="a PD loop", interval=(1.0, 2.0))


@pytest.mark.parametrize(
    ("kinds", "known", "beside_unknown"),
    [
        ((), "consistent", "unknown_physics"),
        (("parameter",), "parameters", "unknown_physics"),
        (("parameter", "measurement"), "measurement", "unknown_physics"),
        (("measurement", "physics"), "missing_physics", "missing_physics"),
    ],
)
def test_the_gravest_effect_gives_the_verdict(
    kinds: tuple[Kind, ...], known: VerdictName, beside_unknown: VerdictName
) -> None:
    assert (choose_verdict(kinds), choose_verdict(kinds, unknown=True)) == (known, beside_unknown)


def test_rivals_say_what_speaks_against_them() -> None:
    baseline = known_baseline()
    chosen, failed = (known_fit(baseline, (name,), 400.0) for name in ("cogging", "end_stop"))
    others = (
        known_fit(baseline, ("backlash",), 300.0, refused="it would push"),
        known_fit(baseline, ("load_coulomb",), 20.0),
    )
    case = known_case(baseline, known_search(chosen, failed, *others))
    trial = Trial(chosen=chosen)
    assert [one.refused for one in judge(known_findings(baseline, case, trial=trial)).rivals] == [
        "",
        "another explanation is better or simpler",
        "it would push",
        "does not exceed what a recording with nothing missing gives",
    ]
    refused = judge(known_findings(baseline, case, trial=Trial(failed=failed))).rivals
    assert refused[0].refused == "leaves too much unexplained"
    assert refused[1].refused == "does not make the held-out error fall for sure"


def test_errors_are_those_of_the_base_as_given_where_only_parameters_are_off() -> None:
    shift = Shift("payload_error", {}, "the load is not the simulation's")
    verdict = judge(known_findings(known_baseline(), comparison=Comparison((shift,)), parts=(1.0,)))
    assert (verdict.word, verdict.held.before) == ("parameters", "given")


def test_sentences_stand_in_one_order_and_remarks_come_last() -> None:
    effect = EffectEvidence(EFFECTS["cogging"], {}, 1.0, {}, ("kinematic_error",))
    baseline = known_baseline()
    trial = Trial(chosen=known_fit(baseline, ("cogging",), 50.0))
    findings = known_findings(baseline, trial=trial, effects=(effect,))
    record = write_diagnosis(findings, judge(findings), None, forward=_FORWARD, remarks=("noticed",)).record
    assert record.sentences[0].startswith("This recording shows physics")
    assert record.sentences[-3] == NO_MOTION
    assert record.sentences[-2].startswith("Simulated forward in MuJoCo")
    assert record.sentences[-1] == "noticed"
    proposal = Proposal({}, "a sine", ("cogging", "kinematic_error"), 0.1)
    proposed = write_diagnosis(findings, judge(findings), None, proposal).record
    assert NO_MOTION not in proposed.sentences
    assert proposed.next_experiment is not None


def test_what_the_simulation_shows_as_well_is_not_missing() -> None:
    effect = EffectEvidence(EFFECTS["cogging"], {}, 1.0, {}, ("kinematic_error",))
    baseline = known_baseline()
    trial = Trial(chosen=known_fit(baseline, ("cogging",), 50.0))
    findings = known_findings(baseline, trial=trial, effects=(effect,))
    own = SimulationEffects((NamedEffect(name="cogging", kind="physics", parameters={}),), remarks=("last",))
    record = write_diagnosis(findings, judge(findings, simulated=own), None, remarks=("noticed",)).record
    assert (record.verdict, record.effects) == ("consistent", ())
    assert record.sentences[0] == NOTHING_BUT_SHARED
    assert NO_MOTION not in record.sentences
    assert record.sentences[-3:] == (
        "noticed",
        "The simulation shows cogging as well, so this is not missing in it.",
        "last",
    )


def test_data_that_cannot_be_diagnosed_say_why() -> None:
    given = Given(known_case(known_baseline()).recordings, ("elbow_cold",))
    record = write_refusal(given, ["it stands still"], ["beside"]).record
    assert record.recordings == ("elbow_cold",)
    assert record.verdict == "bad_data"
    assert record.sentences == ("The data cannot be diagnosed.", "it stands still", "beside")


def _read_off(name: str, kind: Kind) -> NamedEffect:
    return NamedEffect(name=name, kind=kind, parameters={})


def test_what_two_channels_show_is_named_beside_the_rows_and_once() -> None:
    late, bend = _read_off("torque_delay", "measurement"), _read_off("torque_saturation", "physics")
    plain = judge(known_findings(known_baseline()))
    assert join_channels(plain, ()) == plain
    both = join_channels(plain, (late, bend))
    assert [one.name for one in both.effects] == [
        *(one.name for one in plain.effects),
        "torque_delay",
        "torque_saturation",
    ]
    assert (join_channels(plain, (late,)).word, both.word) == ("measurement", "missing_physics")
    assert both.read_off == ("torque_delay", "torque_saturation")
    again = join_channels(both, (_read_off("drive_lag", "measurement"),))
    assert again == both


def test_names_that_were_read_off_in_turn_are_all_known_as_such() -> None:
    """A delay of the rows had lost its certainty where a channel showed something besides."""
    late = join_channels(judge(known_findings(known_baseline())), (_read_off("torque_delay", "measurement"),))
    assert join_channels(late, (_read_off("end_stop", "physics"),)).read_off == ("torque_delay", "end_stop")


def test_something_unknown_stays_so_beside_a_late_drive() -> None:
    unknown = judge(known_findings(known_baseline(), unknown=True))
    assert join_channels(unknown, (_read_off("drive_lag", "measurement"),)).word == "unknown_physics"


@pytest.mark.parametrize(("after", "left"), [(1.05, None), (1.5, ("torque_delay",))])
def test_a_name_goes_with_which_the_written_model_does_worse_on_data_left_out(
    after: float, left: tuple[str, ...] | None
) -> None:
    """A drive behind a slow bus had an uneven gear of which its own line said that it was no better than none."""
    baseline = known_baseline()
    chosen, rival = known_fit(baseline, ("kinematic_error",), 53.0), known_fit(baseline, ("torque_delay",), 40.0)
    case = known_case(baseline, known_search(chosen, rival))
    findings = known_findings(baseline, case, trial=Trial(chosen=chosen))
    before, behind, file = (
        ModelErrors(torque=TorqueError(rms, (rms, rms), rms, 2.0, "N·m", 20.0, 30.0)) for rms in (1.0, after, 0.9)
    )
    base = FrictionModel(FrictionLaw((Coulomb(1.0),)))
    delivery = Delivery(base, base, FileErrors(before=before, after=behind, file=file, folds=5))
    without = leave_out_worse(findings, judge(findings), delivery)
    assert (None if without is None else without.best and without.best.names) == left
    if without is not None:
        assert [one.refused for one in without.explanations] == ["", WORSE]


@pytest.mark.parametrize(("low", "kept"), [(0.5, True), (0.0, False)])
def test_a_name_stays_where_the_written_model_is_worse_for_what_it_has_no_place_for(low: float, kept: bool) -> None:
    """What moves with a stop is heavy, and no law has its inertia."""
    baseline = known_baseline()
    chosen = known_fit(baseline, ("end_stop",), 900.0)
    case = known_case(baseline, known_search(chosen))
    findings = known_findings(baseline, case, trial=Trial(chosen=chosen))
    heavy = NamedEffect(name="end_stop", kind="physics", parameters={"inertia": Quantity(0.8, "kg·m²", (low, 1.0))})
    verdict = join_channels(judge(findings), (heavy,))
    before, behind = (
        ModelErrors(torque=TorqueError(rms, (rms, rms), rms, 2.0, "N·m", 20.0, 30.0)) for rms in (1.0, 1.5)
    )
    base = FrictionModel(FrictionLaw((Coulomb(1.0),)))
    delivery = Delivery(base, base, FileErrors(before=before, after=behind, file=behind, folds=5))
    assert (leave_out_worse(findings, verdict, delivery) is None) is kept
    assert list_beyond_law(verdict) == (["inertia of end_stop"] if kept else [])

"""Whether the samples or the rows give the verdict, and what each verdict then holds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence.comparison import Comparison, Shift
from fricomp.diagnosis.evidence.confirmation import Confirmation
from fricomp.diagnosis.evidence.effect_evidence import EffectEvidence
from fricomp.diagnosis.evidence.findings import Findings
from fricomp.diagnosis.record.result import Change, HeldOut, Quantity, Rival
from fricomp.diagnosis.samples.fine_ripple import Harmonic
from fricomp.diagnosis.samples.sample_finding import SampleFinding
from fricomp.diagnosis.verdict.judging import Verdict, judge, judge_beside
from fricomp.diagnosis.verdict.settings import VERDICT

from ..known import known_baseline, known_case, known_findings, known_fit, known_search

HELD = HeldOut(rmse_before=2.0, rmse_after=1.0, noise_floor=0.5, unit="N·m", ci95_reduction=(0.4, 0.6), explained=0.8)
COARSE_ORDER, COARSE_AMPLITUDE = 10.0, 0.1
CHANGE = Change(name="inertia", given=1.0, refitted=Quantity(1.2, "kg·m²", (1.1, 1.3)))
SHIFT = Shift("payload_error", {}, "the load is not the simulation's")


def exactly(value: float) -> Quantity:
    return Quantity(value, "1", (value, value))


def rows(*, ripple: bool = True, aliases: tuple[str, ...] = (), **more: Any) -> Findings:
    """Findings whose rows show cogging, as a ripple of known order and amplitude."""
    waves = {"order": COARSE_ORDER, "sine": 0.6 * COARSE_AMPLITUDE, "cosine": 0.8 * COARSE_AMPLITUDE}
    effect = EffectEvidence(EFFECTS["cogging"], {n: exactly(v) for n, v in waves.items()}, 1.0, {}, aliases)
    held = Confirmation(4.0, 3.0, 2.0, (0.1, 0.3), 0.7)
    plain = known_findings(known_baseline(), effects=(effect,) if ripple else (), held=held, noise_ratio=7.0)
    return replace(plain, **more)


def sample(name: str = "cogging", ripple: tuple[float, float] | None = None, **more: Any) -> SampleFinding:
    """What samples show, with errors that are known."""
    plain = SampleFinding(name, EFFECTS[name].kind, {}, "its equation", "its sentence", HELD, (), ripple=ripple)
    return replace(plain, **more)


def names(verdict: Verdict) -> list[str]:
    return [effect.name for effect in verdict.effects]


@pytest.mark.parametrize(
    ("order", "amplitude", "is_named"), [(1.01, 1.01, True), (1.01, 1.0, False), (1.0, 1.01, False), (1.0, 1.0, False)]
)
def test_a_ripple_of_the_samples_is_named_where_it_is_both_finer_and_larger(
    order: float, amplitude: float, is_named: bool
) -> None:
    finer = (order * VERDICT.other_order * COARSE_ORDER, amplitude * VERDICT.larger * COARSE_AMPLITUDE)
    found = sample(ripple=finer)
    assert (judge(rows(), found).sample is found) is is_named
    assert judge(rows(ripple=False), found).sample is found, "the rows show no ripple to compare it with"
    assert judge(rows(), sample("presliding_hysteresis")).sample is not None, "what is no ripple needs no comparison"
    assert judge(rows()).sample is None


def test_a_verdict_of_the_samples_counts_the_error_of_the_samples() -> None:
    rivals = (Rival(effects=("cogging",), gain=1.0),)
    verdict = judge(rows(), sample("presliding_hysteresis", rivals=rivals))
    assert verdict.word == "missing_physics"
    assert verdict.held is HELD
    assert (verdict.noise_ratio, verdict.coverage, verdict.undecided, verdict.location) == (4.0, 0.8, False, {})
    assert verdict.rivals == rivals
    assert judge(rows(), sample("presliding_hysteresis")).rivals != ()
    assert names(verdict) == ["presliding_hysteresis"], "what the rows named has a share in another error"


def test_what_differs_from_the_simulation_stays_beside_the_samples_unless_the_joint_obeys_no_law() -> None:
    findings = rows(comparison=Comparison((SHIFT,), changes=(CHANGE,)))
    beside = judge(findings, sample("presliding_hysteresis"))
    assert (names(beside), beside.changes) == (["presliding_hysteresis", "payload_error"], (CHANGE,))
    lawless = judge(findings, sample("drive_lag", lawless=True))
    assert (lawless.word, names(lawless), lawless.changes) == ("measurement", ["drive_lag"], ())
    as_given = judge(replace(findings, effects=(), parts=(1.0,)), sample("presliding_hysteresis"))
    assert names(as_given) == ["presliding_hysteresis", "payload_error"], (
        "counted from the refitted base, it has no share"
    )


def test_a_verdict_of_the_rows_counts_the_error_of_the_rows() -> None:
    verdict = judge(rows(comparison=Comparison(changes=(CHANGE,)), location={"position": [(0.1, 0.2)]}))
    held = verdict.held
    assert (held.rmse_before, held.rmse_after, held.noise_floor, held.explained) == (4.0, 3.0, 2.0, 0.7)
    assert (held.ci95_reduction, held.before) == ((0.1, 0.3), "refitted")
    assert (verdict.noise_ratio, verdict.coverage, verdict.changes) == (7.0, None, (CHANGE,))
    assert verdict.location == {"position": [(0.1, 0.2)]}
    best = known_fit(known_baseline(), ("cogging",), 50.0)
    case = known_case(known_baseline(), known_search(best))
    assert judge(rows(case=case)).coverage == best.coverage


def test_it_is_undecided_where_an_effect_of_the_search_has_an_alias() -> None:
    assert judge(rows(aliases=("kinematic_error",))).undecided
    assert not judge(rows()).undecided
    moved = replace(SHIFT, alike=("inertia_error",))
    assert not judge(rows(comparison=Comparison((moved,)))).undecided, "a parameter with an alias is decided"


def test_a_ripple_of_the_samples_stands_beside_what_the_rows_show_without_it() -> None:
    load = EffectEvidence(EFFECTS["load_coulomb"], {"coefficient": exactly(0.3)}, 1.0, {}, ("load_quadratic",))
    beside = rows(effects=(load,), comparison=Comparison((SHIFT,), changes=(CHANGE,)))
    found = sample(ripple=(700.0, 0.5))
    verdict = judge_beside(beside, found)
    assert names(verdict) == ["cogging", "load_coulomb", "payload_error"]
    assert (verdict.word, verdict.held, verdict.sample, verdict.changes) == ("missing_physics", HELD, found, (CHANGE,))
    assert verdict.undecided, "the load has an alias"
    shares = {one.name: one.share for one in verdict.effects}
    assert shares["cogging"] == HELD.explained
    assert shares["load_coulomb"] == pytest.approx((1.0 - HELD.explained) * 0.7)
    assert names(judge_beside(rows(), found)) == ["cogging"], "one effect is named once"


@pytest.mark.parametrize(("order", "named"), [(1.0, False), (1.02, False), (1.2, True)])
def test_a_ripple_of_an_order_that_the_samples_show_is_named_once(order: float, named: bool) -> None:
    waves = {"order": order * COARSE_ORDER, "sine": 0.2, "cosine": 0.5}
    effect = EffectEvidence(EFFECTS["torque_ripple"], {n: exactly(v) for n, v in waves.items()}, 1.0, {}, ())
    ripple = (
        Harmonic(3.0 * COARSE_ORDER, False, 0.1, 0.0, 0.01, 0.01),
        Harmonic(COARSE_ORDER, False, 0.1, 0.0, 0.01, 0.01),
    )
    found = sample("cogging", waves=(ripple,))
    assert names(judge_beside(rows(effects=(effect,)), found)) == ["cogging", "torque_ripple"][: 1 + named]

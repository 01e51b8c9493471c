"""The second look names what the base cannot show, and leaves a good answer and a base at its noise alone."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from fricomp.diagnosis import Quantity
from fricomp.diagnosis.effects import EFFECTS
from fricomp.diagnosis.evidence.comparison import Comparison, Shift
from fricomp.diagnosis.evidence.confirmation import Confirmation
from fricomp.diagnosis.evidence.effect_evidence import EffectEvidence
from fricomp.diagnosis.evidence.findings import Findings
from fricomp.diagnosis.evidence.trial import Trial
from fricomp.diagnosis.samples import second_look
from fricomp.diagnosis.samples.fine_ripple import find_fine_ripple
from fricomp.diagnosis.samples.proving import is_beyond_the_base, is_softer_than_the_base, simulate_base
from fricomp.diagnosis.samples.second_look import look_into_samples, remove_ripple
from fricomp.diagnosis.samples.soft_presliding import find_soft_presliding, simulate_bristle
from fricomp.diagnosis.verdict.judging import judge
from fricomp.laws import BidirectionalStribeck, Cogging, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel
from fricomp.recording import Recording, RecordingMetadata

from ..known import known_baseline, known_case, known_findings, known_fit, known_search
from ..toy_joint import ToyJoint, record


def _base(inertia: float, sides: tuple[float, float, float, float], breakaway: float) -> dict[str, Quantity]:
    """A base without gravity, the same in both directions."""
    curve = dict(zip(("coulomb_torque", "excess", "stribeck_velocity", "viscous_coefficient"), sides, strict=True))
    values = {"inertia": inertia, "gravity_cos": 0.0, "gravity_sin": 0.0, "offset": 0.1, "breakaway": breakaway}
    values |= {f"{side}.{name}": value for side in ("forward", "reverse") for name, value in curve.items()}
    return {name: Quantity(value, "", (value, value)) for name, value in values.items()}


_BASELINE = known_baseline()
_WAVE = {"order": 100.0, "sine": 0.1, "cosine": 0.0}
_SLOW = _base(0.02, (9.0, 4.0, 0.05, 10.0), 9e-5)


def _remembering(call: Callable[..., Any]) -> Callable[..., Any]:
    """The same function, which gives what it gave before for the same objects; it keeps these, so that none is new."""
    known: dict[tuple[int, ...], tuple[tuple[Any, ...], Any]] = {}

    def called(*arguments: Any) -> Any:
        key = tuple(map(id, arguments))
        if key not in known:
            known[key] = arguments, call(*arguments)
        return known[key][1]

    return called


_find_ripple, _is_beyond = _remembering(find_fine_ripple), _remembering(is_beyond_the_base)
_find_bristle, _is_softer = _remembering(find_soft_presliding), _remembering(is_softer_than_the_base)


@pytest.fixture(autouse=True, scope="module")
def found_once() -> Iterator[None]:
    """What is found in the samples depends on the arguments alone: each is looked at once for all tests here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(second_look, "find_fine_ripple", _find_ripple)
        patch.setattr(second_look, "is_beyond_the_base", _is_beyond)
        patch.setattr(second_look, "find_soft_presliding", _find_bristle)
        patch.setattr(second_look, "is_softer_than_the_base", _is_softer)
        yield


@cache
def _waving(ripple: float) -> Recording:
    """A slow joint whose speed waves along the way, through the falling part of its Stribeck curve."""
    t = np.arange(8000) / 1000.0
    speed = np.where(t < 2.0, 0.25, 0.06) * (1.0 + 0.5 * np.sin(2.0 * np.pi * 8.0 * t))
    q = np.round(np.cumsum(speed) / 1000.0 / 1.2e-5) * 1.2e-5
    noise = 0.05 * np.random.default_rng(1).standard_normal(t.size)
    recording = simulate_base(Recording(time=t, position=q, torque=noise), _SLOW, 7)
    return replace(recording, torque=recording.torque + ripple * np.sin(700.0 * q))


@cache
def _braked() -> Recording:
    """A band brake with a bristle of 9 kN that gives way over 4 mm."""
    t = np.arange(7000) / 1000.0
    q = 0.025 * np.sin(6.3 * t) * (1.0 + 0.2 * np.sin(1.1 * t))
    force = 9000.0 * simulate_bristle(q, 0.004) + 4000.0 * np.gradient(q, t) + 200.0
    force = force + 50.0 * np.random.default_rng(2).standard_normal(t.size)
    return Recording(time=t, position=q, torque=force, metadata=RecordingMetadata(motion="linear", torque_unit="N"))


_BRAKE = _base(1.0, (9000.0, 500.0, 0.02, 4000.0), 5e-6)


def _findings(recording: Recording, explained: float | None, base: dict[str, Quantity], **more: Any) -> Findings:
    """What the rows show; `explained` is by a named measurement, None where nothing was named."""
    baseline = _BASELINE
    case = known_case(baseline, recordings=(recording,))
    held = Confirmation(900.0, 60.0 if explained else 900.0, 50.0, (0.0, 0.0), explained or 0.0)
    named = EffectEvidence(EFFECTS["encoder_eccentricity"], {}, 1.0, {}, ())
    chosen = known_fit(baseline, ("encoder_eccentricity",), 100.0)
    if explained is not None:
        more = {"trial": Trial(chosen=chosen, held=held), "effects": (named,)} | more
    return known_findings(baseline, case, base=base, held=held, **more)


def test_a_bristle_is_found_where_something_unknown_was_left() -> None:
    findings = _findings(_braked(), None, _BRAKE, unknown=True)
    found = look_into_samples(findings)
    assert found is not None
    verdict = judge(findings, found)
    assert verdict.word == "missing_physics"
    assert [effect.name for effect in verdict.effects] == ["presliding_hysteresis"]


@pytest.mark.parametrize("explained", [0.99, None])
def test_a_good_answer_and_a_base_at_its_noise_are_kept(explained: float | None) -> None:
    findings = _findings(_braked(), explained, _BRAKE)
    assert look_into_samples(findings) is None


def test_an_effect_whose_torque_does_not_show_covers_nothing() -> None:
    gone = EffectEvidence(EFFECTS["supply_sag"], {}, float("nan"), {}, ())
    findings = _findings(_waving(0.5), 0.99, _SLOW, effects=(gone,))
    found = look_into_samples(findings)
    assert found is not None
    assert [effect.name for effect in judge(findings, found).effects] == ["cogging"]


def test_parameters_that_are_off_hide_nothing_from_the_second_look() -> None:
    shift = Shift("payload_error", {}, "the load is not the simulation's")
    findings = _findings(_waving(0.5), None, _SLOW, comparison=Comparison((shift,)), parts=(1.0,))
    findings = replace(findings, held=Confirmation(5.0, 0.4, 0.1, (0.0, 0.0), 0.9))
    verdict = judge(findings, look_into_samples(findings))
    assert [(effect.name, effect.share > 0.0) for effect in verdict.effects] == [
        ("cogging", True),
        ("payload_error", False),
    ]
    assert verdict.held.before == "refitted"


def test_a_coarse_ripple_that_gives_way_to_a_finer_one_is_not_refused_under_the_same_name() -> None:
    coarse = {name: Quantity(value, "", (value, value)) for name, value in _WAVE.items()}
    named = EffectEvidence(EFFECTS["cogging"], coarse, 1.0, {}, ())
    findings = _findings(_waving(0.5), 0.99, _SLOW, effects=(named,))
    chosen, refused = known_fit(_BASELINE, ("cogging",), 300.0), known_fit(_BASELINE, ("end_stop",), 9.0, refused="-")
    found = known_search(chosen, refused)
    findings = replace(findings, trial=Trial(chosen=chosen), case=replace(findings.case, found=found))
    verdict = judge(findings, look_into_samples(findings))
    assert verdict.effects[0].parameters["order"].value == pytest.approx(700.0, rel=1e-3)
    assert [(rival.effects, rival.refused) for rival in verdict.rivals] == [(("cogging",), ""), (("end_stop",), "-")]


def test_a_ripple_no_finer_than_that_of_the_rows_stays_a_candidate() -> None:
    near = {name: Quantity(value, "", (value, value)) for name, value in (_WAVE | {"order": 600.0}).items()}
    named = EffectEvidence(EFFECTS["cogging"], near, 1.0, {}, ())
    findings = _findings(_waving(0.5), 0.99, _SLOW, effects=(named,))
    verdict = judge(findings, look_into_samples(findings))
    assert verdict.sample is None
    assert verdict.effects[0].parameters["order"].value == 600.0


def test_a_bristle_that_the_base_has_itself_is_none() -> None:
    found = _find_bristle(_braked())
    assert found is not None
    assert _is_softer(_braked(), found, _BRAKE, 0)
    soft = _base(1.0, (9000.0, 0.0, 0.02, 4000.0), 0.004)
    assert not _is_softer(_braked(), found, soft, 0)


def test_a_bristle_that_is_much_softer_than_that_of_the_base_counts() -> None:
    found, less_soft = _find_bristle(_braked()), _base(1.0, (9000.0, 0.0, 0.02, 4000.0), 0.1 * 0.004)
    assert found is not None
    assert find_soft_presliding(simulate_base(_braked(), less_soft, 0)) is not None
    assert _is_softer(_braked(), found, less_soft, 0)


def test_friction_that_waves_with_the_speed_is_no_ripple() -> None:
    alone = _find_ripple(_waving(0.0), 0)
    assert alone is not None  # its own plain base takes it for one
    assert not _is_beyond(_waving(0.0), alone, _SLOW, 0)


def test_a_ripple_on_top_of_that_is_one() -> None:
    found = _find_ripple(_waving(0.5), 0)
    assert found is not None
    assert found.harmonics[0].order == pytest.approx(700.0, rel=1e-3)
    assert _is_beyond(_waving(0.5), found, _SLOW, 0)


def test_the_base_alone_gives_the_recording_of_a_joint_with_nothing_missing() -> None:
    joint = ToyJoint()
    columns = record(joint, "fourier", 10.0)
    values = {
        "inertia": joint.inertia,
        "gravity_cos": joint.gravity * np.sin(joint.phase),
        "gravity_sin": joint.gravity * np.cos(joint.phase),
        "offset": joint.offset,
        "breakaway": 0.5 * (joint.forward[0] + joint.reverse[0]) / joint.sigma_0,
    }
    for side in ("forward", "reverse"):
        coulomb, static, velocity, viscous = getattr(joint, side)
        values |= {f"{side}.coulomb_torque": coulomb, f"{side}.excess": static - coulomb}
        values |= {f"{side}.stribeck_velocity": velocity, f"{side}.viscous_coefficient": viscous}
    base = {name: Quantity(value, "", (value, value)) for name, value in values.items()}
    recording = Recording(columns["time"], columns["position"], columns["torque"])
    error = simulate_base(recording, base, 0).torque - recording.torque
    sliding = np.abs(columns["true_velocity"]) > 0.2
    sliding[:200] = False  # the loop jerks at its start
    # Two independent noises of 0.05 N·m, and what the encoder's steps put into the acceleration.
    assert np.sqrt(np.mean(error[sliding] ** 2)) < 0.05 * float(np.std(recording.torque))


def test_a_ripple_of_the_samples_is_taken_out_of_the_torque() -> None:
    recording, plain = _waving(0.5), _waving(0.0)
    found = look_into_samples(_findings(recording, None, _SLOW, unknown=True))
    assert found is not None
    (cleaned,) = remove_ripple((recording,), found)
    assert np.std(cleaned.torque - plain.torque) < 0.1 * np.std(recording.torque - plain.torque)
    assert np.array_equal(cleaned.position, recording.position)


def test_a_ripple_goes_into_a_law_beside_the_waves_that_it_has() -> None:
    found = look_into_samples(_findings(_waving(0.5), None, _SLOW, unknown=True))
    assert found is not None
    curve = StribeckCurve(9.0, 13.0, 0.05, 10.0)
    model = FrictionModel(FrictionLaw((BidirectionalStribeck(curve, curve), Cogging(0.1, 0.0, 30.0))))
    extended = found.extend(model)
    assert extended is not None
    numbers = extended.law.parameters()
    assert numbers["cogging.order"] == 30.0
    assert numbers["cogging_2.order"] == pytest.approx(700.0, rel=0.01)

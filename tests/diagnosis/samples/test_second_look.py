"""The second look names what the base cannot show, and leaves a good answer and a base at its noise alone."""

from dataclasses import replace

import numpy as np
import pytest
from msgspec.structs import replace as with_fields

from fricomp.diagnosis import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord, HeldOut, NamedEffect, Quantity, Rival
from fricomp.diagnosis.samples.fine_ripple import find_fine_ripple
from fricomp.diagnosis.samples.proving import base_recording, beyond_the_base, softer_than_the_base
from fricomp.diagnosis.samples.second_look import second_look
from fricomp.diagnosis.samples.soft_presliding import bristle, find_soft_presliding
from fricomp.recording import Recording, RecordingMetadata

from ..toy_joint import ToyJoint, record


def _base(inertia: float, sides: tuple[float, float, float, float], breakaway: float) -> dict[str, Quantity]:
    """A base without gravity, the same in both directions."""
    curve = dict(zip(("coulomb_torque", "excess", "stribeck_velocity", "viscous_coefficient"), sides, strict=True))
    values = {"inertia": inertia, "gravity_cos": 0.0, "gravity_sin": 0.0, "offset": 0.1, "breakaway": breakaway}
    values |= {f"{side}.{name}": value for side in ("forward", "reverse") for name, value in curve.items()}
    return {name: Quantity(value, "", (value, value)) for name, value in values.items()}


_SLOW = _base(0.02, (9.0, 4.0, 0.05, 10.0), 9e-5)


def _waving(ripple: float) -> Recording:
    """A slow joint whose speed waves along the way, through the falling part of its Stribeck curve."""
    t = np.arange(8000) / 1000.0
    speed = np.where(t < 2.0, 0.25, 0.06) * (1.0 + 0.5 * np.sin(2.0 * np.pi * 8.0 * t))
    q = np.round(np.cumsum(speed) / 1000.0 / 1.2e-5) * 1.2e-5
    noise = 0.05 * np.random.default_rng(1).standard_normal(t.size)
    recording = base_recording(Recording(time=t, position=q, torque=noise), _SLOW, 7)
    return replace(recording, torque=recording.torque + ripple * np.sin(700.0 * q))


def _braked() -> Recording:
    """A band brake with a bristle of 9 kN that gives way over 4 mm."""
    t = np.arange(7000) / 1000.0
    q = 0.025 * np.sin(6.3 * t) * (1.0 + 0.2 * np.sin(1.1 * t))
    force = 9000.0 * bristle(q, 0.004) + 4000.0 * np.gradient(q, t) + 200.0
    force = force + 50.0 * np.random.default_rng(2).standard_normal(t.size)
    return Recording(time=t, position=q, torque=force, metadata=RecordingMetadata(motion="linear", torque_unit="N"))


_BRAKE = _base(1.0, (9000.0, 500.0, 0.02, 4000.0), 5e-6)


def _answer(verdict: str, share: float | None, base: dict[str, Quantity]) -> Diagnosis:
    """What a search concluded; `share` is that of a named measurement, None where it named nothing."""
    named = NamedEffect(name="encoder_eccentricity", kind="measurement", parameters={}, share=share or 0.0)
    held = HeldOut(
        rmse_before=900.0,
        rmse_after=60.0 if share else 900.0,
        noise_floor=50.0,
        unit="N",
        ci95_reduction=(0.0, 0.0),
        explained=share or 0.0,
    )
    effects = () if share is None else (named,)
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict=verdict,  # type: ignore[arg-type]
        effects=effects,
        heldout=held,
        base=base,
        recordings=("one",),
    )
    return Diagnosis(record)


def test_a_bristle_is_named_where_something_unknown_was_left() -> None:
    looked = second_look([_braked()], _answer("unknown_physics", None, _BRAKE))
    assert looked.verdict == "missing_physics"
    assert [effect.name for effect in looked.effects] == ["presliding_hysteresis"]


@pytest.mark.parametrize(
    ("verdict", "share"),
    [("measurement", 0.99), ("measurement", 0.0), ("parameters", 0.0), ("consistent", None)],
)
def test_a_good_answer_and_a_base_at_its_noise_are_kept(verdict: str, share: float | None) -> None:
    answer = _answer(verdict, share, _BRAKE)
    assert second_look([_braked()], answer) is answer


def test_parameters_that_are_off_hide_nothing_from_the_second_look() -> None:
    given = _answer("parameters", 0.9, _SLOW)
    held = given.heldout
    assert held is not None
    held = with_fields(held, before="given", rmse_before=5.0, rmse_after=0.4, noise_floor=0.1)
    looked = second_look([_waving(0.5)], replace(given, record=with_fields(given.record, heldout=held)))
    assert [(effect.name, effect.share > 0.0) for effect in looked.effects] == [
        ("cogging", True),
        ("encoder_eccentricity", False),
    ]
    assert looked.heldout is not None
    assert looked.heldout.before == "refitted"


def test_a_coarse_ripple_that_gives_way_to_a_finer_one_is_not_refused_under_the_same_name() -> None:
    coarse = {"order": 100.0, "sine": 0.1, "cosine": 0.0}
    parameters = {name: Quantity(value, "", (value, value)) for name, value in coarse.items()}
    named = NamedEffect(name="cogging", kind="physics", parameters=parameters, share=0.99)
    rivals = (
        Rival(effects=("cogging",), gain=300.0, coverage=0.99),
        Rival(effects=("end_stop",), gain=9.0, refused="-"),
    )
    answer = _answer("missing_physics", 0.99, _SLOW)
    answer = replace(answer, record=with_fields(answer.record, effects=(named,), rivals=rivals))
    looked = second_look([_waving(0.5)], answer)
    assert looked.effects[0].parameters["order"].value == pytest.approx(700.0, rel=1e-3)
    assert looked.record.rivals == rivals


def test_a_bristle_that_the_base_has_itself_is_none() -> None:
    assert find_soft_presliding(_braked()) is not None
    assert softer_than_the_base(_braked(), _BRAKE, 0)
    soft = _base(1.0, (9000.0, 0.0, 0.02, 4000.0), 0.004)
    assert not softer_than_the_base(_braked(), soft, 0)


def test_friction_that_waves_with_the_speed_is_no_ripple() -> None:
    alone = find_fine_ripple(_waving(0.0))
    assert alone is not None  # its own plain base takes it for one
    assert not beyond_the_base(_waving(0.0), alone, _SLOW, 0)


def test_a_ripple_on_top_of_that_is_one() -> None:
    found = find_fine_ripple(_waving(0.5))
    assert found is not None
    assert found.harmonics[0].order == pytest.approx(700.0, rel=1e-3)
    assert beyond_the_base(_waving(0.5), found, _SLOW, 0)


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
    error = base_recording(recording, base, 0).torque - recording.torque
    sliding = np.abs(columns["true_velocity"]) > 0.2
    sliding[:200] = False  # the loop jerks at its start
    # Two independent noises of 0.05 N·m, and what the encoder's steps put into the acceleration.
    assert np.sqrt(np.mean(error[sliding] ** 2)) < 0.05 * float(np.std(recording.torque))

"""The sentence on where a mismatch sits: few facts, with their units, the most telling first."""

from __future__ import annotations

from typing import Any

import pytest

from fricomp.diagnosis import DIAGNOSIS_SCHEMA, DiagnosisRecord, HeldOut, NamedEffect, Quantity
from fricomp.diagnosis.record.result import Location
from fricomp.diagnosis.record.sentence import write_sentences
from fricomp.diagnosis.record.whereabouts import describe_whereabouts

_HELD = HeldOut(
    rmse_before=0.2, rmse_after=0.03, noise_floor=0.02, unit="N·m", ci95_reduction=(0.8, 0.9), explained=0.987
)
_MANY = [(float(k), k + 0.5) for k in range(9)]


def _effect(name: str, location: Location | None = None, share: float = 0.5, **parameters: Quantity) -> NamedEffect:
    return NamedEffect(name=name, kind="physics", parameters=parameters, location=location or {}, share=share)


def _record(location: Location, *effects: NamedEffect, **more: Any) -> DiagnosisRecord:
    speed = {"forward.stribeck_velocity": Quantity(0.1, "rad/s", (0.1, 0.1))}
    told = {"verdict": "missing_physics", "heldout": _HELD, "base": speed, "noise_ratio": 10.0, **more}
    return DiagnosisRecord(schema=DIAGNOSIS_SCHEMA, location=location, effects=effects, **told)


@pytest.mark.parametrize(
    ("location", "said"),
    [
        ({"time": [(3.2, 3.456)], "velocity": [(-1.0, 0.5)]}, "at times 3.2 to 3.46 s; at velocity -1 to 0.5 rad/s."),
        ({"load_torque": [(2.0, 5.5)], "time": _MANY}, "at load torque 2 to 5.5 N·m."),
        ({"time_since_reversal": [(0.0, 0.2)], "temperature": [(30.0, 41.0)]}, "reversal; at temperature 30 to 41 °C."),
        ({"time_since_reversal": [(0.3, 0.4)]}, "0.3 to 0.4 s after a reversal."),
        ({"position": [(0.1, 0.2), (0.4, 0.5), (0.8, 0.9)]}, "at position 0.1 to 0.2, 0.4 to 0.5, 0.8 to 0.9 rad."),
        ({"time": _MANY, "position": _MANY}, "at position 0 to 0.5, 1 to 1.5, 2 to 2.5 rad and 6 further stretches."),
        ({"acceleration": [(5.0, 9.0)], "velocity": [(0.1, 0.2)]}, "sits at velocity 0.1 to 0.2 rad/s."),
        ({"time": _MANY}, "spread over the whole recording: no time, speed, position or load stands out."),
    ],
)
def test_the_strongest_facts_are_said_with_their_units(location: Location, said: str) -> None:
    assert describe_whereabouts(_record(location, _effect("any"))).endswith(said)


def test_a_ripple_sits_in_the_rhythm_of_the_position_and_the_order_of_a_filter_is_none() -> None:
    ripple, lag = Quantity(36.0, "1/rad", (35.9, 36.1)), Quantity(2.0, "1", (2.0, 2.0))
    assert "in the rhythm of the position, at the order 36 1/rad" in describe_whereabouts(
        _record({}, _effect("cogging", order=ripple))
    )
    assert describe_whereabouts(_record({}, _effect("drive_lag", order=lag))) == ""


def test_each_of_several_effects_has_its_strongest_fact_and_the_joint_its_name() -> None:
    effects = (_effect("end_stop", {"position": [(0.9, 1.0)]}), _effect("load", {"load_torque": [(2.0, 3.0)]}))
    said = describe_whereabouts(_record({"position": [(0.5, 1.0)]}, *effects, joint="elbow"))
    assert said == (
        "Most of the mismatch sits in joint elbow at position 0.5 to 1 rad. "
        "By effect: end_stop at position 0.9 to 1 rad; load at load torque 2 to 3 N·m."
    )


def test_times_of_several_recordings_are_those_of_the_first() -> None:
    record = _record({"time": [(1.0, 2.0)]}, _effect("any"), recordings=("cold", "warm"))
    assert describe_whereabouts(record) == "Most of the mismatch sits at times 1 to 2 s of the first recording."


def test_how_large_where_what_and_how_much_of_it_come_in_this_order() -> None:
    effects = (_effect("cogging", share=0.98), _effect("end_stop", share=0.007))
    _, large, where, first, second, fall = write_sentences(_record({"position": [(0.5, 1.0)]}, *effects))
    assert "10.00 times its noise floor" in large
    assert "position 0.5 to 1 rad" in where
    assert (first[:7], second[:8]) == ("cogging", "end_stop")
    share = "That is 99 % of what lies above the noise floor and can be explained"
    assert fall.endswith(f"{share} (cogging 98 %, end_stop less than 1 %).")


def test_how_large_the_mismatch_of_parameters_is_counts_them_as_given() -> None:
    held = HeldOut(
        rmse_before=2.75, rmse_after=0.005, noise_floor=0.005, unit="N·m", ci95_reduction=(0.9, 1.0), explained=1.0,
        before="given",
    )  # fmt: skip
    large = write_sentences(
        _record({}, _effect("payload_error"), verdict="parameters", heldout=held, noise_ratio=1.08)
    )[1]
    assert large.endswith("is 1.08 times its noise floor; with the parameters as given, it is 550 times.")


def test_a_joint_with_nothing_missing_has_no_place_for_it() -> None:
    assert len(write_sentences(_record({}, verdict="consistent"))) == 2


def test_the_wave_of_another_recording_is_called_so() -> None:
    wave = Quantity(0.2, "N·m", (0.1, 0.3))
    said = " ".join(write_sentences(_record({}, _effect("cogging", sine=wave, sine_2=wave))))
    assert "sine 0.2 N·m (0.1 to 0.3), sine of recording 2 0.2 N·m" in said

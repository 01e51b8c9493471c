"""Recordings that cannot be diagnosed get the verdict `bad_data`, a sentence, and never a name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from scipy.signal import lfilter

from fricomp.diagnosis import Diagnosis, RigidJoint, diagnose
from fricomp.diagnosis.evidence.velocity_lag import find_velocity_lag
from fricomp.diagnosis.inputs.checks import (
    PART_OF,
    inertia_against,
    kind_against,
    reasons_against,
    remarks_on,
    take_usable,
)
from fricomp.diagnosis.joint.loading import build_tracks
from fricomp.diagnosis.joint.weak_form import estimate_rest_speed
from fricomp.errors import DiagnosisError, RecordingError
from fricomp.recording import Recording, RecordingMetadata

from ..toy_joint import ToyJoint, recording


@pytest.fixture(scope="module")
def good() -> Recording:
    return recording(ToyJoint(), "fourier", 20.0)


def assert_bad(diagnosis: Diagnosis, word: str) -> None:
    assert diagnosis.verdict == "bad_data"
    assert diagnosis.effects == ()
    assert any(word in sentence for sentence in diagnosis.sentences[1:]), diagnosis.sentences


def test_a_joint_that_never_moves(good: Recording) -> None:
    assert_bad(diagnose(replace(good, position=np.zeros(len(good)))), "never moves")


def test_torque_on_the_motor_side_without_a_ratio(good: Recording) -> None:
    assert_bad(diagnose(replace(good, metadata=RecordingMetadata(torque_side="motor"))), "motor side")


def test_torque_on_the_motor_side_is_told_where_the_ratio_is_known(good: Recording) -> None:
    motor = replace(good, metadata=RecordingMetadata(torque_side="motor", gear_ratio=60.0))
    assert reasons_against([motor], None) == []
    (remark,) = remarks_on([motor])
    assert "gear ratio 60" in remark


@pytest.mark.slow
def test_torque_on_the_motor_side_is_brought_to_the_joint(good: Recording) -> None:
    torque = np.asarray(good.torque) / 60.0
    motor = replace(good, torque=torque, metadata=RecordingMetadata(torque_side="motor", gear_ratio=60.0))
    found = diagnose(motor)
    assert found.verdict == "consistent"
    assert found.record.base["inertia"].value == pytest.approx(ToyJoint().inertia, rel=0.01)


def test_the_wrong_joint(good: Recording) -> None:
    assert_bad(diagnose(replace(good, metadata=RecordingMetadata(joint="elbow")), joint="wrist"), "'elbow'")


def test_a_long_standstill(good: Recording) -> None:
    rest = 30_000
    time = np.arange(len(good) + rest, dtype=np.float64) * np.float64(1e-3)
    position = np.concatenate([good.position, np.full(rest, good.position[-1])])
    torque = np.concatenate([good.torque, np.full(rest, good.torque[-1])])
    usable = take_usable([Recording(time, position, torque)], None)
    assert usable.reasons == []
    assert sum(one.duration for one in usable.recordings) < 26.0
    assert "long rests" in usable.remarks[0]


def test_two_sample_rates_become_the_lower_one(good: Recording) -> None:
    slow = Recording(good.time[::5], good.position[::5], good.torque[::5])
    usable = take_usable([good, slow], None)
    assert [round(1.0 / one.sample_period) for one in usable.recordings] == [200, 200]
    assert "200 Hz" in usable.remarks[-1]


def test_the_fault_of_one_recording_costs_that_one(good: Recording) -> None:
    still = replace(good, position=np.zeros(len(good)))
    usable = take_usable([good, still], None)
    assert usable.recordings[0].metadata.extra == {PART_OF: 0}
    assert len(usable.recordings) == 1
    assert "recording 2" in usable.remarks[-1]
    assert "never moves" in usable.remarks[-1]


def test_positions_that_look_like_degrees_unless_the_joint_turns_without_end(good: Recording) -> None:
    far = replace(good, position=20.0 * np.asarray(good.position))
    assert_bad(diagnose(far), "degrees")
    endless = replace(far, metadata=RecordingMetadata(continuous=True))
    assert reasons_against([endless], None) == []


@pytest.mark.parametrize(("factor", "word"), [(1.0 / 57.3, "smaller"), (100.0, "larger")])
def test_an_inertia_that_no_payload_explains(factor: float, word: str) -> None:
    (reason,) = inertia_against(0.3 * factor, 0.3)
    assert word in reason
    assert inertia_against(0.3 * 8.0, 0.3) == []


def test_an_inertia_names_the_unit_that_would_make_it() -> None:
    (larger,), (smaller,) = inertia_against(300.0, 0.3), inertia_against(1e-4, 0.3)
    assert "mN·m" in larger
    assert "degrees" not in larger
    assert "degrees" in smaller
    assert "mN·m" not in smaller


def test_a_joint_that_slides_is_no_simulation_of_one_that_turns(good: Recording) -> None:
    slide = RigidJoint(8.0, (0.0, 0.0), 0.0, 0.0, 0.0, False)
    assert_bad(diagnose(good, slide), "joint slides")
    assert kind_against([good], True) == []
    linear = replace(good, metadata=replace(good.metadata, motion="linear", torque_unit="N"))
    (reason,) = kind_against([linear], True)
    assert "hinge" in reason


def test_a_flipped_torque(good: Recording) -> None:
    assert_bad(diagnose(replace(good, torque=-np.asarray(good.torque))), "torque")


def test_samples_that_are_not_finite_never_reach_the_diagnosis(good: Recording) -> None:
    torque = np.array(good.torque)
    torque[100] = np.nan
    with pytest.raises(RecordingError):
        replace(good, torque=torque)


def test_no_recording_is_an_error() -> None:
    with pytest.raises(DiagnosisError, match="at least one"):
        diagnose([])


def _without(good: Recording, first: int, last: int) -> Recording:
    kept = np.r_[0:first, last : len(good)]
    return Recording(good.time[kept], good.position[kept], good.torque[kept])


def test_a_short_gap_is_bridged_and_told(good: Recording) -> None:
    short = _without(good, 5000, 5008)
    assert reasons_against([short], None) == []
    assert remarks_on([short]) == ["1 gap(s) in time were bridged, the longest 9 ms."]
    assert build_tracks([short])[0].size == len(good)


def test_a_long_gap_is_not_bridged(good: Recording) -> None:
    long = _without(good, 5000, 5400)
    parts = take_usable([long], None).recordings
    assert [len(part) for part in parts] == [5000, len(good) - 5400]
    assert {part.metadata.extra[PART_OF] for part in parts} == {0}
    assert not any("bridged" in remark for remark in remarks_on([long]))


@pytest.mark.parametrize(("lag", "every"), [(4e-3, 1), (12e-3, 1), (20e-3, 8)])
def test_the_lag_of_a_velocity_filter_is_found(lag: float, every: int, good: Recording) -> None:
    fine = np.arange(0.0, 20.0, 1e-5)
    velocity = 1.5 * np.cos(3.0 * fine) + 2.0 * np.cos(11.0 * fine)
    position = 0.5 * np.sin(3.0 * good.time) + 2.0 / 11.0 * np.sin(11.0 * good.time)
    keep = float(np.exp(-1e-5 / lag))
    late = np.interp(good.time, fine, lfilter([1.0 - keep], [1.0, -keep], velocity))
    effect = find_velocity_lag([replace(good, position=position, velocity=late).rows(slice(None, None, every))])
    assert effect is not None
    low, high = effect.parameters["time_constant"].ci95
    assert low < lag < high


def test_a_velocity_from_differences_at_a_low_rate_is_not_late(good: Recording) -> None:
    """It is half a sample behind the position, and a whole one more where it comes with the next row."""
    position = 0.5 * np.sin(3.0 * good.time) + 2.0 / 11.0 * np.sin(11.0 * good.time)
    few = replace(good, position=position).rows(slice(None, None, 8))
    differences = np.diff(few.position, prepend=few.position[0]) / few.sample_period
    for late in (differences, np.concatenate([[0.0], differences[:-1]])):
        assert find_velocity_lag([replace(few, velocity=late)]) is None


def test_steps_of_a_coarse_encoder_on_a_slow_motion_are_no_lag(good: Recording) -> None:
    smooth = 0.01 * np.sin(2.0 * good.time)
    noise = 2e-3 * np.random.default_rng(2).standard_normal(len(good))
    slow = replace(good, position=np.round(smooth / 2e-4) * 2e-4, velocity=np.gradient(smooth, good.time) + noise)
    assert find_velocity_lag([slow]) is None


def test_a_scaled_velocity_is_told_and_is_no_lag(good: Recording) -> None:
    velocity = gaussian_filter1d(np.gradient(good.position, good.time), 5.0)
    late = np.concatenate([np.full(8, velocity[0]), velocity[:-8]])
    found = find_velocity_lag([replace(good, velocity=late)])
    assert found is not None
    assert found.name == "velocity_filter_lag"
    doubled = replace(good, velocity=2.0 * late)
    assert find_velocity_lag([doubled]) is None
    (remark,) = remarks_on([doubled])
    assert "2.0" in remark
    assert "times the derivative of position" in remark
    second = remarks_on([good, doubled], ["log part 1", "log part 2"])
    assert [one.partition(":")[0] for one in second] == ["log part 2"]


def test_the_speed_of_rest_shrinks_with_the_joint_s_own(good: Recording) -> None:
    slow = Recording(good.time, 1e-3 * np.asarray(good.position), good.torque)
    usual, small = (estimate_rest_speed(build_tracks([one])) for one in (good, slow))
    assert usual == 5e-3
    assert small < 1e-4

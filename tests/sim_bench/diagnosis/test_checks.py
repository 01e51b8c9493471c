"""Recordings that cannot be diagnosed get the verdict `bad_data`, a sentence, and never a name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fricomp.errors import DiagnosisError, RecordingError
from fricomp.recording import Recording, RecordingMetadata
from fricomp.sim_bench import diagnose
from fricomp.sim_bench.diagnosis import Diagnosis

from .toy_joint import ToyJoint, recording


@pytest.fixture(scope="module")
def good() -> Recording:
    return recording(ToyJoint(), "fourier", 20.0)


def assert_bad(diagnosis: Diagnosis, word: str) -> None:
    assert diagnosis.verdict == "bad_data"
    assert diagnosis.effects == ()
    assert any(word in sentence for sentence in diagnosis.sentences[1:]), diagnosis.sentences


def test_a_joint_that_never_moves(good: Recording) -> None:
    assert_bad(diagnose(replace(good, position=np.zeros(len(good)))), "never moves")


def test_torque_on_the_motor_side(good: Recording) -> None:
    assert_bad(diagnose(replace(good, metadata=RecordingMetadata(torque_side="motor"))), "motor side")


def test_the_wrong_joint(good: Recording) -> None:
    assert_bad(diagnose(replace(good, metadata=RecordingMetadata(joint="elbow")), joint="wrist"), "'elbow'")


def test_a_long_standstill(good: Recording) -> None:
    rest = 30_000
    time = np.arange(len(good) + rest, dtype=np.float64) * np.float64(1e-3)
    position = np.concatenate([good.position, np.full(rest, good.position[-1])])
    torque = np.concatenate([good.torque, np.full(rest, good.torque[-1])])
    assert_bad(diagnose(Recording(time, position, torque)), "stands still")


def test_two_sample_rates(good: Recording) -> None:
    slow = Recording(good.time[::5], good.position[::5], good.torque[::5])
    assert_bad(diagnose([good, slow]), "sample rates")


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

"""Friction goes from one way to the other while a joint stands still, and at once where it turns without a rest."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.arm.log.direction import find_rests, find_step
from fricomp.laws import FloatArray

_RATE, _COUNT = 500.0, 5e-5


def _swing(rest: float) -> tuple[FloatArray, FloatArray]:
    """Time and position of a joint that swings by a radian, and stands still for a time where it turns [s]."""
    time = np.arange(0.0, 20.0, 1.0 / _RATE)
    phase = np.arange(0.0, np.pi, 2.0 / _RATE)
    stroke = np.concatenate([-0.5 * np.cos(phase), np.full(round(rest * _RATE), 0.5)])
    path = np.concatenate([stroke, -stroke])
    return time, np.resize(path, time.size)


def _read(position: FloatArray) -> FloatArray:
    return np.asarray(np.round(position / _COUNT) * _COUNT)


@pytest.mark.parametrize("rest", [0.1, 0.3])
def test_friction_turns_while_a_joint_stands_still(rest: float) -> None:
    _, position = _swing(rest)
    found = find_rests(_read(position))
    turning = np.abs(found) < 1.0  # of what is no number, none
    still = np.diff(position, prepend=position[0]) == 0.0
    assert np.mean(turning[still]) > 0.85  # but for the ends of the recording, which no stroke follows
    assert np.mean(still[turning]) > 0.8
    begin = np.flatnonzero(np.diff(turning.astype(int)) > 0)[0] + 1
    end = np.flatnonzero(np.diff(turning.astype(int)) < 0)[0]
    assert found[begin] > 0.9
    assert found[end] < -0.9


@pytest.mark.parametrize("acceleration", [0.1, 1.0, 10.0])
def test_a_joint_that_only_turns_round_does_not_stand_still(acceleration: float) -> None:
    time = np.arange(0.0, 40.0, 1.0 / _RATE)
    position = 0.4 * np.sin(np.sqrt(acceleration / 0.4) * time + 0.3) + 0.01 * np.sin(0.7 * time)
    assert np.all(np.isnan(find_rests(_read(position))))


def test_noise_in_each_sample_is_no_motion() -> None:
    _, position = _swing(0.2)
    noisy = position + 3e-5 * np.random.default_rng(0).normal(size=position.size)
    turning = np.abs(find_rests(noisy)) < 1.0
    still = np.diff(position, prepend=position[0]) == 0.0
    assert np.mean(still[turning]) > 0.7
    assert np.mean(turning[still]) > 0.5


def test_a_path_that_never_turns_has_no_rest_between_strokes() -> None:
    assert np.all(np.isnan(find_rests(np.linspace(0.0, 1.0, 100))))
    assert np.all(np.isnan(find_rests(np.zeros(100))))


def test_the_step_of_an_encoder_is_that_of_its_counts() -> None:
    assert find_step(_read(_swing(0.1)[1])) == pytest.approx(_COUNT)

"""A recording is filtered once for the settings that are chosen, and its derivatives are those of the spline."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from fricomp.calibration.motion import cutoffs
from fricomp.calibration.motion.joint_samples import JointSamples, RegressionSettings, _differentiate, sample_joint
from fricomp.recording import Recording


def _record() -> Recording:
    time = np.arange(0.0, 24.0, 0.004)
    position = 0.7 * np.sin(0.9 * time) + 0.2 * np.sin(3.1 * time + 0.5)
    position = np.round(position / 1e-4) * 1e-4
    velocity = np.gradient(position, time)
    return Recording(time, position, np.sign(velocity) + 0.3 * velocity)


def test_samples_come_with_the_settings_and_no_cutoff_is_filtered_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    recording, asked = _record(), list[RegressionSettings]()

    def count(given: Recording, settings: RegressionSettings) -> JointSamples:
        asked.append(settings)
        return sample_joint(given, settings)

    monkeypatch.setattr(cutoffs, "sample_joint", count)
    settings, samples = cutoffs.choose_samples(recording)
    assert len(asked) == len(set(asked))
    again = sample_joint(recording, cutoffs.choose_settings(recording))
    assert settings == cutoffs.choose_settings(recording)
    assert np.array_equal(samples.acceleration, again.acceleration)
    assert np.array_equal(samples.torque, again.torque)


def test_derivatives_are_those_of_the_spline() -> None:
    time = np.arange(0.0, 2.0, 0.003)
    values = np.sin(5.0 * time)
    curve = CubicSpline(time, values)
    velocity, acceleration = _differentiate(time, values)
    assert np.array_equal(velocity, curve(time, 1))
    assert np.array_equal(acceleration, curve(time, 2))

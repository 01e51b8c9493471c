"""Noise of an encoder in the acceleration: it shrinks no inertia, and makes no torque come early."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.identify import MotionIdentification, identify_motion
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.recording import Recording

INERTIA, COULOMB = 0.011, 0.9
RATE = 400.0


def _identify(bits: int, viscous: float, seed: int) -> MotionIdentification:
    """A joint that is moved exactly along some sines, its angle read by an encoder of so many bits."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 25.0, 1.0 / RATE)
    swings = ((1.1, 0.23), (0.5, 0.61), (0.14, 1.4))
    position, velocity, acceleration = np.zeros_like(t), np.zeros_like(t), np.zeros_like(t)
    for size, frequency in swings:
        w, phase = 2.0 * np.pi * frequency, rng.uniform(0.0, 2.0 * np.pi)
        position += size * np.sin(w * t + phase)
        velocity += size * w * np.cos(w * t + phase)
        acceleration -= size * w**2 * np.sin(w * t + phase)
    torque = INERTIA * acceleration + viscous * velocity + COULOMB * np.sign(velocity)
    count = 2.0 * np.pi / 2**bits
    read = np.round(position / count + rng.uniform()) * count
    recording = Recording(t, read, torque + 2e-3 * COULOMB * rng.normal(size=t.size))
    settings = choose_settings(recording)
    return identify_motion(sample_joint(recording, settings), settings, law="coulomb_viscous")


@pytest.mark.parametrize(("bits", "viscous"), [(12, 0.5), (13, 0.08), (14, 1.5)])
def test_inertia_and_lag_hold_the_truth(bits: int, viscous: float) -> None:
    found = [_identify(bits, viscous, seed) for seed in range(5)]
    of_inertia = [(one.rigid_body.inertia - INERTIA) / one.rigid_body.standard_deviations[0] for one in found]
    of_lag = [one.lag.value / one.lag.deviation for one in found]
    assert abs(np.mean(of_inertia)) < 1.0
    assert abs(np.mean(of_lag)) < 1.0
    assert np.max(np.abs(of_inertia)) < 3.0


def _identify_constant_speeds(seed: int) -> MotionIdentification:
    """The same at constant speeds, as of a friction test: the steps of the encoder are lines, and no white noise."""
    rng, inertia, rate = np.random.default_rng(seed), 0.004, 200.0
    t = np.arange(0.0, 25.0, 1.0 / rate)
    fractions = np.repeat([0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0], 2) * rng.uniform(0.9, 1.1, 14)
    wanted = 6.0 * np.where(np.arange(14) % 2, -1.0, 1.0) * fractions
    velocity = gaussian_filter1d(wanted[(14.0 * t / t[-1]).astype(int).clip(0, 13)], 0.02 * rate)
    position, acceleration = np.cumsum(velocity) / rate, np.gradient(velocity, t)
    count = 2.0 * np.pi / 2**12
    read = np.round(position / count + rng.uniform()) * count
    torque = inertia * acceleration + 0.05 * velocity + 0.35 * np.sign(velocity)
    recording = Recording(t, read, torque + 3.5e-3 * rng.normal(size=t.size))
    settings = choose_settings(recording)
    return identify_motion(sample_joint(recording, settings), settings, law="coulomb_viscous")


def test_an_inertia_that_constant_speeds_do_not_show_is_not_told_as_sure() -> None:
    bodies = [_identify_constant_speeds(seed).rigid_body for seed in range(6)]
    off = [(one.inertia - 0.004) / one.standard_deviations[0] for one in bodies]
    assert np.max(np.abs(off)) < 3.0

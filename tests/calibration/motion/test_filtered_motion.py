"""A velocity that its drive has low-passed: neither a delay of the torque nor a lag of it, and told as what it is."""

import numpy as np
import pytest
from scipy.signal import lfilter

from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.filtered_motion import find_motion_filter
from fricomp.calibration.motion.identify import identify_motion
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.recording import Recording

RATE, INERTIA, VISCOUS, COULOMB = 500.0, 0.06, 0.5, 1.4


def _record(seed: int, *, cutoff: float = 0.0, early: int = 0) -> Recording:
    """A joint along some swings; its motion behind a low-pass [Hz], or its torque so many rows early."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 25.0, 1.0 / RATE)
    swings = ((0.9, 0.31), (0.3, 0.83), (0.08, 2.3))
    phases = rng.uniform(0.0, 6.28, 3)
    velocity, acceleration = np.zeros_like(t), np.zeros_like(t)
    for (size, frequency), phase in zip(swings, phases, strict=True):
        w = 2.0 * np.pi * frequency
        velocity += size * w * np.cos(w * t + phase)
        acceleration -= size * w**2 * np.sin(w * t + phase)
    torque = INERTIA * acceleration + VISCOUS * velocity + COULOMB * np.tanh(velocity / 0.01)
    if cutoff:
        part = -np.expm1(-2.0 * np.pi * cutoff / RATE)
        velocity = lfilter([part], [1.0, part - 1.0], velocity)
    torque = np.roll(torque, -early) + 0.01 * rng.normal(size=t.size)
    position = np.cumsum(velocity) / RATE
    return Recording(t, position, torque, velocity)


def _find(recording: Recording) -> float | None:
    settings = choose_settings(recording)
    samples = sample_joint(recording, settings)
    return find_motion_filter(samples, settings, identify_motion(samples, settings, law="coulomb_viscous").lag.value)


@pytest.mark.parametrize("cutoff", [3.0, 4.0])
def test_a_low_passed_motion_is_told_with_its_cutoff(cutoff: float) -> None:
    assert _find(_record(1, cutoff=cutoff)) == pytest.approx(cutoff, rel=0.3)


@pytest.mark.parametrize("early", [0, 6, 12])
def test_a_torque_that_is_stamped_early_is_no_low_pass(early: int) -> None:
    assert _find(_record(2, early=early)) is None

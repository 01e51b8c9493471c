"""The lag of a torque where the loop that commands it is closed on a coarse encoder, whose noise it then holds."""

import numpy as np
import pytest

from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.identify import identify_motion
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.recording import Recording

_INERTIA, _COULOMB, _VISCOUS = 0.03, 0.4, 0.15
_RATE, _STEPS = 500.0, 5


def _record(bits: int, lag: float, seed: int) -> Recording:
    """A joint under a PD loop on its encoder, the torque logged late by so much [s]."""
    rng = np.random.default_rng(seed)
    t, count = np.arange(0.0, 20.0, 1.0 / _RATE), 2.0 * np.pi / 2**bits
    swings = ((0.6, 0.27), (0.3, 0.71), (0.12, 1.3))
    wanted = np.sum([a * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.28)) for a, f in swings], axis=0)
    rows, h = np.empty((t.size, 2)), 1.0 / _RATE / _STEPS
    q, v, last, speed = float(wanted[0]), 0.0, round(float(wanted[0]) / count) * count, 0.0
    for k, (at, pace) in enumerate(zip(wanted.tolist(), np.gradient(wanted, t).tolist(), strict=True)):
        read = round(q / count) * count
        speed += 0.47 * ((read - last) * _RATE - speed)  # a low-pass of 50 Hz, as drives have
        last, torque = read, 30.0 * (at - read) + pace - speed
        rows[k] = read, torque
        for _ in range(_STEPS):
            free = v + h / _INERTIA * (torque - _VISCOUS * v)
            v = float(np.copysign(max(abs(free) - h / _INERTIA * _COULOMB, 0.0), free))
            q += h * v
    late = np.interp(t - lag, t, rows[:, 1]) + rng.normal(0.0, 0.004, t.size)
    return Recording(t, rows[:, 0], late)


@pytest.mark.parametrize(("bits", "lag"), [(13, 0.004), (12, 0.0), (16, -0.002)])
def test_a_loop_on_a_coarse_encoder_makes_no_lag(bits: int, lag: float) -> None:
    held = -0.4 / _RATE  # a command is held for a period, half of it after its stamp; a step takes a fifth of that
    errors = []
    for seed in range(3):
        recording = _record(bits, lag, seed)
        settings = choose_settings(recording)
        found = identify_motion(sample_joint(recording, settings), settings, law="coulomb_viscous")
        errors.append((found.lag.value - lag - held) / found.lag.deviation)
        assert found.friction.parameters["viscous.viscous_coefficient"] == pytest.approx(_VISCOUS, rel=0.01)
    assert abs(np.mean(errors)) < 1.5  # standard deviations; with the loop's answer to the encoder in it, 3 to 6
    assert np.max(np.abs(errors)) < 3.0


def test_jumps_that_tell_no_lag_leave_it_unknown() -> None:
    """Steps of a reference: most of the torque is a pulse of some milliseconds, which rings in both slopes."""
    rng, rate, inertia = np.random.default_rng(4), 500.0, 0.08
    t = np.arange(0.0, 40.0, 1.0 / rate)
    position, velocity, acceleration = np.zeros((3, t.size))
    for begin, size in zip(np.arange(0.9, 39.0, 0.9), np.diff(rng.uniform(-0.6, 0.6, 44)), strict=True):
        since = np.maximum(t - begin, 0.0)
        fast, slow = np.exp(-since / 0.008), np.exp(-since / 0.035)
        scale = size / (0.035 - 0.008)
        position += np.where(since > 0.0, size - scale * (0.035 * slow - 0.008 * fast), 0.0)
        velocity += np.where(since > 0.0, scale * (slow - fast), 0.0)
        acceleration += np.where(since > 0.0, scale * (fast / 0.008 - slow / 0.035), 0.0)
    torque = inertia * acceleration + 0.7 * velocity + 2.2 * np.tanh(velocity / 0.01)
    recording = Recording(t, position, torque + 0.02 * rng.normal(size=t.size))
    settings = choose_settings(recording)
    found = identify_motion(sample_joint(recording, settings), settings, law="coulomb_viscous")
    assert abs(found.lag.value) < 3.0 * found.lag.deviation
    assert abs(found.rigid_body.inertia - inertia) < 3.0 * found.rigid_body.standard_deviations[0]

"""A gap so wide that the load hangs free for much of the time: the base takes half of the inertia for all of it."""

from __future__ import annotations

import numba
import numpy as np
import pytest

from fricomp.diagnosis import RigidJoint, diagnose
from fricomp.recording import Recording

pytestmark = pytest.mark.slow

_MOTOR, _LOAD, _GAP, _STIFFNESS, _DAMPING = 0.008, 0.012, 0.02, 690.0, 0.16
_COULOMB, _STATIC, _SPEED, _VISCOUS = 0.0285, 0.037, 0.05, 0.0285
_STEP, _EVERY = 5e-5, 40  # [s], and steps to a sample of 2 ms, for which the loop holds its torque


@numba.njit(cache=True)
def _simulate(reference: np.ndarray, velocity: np.ndarray, acceleration: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Motor position [rad] and torque [N·m] of two masses with set-valued friction at the motor. Shapes (n,)."""
    q, v = reference[0], velocity[0]
    load, speed = q, v
    out, torque = np.empty_like(reference), np.empty_like(reference)
    for k in range(reference.size):
        drive = 18.2 * (reference[k] - q) + 1.21 * (velocity[k] - v) + (_MOTOR + _LOAD) * acceleration[k]
        out[k], torque[k] = q, drive
        for _ in range(_EVERY):
            twist = q - load
            stretch = twist - min(max(twist, -0.5 * _GAP), 0.5 * _GAP)
            teeth = _STIFFNESS * stretch + _DAMPING * (v - speed) if stretch != 0.0 else 0.0
            speed += _STEP * teeth / _LOAD
            load += _STEP * speed
            level = _COULOMB + (_STATIC - _COULOMB) * np.exp(-((v / _SPEED) ** 2))
            free = v + _STEP * (drive - teeth - _VISCOUS * v) / _MOTOR
            v = np.sign(free) * max(abs(free) - _STEP * level / _MOTOR, 0.0)
            q += _STEP * v
    return out, torque


def _record(seed: int) -> Recording:
    rng, t = np.random.default_rng(seed), np.arange(15000, dtype=np.float64) * (_STEP * _EVERY)
    waves = [(0.85, 0.11, 0.0), (0.35, 0.53, 1.0), (0.14, 1.7, 2.0)]
    size, rate, phase = (np.array(column)[:, None] for column in zip(*waves, strict=True))
    angle, rate = 2.0 * np.pi * rate * t + phase, 2.0 * np.pi * rate
    reference = np.sum(size * np.sin(angle), axis=0)
    velocity, acceleration = (
        np.sum(size * rate * np.cos(angle), axis=0),
        -np.sum(size * rate**2 * np.sin(angle), axis=0),
    )
    position, torque = _simulate(reference, velocity, acceleration)
    noise = rng.standard_normal((2, t.size)) * np.array([[2e-5], [0.02 * _COULOMB]])
    return Recording(t, position + noise[0], torque + noise[1])


def test_a_wide_gap_is_found_beside_the_simulation_as_given() -> None:
    simulation = RigidJoint(_MOTOR + _LOAD, (0.0, 0.0), 0.0, _VISCOUS, _COULOMB, True)
    diagnosis = diagnose(_record(seed=23), simulation)
    assert [one.name for one in diagnosis.record.effects] == ["backlash"], diagnosis.sentences
    low, high = diagnosis.record.effects[0].parameters["gap"].ci95
    assert low < _GAP < high
    assert diagnosis.record.effects[0].parameters["load_share"].value == pytest.approx(0.6, abs=0.04)

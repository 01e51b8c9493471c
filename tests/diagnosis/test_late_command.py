"""A command that acts late by a fixed time is told as a delay, also where a low pass would leave noise alone."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp import diagnose
from fricomp.diagnosis.inputs.track import FloatArray
from fricomp.recording import Recording

INERTIA, COULOMB, VISCOUS = 0.02, 0.4, 0.15


def _record_late(late: float, noise: float, *, rate: float = 500.0, duration: float = 30.0) -> Recording:
    """A joint that a loop moves along some waves, whose torque acts `late` [s] after its stamp, held for a sample."""
    rng, substeps, dt = np.random.default_rng(5), 8, 1.0 / rate
    time: FloatArray = np.asarray(np.arange(round(duration * rate)) * dt, dtype=np.float64)
    waves = ((0.9, 0.6, 0.0), (0.35, 1.9, 1.0), (0.03, 14.0, 2.0))  # amplitude [rad], frequency [rad/s], phase
    wanted = np.sum([a * np.sin(w * time + p) for a, w, p in waves], axis=0)
    speed = np.sum([a * w * np.cos(w * time + p) for a, w, p in waves], axis=0)
    position, velocity, h = float(wanted[0]), float(speed[0]), dt / substeps
    commands, positions = np.zeros(time.size), np.zeros(time.size)
    for k in range(time.size):
        positions[k] = position
        commands[k] = 0.02 * 30.0**2 * (wanted[k] - position) + 1.2 * 0.02 * 30.0 * (speed[k] - velocity)
        for i in range(substeps):
            acts = commands[max(int(np.floor(k + (i * h - late) / dt + 1e-9)), 0)]
            free = velocity + h * (acts - VISCOUS * velocity) / INERTIA
            velocity = float(np.sign(free)) * max(abs(free) - h * COULOMB / INERTIA, 0.0)
            position += h * velocity
    torque = commands + noise * rng.standard_normal(time.size)
    return Recording(time, 2e-5 * np.round(positions / 2e-5), torque)


@pytest.mark.slow
@pytest.mark.parametrize(("late", "noise"), [(0.006, 0.02), (0.0066, 0.06), (0.012, 0.06)])
def test_a_late_command_is_a_delay(late: float, noise: float) -> None:
    """With the louder noise a low pass leaves nothing but that noise, and yet more than the delay does."""
    found = diagnose(_record_late(late, noise))
    assert [effect.name for effect in found.effects] == ["torque_delay"]
    delay = found.effects[0].parameters["delay"].value
    assert delay == pytest.approx(late + 1e-3, abs=1.5e-3)  # a torque that is held acts half a sample later


@pytest.mark.slow
def test_where_a_low_pass_says_as_much_both_are_told() -> None:
    (effect,) = diagnose(_record_late(0.0045, 0.06)).effects
    assert {effect.name, *effect.indistinguishable_from} == {"drive_lag", "torque_delay"}

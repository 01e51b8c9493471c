"""Torque of something that is not fitted is told with its size beside the friction, noise of sensors is not."""

from __future__ import annotations

import numpy as np
import pytest

import fricomp
from fricomp.calibration.identification import Status
from fricomp.recording import Recording
from fricomp.sim_bench.studies.logs.good_log import COULOMB, VISCOUS, joint_log

RATE, STEPS = 500.0, 8


_SWINGS = ((0.5, 0.9), (0.25, 2.3))
"""Amplitudes [rad] and frequencies [Hz] of the reference."""


def _swing(gap: float, seconds: float = 12.0, swings: tuple[tuple[float, float], ...] = _SWINGS) -> Recording:
    """A motor with friction that moves a link of the same inertia through a gear with a gap, in a loop of 25 rad/s."""
    inertia, stiffness, damping = 0.015, 0.015 * 250.0**2, 0.4
    time, h = np.arange(0.0, seconds, 1.0 / RATE), 1.0 / RATE / STEPS
    reference = np.sum([size * np.sin(2.0 * np.pi * rate * time + rate) for size, rate in swings], axis=0)
    speed = np.gradient(reference, time)
    q, v, x, w = float(reference[0]), 0.0, float(reference[0]), 0.0
    rows = np.empty((time.size, 2))
    for k, (r, s) in enumerate(zip(reference.tolist(), speed.tolist(), strict=True)):
        torque = 2.0 * inertia * (25.0**2 * (r - q) + 40.0 * (s - v))
        rows[k] = q, torque
        for _ in range(STEPS):
            pressed = np.sign(q - x) * max(abs(q - x) - 0.5 * gap, 0.0)
            of_gear = stiffness * pressed + damping * (v - w) if pressed else 0.0
            free = v + h / inertia * (torque - of_gear - VISCOUS * v)
            v = float(np.copysign(max(abs(free) - h / inertia * COULOMB, 0.0), free))
            w += h / inertia * of_gear
            q, x = q + h * v, x + h * w
    position, torque = rows.T
    noise = np.random.default_rng(3).normal(0.0, 0.004, time.size)
    return Recording(time, np.round(position * 2**17 / np.pi) * np.pi / 2**17, torque + noise)


@pytest.mark.parametrize(("order", "size", "seed"), [(31.0, 0.08, 1), (17.0, 0.15, 2)])
def test_a_ripple_is_told_by_its_part_of_the_friction(order: float, size: float, seed: int) -> None:
    log = joint_log(20.0, 500.0, seed)
    found = fricomp.identify(log.with_channels(torque=log.torque + size * np.sin(order * log.position)))
    assert found.is_usable
    assert found.status is Status.LACK_OF_FIT
    assert found.motion is not None
    friction = float(np.sqrt(np.mean(found.motion.points[:, 1] ** 2)))
    told = float(found.result.message.split(" %")[0]) / 100.0
    assert told == pytest.approx(size / np.sqrt(2.0) / friction, rel=0.4)  # what is fast is beyond the low-pass
    assert "fricomp diagnose" in found.result.message


@pytest.mark.parametrize(("size", "is_told"), [(0.0, False), (0.04, True)])
def test_a_faint_ripple_is_told_and_the_intervals_stay(size: float, is_told: bool) -> None:
    log = joint_log(20.0, 500.0, 4)
    found = fricomp.identify(log.with_channels(torque=log.torque + size * np.sin(17.0 * log.position)))
    assert found.status is Status.CONVERGED, found.result.message
    assert any("as much as the friction is left" in note for note in found.notes) == is_told


@pytest.mark.parametrize("gap", [0.004, 0.02])
def test_a_gap_that_bends_the_curve_is_told(gap: float) -> None:
    found = fricomp.identify(_swing(gap), law="coulomb_viscous")
    assert found.status is not Status.CONVERGED
    assert "fricomp diagnose" in found.result.message


@pytest.mark.parametrize(("noise", "bits"), [(0.004, 18), (0.15, 18), (0.004, 13)])
def test_noise_of_sensors_is_nothing_else_that_acts(noise: float, bits: int) -> None:
    log, count = joint_log(20.0, 500.0, 5), 2.0 * np.pi / 2**bits
    torque = log.torque + np.random.default_rng(6).normal(0.0, noise, len(log))
    found = fricomp.identify(
        log.with_channels(torque=torque, position=np.round(log.position / count) * count, velocity=None),
        law="coulomb_viscous",
    )
    assert found.status is Status.CONVERGED, found.result.message


def test_a_stiff_gear_without_a_gap_is_nothing_else_that_acts() -> None:
    found = fricomp.identify(_swing(0.0), law="coulomb_viscous")
    assert found.status is Status.CONVERGED, found.result.message
    assert found.parameters["coulomb.coulomb_torque"] == pytest.approx(COULOMB, rel=0.03)


def test_a_single_swing_with_a_small_gap_is_no_gravity_and_no_rest() -> None:
    """Its angle goes with its acceleration, so that gravity stands in for the inertia where neither fits."""
    found = fricomp.identify(_swing(0.001, 8.0, ((0.15, 4.0),)), law="coulomb_viscous")
    assert found.motion is not None
    assert found.motion.rigid_body.inertia == pytest.approx(0.03, rel=0.06)
    assert not any(word in note for note in found.notes for word in ("Gravity is fitted", "rests"))
    assert found.status is Status.LACK_OF_FIT

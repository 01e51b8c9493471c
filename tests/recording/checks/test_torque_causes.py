"""A torque that takes energy out has several causes; each is named with the line that mends it, or none is."""

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording
from fricomp.recording.checks.register import find_unsigned_torque
from fricomp.recording.finding import Finding

from ..joint_log import joint_log


def _energy(recording: Recording) -> Finding:
    codes = {"flipped_torque", "unsigned_torque", "late_torque", "driven"}
    (finding,) = [one for one in check_recording(recording) if one.code in codes]
    return finding


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_turned_sign_is_told_as_one(seed: int) -> None:
    log = joint_log(20.0, 400.0, seed)
    found = _energy(log.with_channels(torque=-log.torque))
    assert found.code == "flipped_torque"
    assert "sign = -1" in found.advice


@pytest.mark.parametrize(("bits", "count"), [(16, 1e-3), (12, 5e-3)])
def test_a_signed_number_that_was_read_as_unsigned_is_no_turned_sign(bits: int, count: float) -> None:
    log = joint_log(20.0, 400.0, 4)
    unsigned = np.mod(np.round(log.torque / count), 2**bits) * count
    found = _energy(log.with_channels(torque=unsigned))
    assert found.code == "unsigned_torque"
    assert f"signed_bits = {bits}" in found.advice


@pytest.mark.parametrize(("bits", "count", "rate"), [(12, 2e-3, 400.0), (8, 0.05, 1000.0), (14, 1e-3, 250.0)])
def test_a_kick_of_a_controller_as_large_as_a_register_is_no_unsigned_number(
    bits: int, count: float, rate: float
) -> None:
    log = joint_log(20.0, rate, bits)
    torque = np.round(log.torque / count) * count
    start = int(0.4 * torque.size)
    torque[start : start + int(0.02 * rate)] += 2**bits * count
    assert not find_unsigned_torque(log.with_channels(torque=torque))
    assert not find_unsigned_torque(log.with_channels(torque=-torque))


@pytest.mark.parametrize("delay", [6e-3, 14e-3])
def test_a_command_that_acts_late_is_told_with_its_delay(delay: float) -> None:
    t = np.arange(0.0, 25.0, 1e-3)
    phase = 2.0 * np.pi * (0.4 * t + 0.5 * 8.0 / 25.0 * t**2)
    rate = 2.0 * np.pi * (0.4 + 8.0 / 25.0 * t)
    q, v = 0.4 * np.sin(phase), 0.4 * rate * np.cos(phase)
    torque = 0.05 * np.gradient(v, t) + 0.2 * v + 0.4 * np.tanh(v / 0.01)
    early = np.interp(t + delay, t, torque)
    found = _energy(Recording(t, q, early))
    assert found.code == "late_torque"
    assert found.severity == "warning"
    assert float(found.advice.rsplit("delay = ", 1)[1].split(" ")[0]) == pytest.approx(delay, abs=6e-4)


def test_a_link_that_its_neighbour_drives_gets_no_advice_on_signs() -> None:
    t = np.arange(0.0, 30.0, 2e-3)
    q = 0.7 * np.sin(2.0 * np.pi * 0.5 * t) + 0.25 * np.sin(2.0 * np.pi * 1.3 * t + 1.0)
    v = np.gradient(q, t)
    torque = 0.02 * np.gradient(v, t) - 0.3 * v + np.random.default_rng(0).normal(0.0, 0.02, t.size)
    found = _energy(Recording(t, q, torque))
    assert found.code == "driven"
    assert "sign" not in found.advice


def _step_a_servo(seed: int, stiffness: float, rate: float) -> Recording:
    """A servo with a proportional loop that is stepped to random angles, and swings a few times after each."""
    dt, rng = 1e-3, np.random.default_rng(seed)
    inertia, damping, coulomb, limit = 0.006, 0.07, 0.05, 1.5
    q = v = 0.0
    rows = np.empty((60_000, 2))
    targets = np.repeat(rng.uniform(-1.2, 1.2, 60), 1000)
    for k, target in enumerate(targets):
        torque = float(np.clip(stiffness * (target - q) - damping * v, -limit, limit))
        free = v + dt * torque / inertia
        v = float(np.sign(free)) * max(abs(free) - dt * coulomb / inertia, 0.0)
        q += dt * v
        rows[k] = q, torque
    rows = rows[:: round(1.0 / (rate * dt))]
    return Recording(np.arange(len(rows)) / rate, rows[:, 0], rows[:, 1] + rng.normal(0.0, 0.004, len(rows)))


@pytest.mark.parametrize(("seed", "stiffness", "rate"), [(1, 6.0, 50.0), (2, 9.0, 50.0), (3, 5.0, 40.0)])
def test_a_servo_that_swings_faster_than_friction_is_averaged_has_no_turned_sign(
    seed: int, stiffness: float, rate: float
) -> None:
    log = _step_a_servo(seed, stiffness, rate)
    codes = {"flipped_torque", "late_torque", "driven"}
    assert not codes & {one.code for one in check_recording(log)}
    assert _energy(log.with_channels(torque=-log.torque)).code == "flipped_torque"

"""A stretch in which the drive is off while somebody moves the joint is left out, though its torque reads noise."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording
from fricomp.recording.parts.parts import find_usable_parts
from fricomp.recording.parts.silent import find_silent_rows

from ..joint_log import COULOMB, INERTIA, VISCOUS, joint_log


def _move_by_hand_first(log: Recording, seconds: float, noise: float, seed: int) -> Recording:
    rate = 1.0 / log.sample_period
    time = np.arange(round(seconds * rate)) / rate
    hand = log.position[0] + 0.5 * np.sin(1.1 * (time - time[-1])) * np.sin(0.6 * (time - time[-1]))
    torque = np.random.default_rng(seed).normal(0.0, noise, time.size)
    channels = {
        "time": np.concatenate([time, log.time - log.time[0] + seconds]),
        "position": np.concatenate([hand, log.position]),
        "torque": np.concatenate([torque, log.torque]),
    }
    return Recording.from_channels(channels, log.metadata)


@pytest.mark.parametrize(("rate", "noise", "seed"), [(400.0, 0.02, 1), (1000.0, 0.05, 2), (200.0, 0.01, 3)])
def test_a_joint_that_is_moved_by_hand_while_its_torque_is_noise_is_left_out_there(
    rate: float, noise: float, seed: int
) -> None:
    log = joint_log(25.0, rate, seed)
    recording = _move_by_hand_first(log, 9.0, noise, seed)
    silent = find_silent_rows(recording)
    by_hand = recording.time < 9.0
    assert np.mean(silent[by_hand]) > 0.9
    assert not silent[recording.time > 9.3].any()
    assert any("the drive gives no torque" in line for line in find_usable_parts(recording).sentences)


@pytest.mark.parametrize("seed", [4, 5])
def test_nothing_is_left_out_of_a_joint_whose_own_torque_moves_it(seed: int) -> None:
    log = joint_log(25.0, 400.0, seed)
    assert not find_silent_rows(log).any()


def test_a_joint_of_hardly_any_friction_keeps_its_rows() -> None:
    time = np.arange(0.0, 30.0, 2e-3)
    speed = np.where(time % 10.0 < 1.0, np.sin(2.0 * np.pi * time), 0.8 * np.sign(np.sin(2.0 * np.pi * time / 20.0)))
    position = np.cumsum(np.convolve(speed, np.ones(100) / 100.0, "same")) * 2e-3
    velocity = np.gradient(position, time)
    torque = 0.05 * np.gradient(velocity, time) + 1e-3 * np.sign(velocity)
    noisy = torque + np.random.default_rng(6).normal(0.0, 5e-3, time.size)
    assert not find_silent_rows(Recording(time, position, noisy)).any()


@pytest.mark.parametrize(("rate", "seed", "slows_in"), [(400.0, 1, 0.1), (1000.0, 2, 0.1), (200.0, 3, 0.15)])
def test_a_joint_that_a_brake_stops_while_its_drive_is_off_is_left_out_until_it_rests(
    rate: float, seed: int, slows_in: float
) -> None:
    log = joint_log(25.0, rate, seed)
    speed = np.gradient(log.position, log.time)
    stop = int(np.flatnonzero(np.abs(speed[: round(24.0 * rate)]) > 0.8 * np.abs(speed).max())[-1])
    after = np.arange(1, round(4.0 * rate)) / rate
    tail = log.position[stop] + speed[stop] * slows_in * (1.0 - np.exp(-after / slows_in))
    channels = {
        "time": np.concatenate([log.time[: stop + 1], log.time[stop] + after]),
        "position": np.concatenate([log.position[: stop + 1], np.round(tail / 1e-5) * 1e-5]),
        "torque": np.concatenate([log.torque[: stop + 1], np.zeros(after.size)]),
    }
    recording = Recording.from_channels(channels, log.metadata)
    silent = find_silent_rows(recording)
    assert silent[stop + 1 + round(0.03 * rate) : stop + round((slows_in + 0.03) * rate)].all()
    assert not silent[: stop - round(0.03 * rate)].any()


def test_a_joint_that_coasts_to_rest_without_torque_stays() -> None:
    log = joint_log(25.0, 400.0, 7)
    speed = np.gradient(log.position, log.time)
    stop = int(np.flatnonzero(np.abs(speed[: round(24.0 * 400)]) > 0.8 * np.abs(speed).max())[-1])
    q, v, dt = [float(log.position[stop])], float(speed[stop]), 1.0 / 400.0
    for _ in range(round(4.0 / dt)):
        slowed = abs(v) - dt * (COULOMB + VISCOUS * abs(v)) / INERTIA
        v = np.sign(v) * max(slowed, 0.0)
        q.append(q[-1] + dt * v)
    channels = {
        "time": np.concatenate([log.time[: stop + 1], log.time[stop] + dt * np.arange(1, len(q))]),
        "position": np.concatenate([log.position[: stop + 1], q[1:]]),
        "torque": np.concatenate([log.torque[: stop + 1], np.zeros(len(q) - 1)]),
    }
    assert not find_silent_rows(Recording.from_channels(channels, log.metadata)).any()

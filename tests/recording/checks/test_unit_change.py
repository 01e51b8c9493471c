"""A unit that changes within a log is named with the line that mends it; a quick motion is no such change."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording, check_recording

from ..joint_log import joint_log


def _changes(recording: Recording) -> list[str]:
    return [str(one) for one in check_recording(recording) if one.code == "unit_change"]


def _switch(log: Recording, part: float, factor: float, *names: str) -> Recording:
    later = np.arange(len(log)) >= round(part * len(log))
    return log.with_channels(**{name: np.where(later, factor, 1.0) * log.channels[name] for name in names})


@pytest.mark.parametrize(("part", "rate"), [(0.3, 50.0), (0.5, 250.0), (0.7, 500.0)])
@pytest.mark.parametrize("factor", [180.0 / np.pi, np.pi / 180.0, 1000.0])
def test_a_position_that_changes_its_unit_is_refused_with_the_time(part: float, rate: float, factor: float) -> None:
    log = joint_log(20.0, rate, 3)
    at = float(log.time[round(part * len(log))])
    (said,) = _changes(_switch(log, part, factor, "position", "velocity"))
    assert "position is" in said
    assert f"--to {at:.3f}" in said


def test_the_time_is_told_to_the_row_where_stamps_are_those_of_the_day() -> None:
    log = joint_log(20.0, 250.0, 3)
    since_1970 = log.with_channels(time=np.asarray(log.time) + 1.7e9)
    (said,) = _changes(_switch(since_1970, 0.5, 180.0 / np.pi, "position", "velocity"))
    assert "--to 1700000010.000" in said


def test_a_velocity_alone_that_changes_its_unit_is_told_as_well() -> None:
    (said,) = _changes(_switch(joint_log(20.0, 200.0, 4), 0.55, 180.0 / np.pi, "velocity"))
    assert "velocity is 57.3 times" in said


@pytest.mark.parametrize(("part", "factor", "rate"), [(0.4, 1000.0, 200.0), (0.6, 1e-3, 500.0)])
def test_a_torque_that_goes_on_in_thousandths_is_told_and_none_of_57_times(
    part: float, factor: float, rate: float
) -> None:
    log = joint_log(20.0, rate, 6)
    (said,) = _changes(_switch(log, part, factor, "torque"))
    assert "torque is" in said
    assert _changes(_switch(log, part, 180.0 / np.pi, "torque")) == []


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_rest_before_a_motion_and_a_quick_one_after_a_slow_one_are_none(seed: int) -> None:
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 20.0, 0.01)
    q = np.where(t < 8.0, 0.0, np.sin(3.0 * (t - 8.0))) + rng.normal(0.0, 1e-4, t.size)
    q_slow = np.where(t < 10.0, 0.02 * np.sin(t), 0.02 * np.sin(10.0) + np.sin(4.0 * (t - 10.0)))
    for position in (q, q_slow):
        speed = np.gradient(position, t)
        assert _changes(Recording(t, position, 0.3 * np.sign(speed) + 0.1 * speed, velocity=speed)) == []


@pytest.mark.parametrize(("seed", "size"), [(1, 1.0), (2, 30.0), (3, 0.01)])
def test_a_joint_that_comes_to_rest_with_a_few_kicks_of_its_encoder_is_none(seed: int, size: float) -> None:
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 40.0, 0.003)
    moves = (t < 25.0) | ((t > 30.0) & (t < 30.4))
    velocity = np.where(moves, np.sin(2.0 * t) + rng.normal(0.0, 0.1, t.size), rng.normal(0.0, 1e-4, t.size))
    first = int(np.flatnonzero(t > 30.0)[0])
    velocity[first - 40 : first] = 0.0
    velocity[first : first + 3] = -0.2, 0.13, -0.15
    position = np.cumsum(velocity) * 0.003
    assert _changes(Recording(t, size * position, np.sign(velocity), velocity=size * velocity)) == []


@pytest.mark.parametrize(("seed", "rate"), [(1, 500.0), (2, 250.0), (3, 1000.0)])
def test_a_velocity_that_ends_in_sticking_as_its_position_does_is_none(seed: int, rate: float) -> None:
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 20.0, 1.0 / rate)
    slow = 0.1 * np.sin(0.9 * t)
    v = np.where(t < 12.0, 1.8 * np.sin(2.1 * t), np.where(np.abs(slow) < 0.02, 0.0, slow))
    k = int(np.searchsorted(t, 12.0))
    v[k - 30 : k] = np.linspace(0.2, 0.0041, 30)
    v[k : k + 60] = 0.0
    v[k] = 0.0041 * np.pi / 180.0
    v = v + rng.normal(0.0, 2e-6, t.size)
    log = Recording(t, np.cumsum(v) / rate, np.sign(v) + 0.1 * v, velocity=v)
    assert _changes(log) == []

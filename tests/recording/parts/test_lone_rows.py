"""Single rows that leap, and rows that repeat the one before, are left out at low rates and at low speeds as well."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.recording import Recording
from fricomp.recording.parts.holds import find_stale_rows
from fricomp.recording.parts.strays import follow_motion

from ..joint_log import joint_log


@pytest.mark.parametrize(("rate", "seed"), [(50.0, 1), (100.0, 2), (500.0, 3)])
@pytest.mark.parametrize("to_zero", [True, False])
def test_single_rows_that_leap_and_come_back_are_none_of_the_motion(rate: float, seed: int, to_zero: bool) -> None:
    log, rng = joint_log(40.0, rate, seed), np.random.default_rng(seed)
    fastest = float(np.quantile(np.abs(np.diff(log.position)), 0.98))
    rows = rng.choice(np.arange(10, len(log) - 10, 7), 12, replace=False)
    position = np.array(log.position)
    position[rows] = (
        0.0 if to_zero else position[rows] + rng.choice([-1.0, 1.0], 12) * rng.uniform(4.0, 20.0, 12) * fastest
    )
    leaps = np.abs(position[rows] - log.position[rows]) > 4.0 * fastest
    keep = follow_motion(log.with_channels(position=position)).keep
    assert not keep[rows[leaps]].any()
    assert np.count_nonzero(~keep) <= rows.size


@pytest.mark.parametrize("seed", [4, 5])
@pytest.mark.parametrize("rate", [40.0, 100.0, 1000.0])
def test_no_row_of_a_quick_motion_is_one(rate: float, seed: int) -> None:
    log = joint_log(40.0, rate, seed)
    assert follow_motion(log).keep.all()
    time = np.arange(0.0, 20.0, 1.0 / rate)
    swing = np.round(0.4 * np.sin(2.0 * np.pi * 0.22 * rate * time) / 1e-3) * 1e-3  # five rows a swing
    assert follow_motion(Recording(time, swing, np.cos(time))).keep.all()


@pytest.mark.parametrize(("speed", "step", "rate"), [(0.03, 1.5e-6, 250.0), (0.2, 2.4e-5, 1000.0), (0.05, 1e-4, 100.0)])
def test_a_row_that_is_repeated_in_a_slow_even_motion_is_left_out(speed: float, step: float, rate: float) -> None:
    rng = np.random.default_rng(round(rate))
    time = np.arange(0.0, 20.0, 1.0 / rate)
    position = np.round(speed * time / step) * step
    torque = np.round((1.0 + 0.02 * rng.standard_normal(time.size)) / 1e-3) * 1e-3
    rows = rng.choice(np.arange(10, time.size - 10, 9), 30, replace=False)
    source = np.arange(time.size)
    source[rows] -= 1
    stale = find_stale_rows(Recording(time, position[source], torque[source]))
    assert set(np.flatnonzero(stale)) == set(rows)

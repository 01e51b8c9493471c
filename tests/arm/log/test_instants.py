"""Rows of a log whose stamps are not the instants of its samples."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.arm.log.instants import place_rows
from fricomp.recording import Recording, RecordingMetadata

PERIOD = 1e-3


def log(even: bool, *, velocity: bool = True) -> list[Recording]:
    """Two joints by a logger that reads states of 1 kHz late by up to a period, some twice and some never."""
    rng = np.random.default_rng(3)
    read = np.asarray(np.arange(4000) * PERIOD + (0.0 if even else rng.uniform(0.0, PERIOD, 4000)), dtype=np.float64)
    state = read if even else np.floor(read / PERIOD + rng.uniform(-0.3, 0.3, 4000)) * PERIOD
    state = np.maximum.accumulate(np.maximum(state, 0.0))
    series = []
    for j, rate in enumerate((1.3, 2.1)):
        phase = rate * state + j
        speed = rate * np.cos(phase) if velocity else None
        metadata = RecordingMetadata(joint=f"j{j}")
        series.append(Recording(read, np.sin(phase), np.cos(phase), velocity=speed, metadata=metadata))
    return series


def measure_error(one: Recording) -> float:
    """What stamps are off the instants at which the joint was where it was, a constant left aside [s]."""
    true = np.unwrap(np.arctan2(np.asarray(one.position), np.asarray(one.torque))) / 1.3
    return float(np.std(np.asarray(one.time) - true))


def test_rows_are_placed_where_the_joints_were() -> None:
    given, placed = log(even=False), place_rows(log(even=False))
    assert measure_error(given[0]) > 0.3 * PERIOD
    assert measure_error(placed[0]) < 0.03 * PERIOD
    assert np.all(np.diff(placed[0].time) > 0.0)
    assert np.array_equal(placed[0].time, placed[1].time)


@pytest.mark.parametrize("series", [log(even=True), log(even=False, velocity=False)])
def test_stamps_that_are_right_or_that_nothing_contradicts_stay(series: list[Recording]) -> None:
    assert all(np.array_equal(one.time, two.time) for one, two in zip(place_rows(series), series, strict=True))

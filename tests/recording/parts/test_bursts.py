"""Rows that come in bursts have the stamps of their arrival, unless the joint says that they were taken in bursts."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from fricomp.recording import Recording, check_recording
from fricomp.recording.parts.bursts import spread_bursts
from fricomp.recording.parts.parts import find_usable_parts

ROWS = 4000


def make(stamps: NDArray[np.floating[Any]], taken: NDArray[np.floating[Any]]) -> Recording:
    position = 0.8 * np.sin(2.3 * taken) + 0.3 * np.sin(5.1 * taken)
    return Recording.from_channels(
        {"time": np.asarray(stamps), "position": position, "torque": np.sign(np.cos(2.3 * taken))}
    )


@pytest.mark.parametrize(("size", "period", "within"), [(4, 0.002, 0.0004), (10, 0.001, 0.00005), (2, 0.005, 0.001)])
@pytest.mark.parametrize("late", [0.0, 0.1])
def test_rows_that_were_sent_together_are_spread(size: int, period: float, within: float, late: float) -> None:
    row, random = np.arange(ROWS), np.random.default_rng(7)
    arrival = (row // size) * size * period + late * period * random.random(ROWS // size + 1)[row // size]
    recording = make(arrival + row % size * within, row * period)
    spread, bursts = spread_bursts(recording)
    assert bursts is not None
    assert bursts.rows == size
    assert bursts.every == pytest.approx(size * period, rel=0.03)
    assert np.diff(spread.time) == pytest.approx(np.full(ROWS - 1, period), abs=0.15 * period)
    used = find_usable_parts(recording)
    assert len(used.parts) == 1
    assert f"rows come {size} at a time" in used.sentences[0]


@pytest.mark.parametrize(("size", "period", "late"), [(10, 1e-3, 3e-4), (5, 2e-3, 4e-4), (16, 5e-4, 4e-4)])
def test_bursts_are_told_however_uneven_the_stamps_within_are_and_come_out_even(
    size: int, period: float, late: float
) -> None:
    row, random = np.arange(ROWS), np.random.default_rng(size)
    last = np.minimum(row // size * size + size - 1, ROWS - 1)
    arrival = np.maximum.accumulate(last * period + late * random.random(ROWS)) + 1e-8 * row
    spread, bursts = spread_bursts(make(arrival, row * period))
    assert bursts is not None
    assert bursts.rows == size
    off = spread.time - row * period
    assert np.std(off - off.mean()) < 0.04 * period


def test_rows_that_were_taken_in_bursts_stay() -> None:
    row = np.arange(ROWS)
    taken = row // 4 * 0.008 + row % 4 * 0.0004
    assert spread_bursts(make(taken, taken))[1] is None


@pytest.mark.parametrize("every", [2, 5, 8])
def test_rows_that_are_missing_are_no_bursts(every: int) -> None:
    random = np.random.default_rng(every)
    row = np.flatnonzero(random.random(ROWS) > 1.0 / every)
    assert spread_bursts(make(0.002 * row, 0.002 * row))[1] is None


@pytest.mark.parametrize("rows", [2, 3, 4])
def test_a_recording_of_a_few_rows_is_checked(rows: int) -> None:
    time = 0.01 * np.arange(rows)
    channels = {"time": time, "position": time, "velocity": np.ones(rows), "torque": time}
    check_recording(Recording.from_channels(channels))

"""Where a mismatch sits: times as short as what is seen of it, other quantities by the rows."""

from __future__ import annotations

import numpy as np
import pytest

from fricomp.diagnosis.evidence.location import locate
from fricomp.diagnosis.record.result import RowSeries


def _series(time: np.ndarray) -> RowSeries:
    ramp = np.linspace(-1.0, 1.0, time.size)
    return RowSeries(
        name="recording",
        time=time,
        position=ramp,
        velocity=np.cos(40.0 * ramp),
        acceleration=ramp,
        load_torque=ramp,
        time_since_reversal=ramp,
        temperature=None,
        before=np.ones_like(ramp),
        after=np.ones_like(ramp),
        spread=np.ones_like(ramp),
    )


def test_an_event_between_two_rows_is_told_to_a_sample() -> None:
    rows, samples = 0.02 * np.arange(500), np.asarray(1e-3 * np.arange(10_000), dtype=np.float64)
    energy = ((samples > 5.0055) & (samples < 5.0155)).astype(np.float64)
    series = (_series(rows),)
    by_rows = np.exp(-(((rows - 5.01) / 0.015) ** 2))
    told = locate(series, [by_rows], samples=(samples, energy))
    (window,) = told["time"]
    assert window[1] - window[0] == pytest.approx(0.008, abs=1.1e-3)  # 80 % of ten samples
    assert 5.005 < window[0] < window[1] < 5.016
    assert told["position"] == locate(series, [by_rows])["position"]
    (coarse,) = locate(series, [by_rows])["time"]
    assert coarse[1] - coarse[0] > 0.019


def test_what_singles_a_mismatch_out_most_comes_first() -> None:
    rows = 0.02 * np.arange(500)
    series = (_series(rows),)
    slow = np.abs(series[0].velocity) < 0.05
    told = locate(series, [np.where(slow & (rows < 6.0), 1.0, 0.0)])
    assert [name for name in told if name in ("velocity", "position")] == ["velocity", "position"]
    told = locate(series, [np.where(slow, 1.0, 0.0) + 20.0 * (np.abs(rows - 3.0) < 0.2)])
    assert [name for name in told if name in ("velocity", "position")] == ["position", "velocity"]

"""Which rows of a log are missing, told by its stamps and by the way that the joint makes between them."""

import numpy as np
import pytest
from numpy.typing import NDArray

from fricomp.recording.row_numbers import count_rows


def _count(stamps: NDArray[np.float64], position: NDArray[np.float64], period: float) -> NDArray[np.float64]:
    """As `mend_clock` does: once more with what is known of the rows."""
    count = np.arange(stamps.size, dtype=np.float64)
    for told_by in (10, stamps.size, stamps.size):
        count = count_rows(stamps, position, period, count, told_by).numbers
        period = float(np.polyfit(count, stamps, 1)[0])
    return count


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_the_way_tells_where_a_row_is_missing(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = np.flatnonzero(rng.random(2000) >= 0.03)
    position = np.cumsum(1.0 + 0.5 * np.sin(0.01 * np.arange(2000)))[rows]
    stamps = rows + rng.normal(0.0, 0.4, rows.size)
    count = _count(stamps, position, 1.02)
    np.testing.assert_array_equal(count - count[0], rows - rows[0])


def test_stamps_alone_tell_how_many_rows_are_missing() -> None:
    rng = np.random.default_rng(3)
    rows = np.flatnonzero(rng.random(3000) >= 0.01)
    stamps = rows + rng.normal(0.0, 0.25, rows.size)
    count = _count(stamps, np.zeros(rows.size), 1.0)
    off = count - rows
    off -= np.median(off)
    assert np.mean(off != 0.0) < 0.02
    assert np.all(np.abs(off) <= 1.0)


def test_the_rate_of_a_clock_is_followed() -> None:
    rng = np.random.default_rng(4)
    rows = np.flatnonzero(rng.random(3000) >= 0.02)
    instants = rows + 3.0 * np.sin(2e-3 * rows)
    count = _count(instants + rng.normal(0.0, 0.2, rows.size), np.sin(1e-2 * instants), 1.0)
    off = count - rows
    assert np.mean(off != np.median(off)) < 0.01


def test_a_stamp_that_is_far_too_late_is_no_missing_row() -> None:
    stamps = np.arange(500.0)
    stamps[200] += 0.9
    stamps[300:303] += (2.4, 1.6, 0.8)
    count = count_rows(stamps, np.zeros(500), 1.0, np.arange(500.0), 200).numbers
    np.testing.assert_array_equal(count, np.arange(500.0))

"""The clock of a log: its error is estimated, and stamps are replaced only where they are wrong."""

import numpy as np
import pytest

from fricomp.recording.clock import mend_clock

from .joint_log import joint_log


@pytest.mark.parametrize("rate", [300.0, 400.0, 700.0, 130.0])
def test_stamps_in_milliseconds_become_even(rate: float) -> None:
    log = joint_log(20.0, rate, 1)
    mended, clock = mend_clock(log.with_channels(time=np.round(log.time, 3)))
    assert clock.mended
    assert clock.tick == 1e-3
    assert clock.period == pytest.approx(1.0 / rate, rel=1e-4)
    assert 1e-4 < clock.error < 6e-4
    np.testing.assert_allclose(np.diff(mended.time), 1.0 / rate, rtol=1e-4)
    assert mended.metadata.clock_error == clock.error


@pytest.mark.parametrize("jitter", [2e-5, 1e-4, 3e-4])
def test_noise_of_the_stamps_is_estimated_and_taken_off(jitter: float) -> None:
    log = joint_log(20.0, 500.0, 2)
    stamps = log.time + np.random.default_rng(3).normal(0.0, jitter, len(log))
    mended, clock = mend_clock(log.with_channels(time=np.sort(stamps)))
    assert clock.error == pytest.approx(jitter, rel=0.15)
    assert np.max(np.abs(mended.time - log.time)) < 0.1 * jitter + 1e-5


def test_samples_that_are_uneven_themselves_keep_their_stamps() -> None:
    fine = joint_log(20.0, 2000.0, 4)
    offsets = np.random.default_rng(5).integers(-3, 4, 5000 // 2)
    rows = np.arange(offsets.size) * 16 + 8 + offsets  # 125 Hz, up to 1.5 ms early or late, and stamped rightly
    uneven = fine.rows(rows)
    mended, clock = mend_clock(uneven)
    assert not clock.mended
    np.testing.assert_array_equal(mended.time, uneven.time)


def test_missing_rows_are_no_error_of_the_clock() -> None:
    log = joint_log(20.0, 500.0, 6)
    keep = np.random.default_rng(7).random(len(log)) > 0.1
    thinned = log.rows(keep)
    mended, clock = mend_clock(thinned)
    assert not clock.mended
    np.testing.assert_array_equal(mended.time, thinned.time)


def test_two_parts_of_a_log_have_each_their_own_grid() -> None:
    log = joint_log(20.0, 300.0, 8)
    stamps = np.round(np.where(log.time > 10.0, log.time + 7.0016, log.time), 3)
    mended, clock = mend_clock(log.with_channels(time=stamps))
    assert clock.mended
    assert np.max(np.abs(np.diff(mended.time)[:2990] - 1.0 / 300.0)) < 1e-5

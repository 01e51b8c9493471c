"""Rows that are missing from a log whose stamps are the numbers of its rows."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fricomp.recording import Recording
from fricomp.recording.parts.missing import count_missing_rows

Samples = NDArray[np.float64]


def _log(rate: float, bits: int, keep: NDArray[np.bool_], seed: int) -> Recording:
    """A swinging joint, read by an encoder of so many bits; of all rows those to keep, numbered as they are written."""
    rng = np.random.default_rng(seed)
    time = np.arange(keep.size) / rate
    phases = rng.uniform(0.0, 6.28, 3)
    position = sum(
        a * np.sin(6.28 * f * time + p) for a, f, p in zip((1.0, 0.5, 0.3), (0.3, 0.9, 1.7), phases, strict=True)
    )
    step = 2 * np.pi / 2**bits
    read = np.round(np.asarray(position)[keep] / step) * step
    return Recording(np.arange(read.size) / rate, read, rng.standard_normal(read.size))


def _lose(size: int, share: float, longest: int, seed: int) -> NDArray[np.bool_]:
    rng = np.random.default_rng(seed)
    keep = np.ones(size, dtype=bool)
    for row in rng.integers(30, size - 30, int(2 * size * share / (1 + longest))):
        keep[row : row + rng.integers(1, longest + 1)] = False
    return keep


@pytest.mark.parametrize(("rate", "bits"), [(1000.0, 14), (1000.0, 17), (250.0, 12), (100.0, 12)])
@pytest.mark.parametrize("longest", [1, 10])
@pytest.mark.parametrize("share", [0.01, 0.03])
def test_rows_that_are_missing_are_counted_where_the_joint_is_clear_of_the_encoder(
    rate: float, bits: int, longest: int, share: float
) -> None:
    keep = _lose(round(40 * rate), share, longest, 3)
    found, missing = count_missing_rows(_log(rate, bits, keep, 3))
    if missing is None:
        assert rate * 40 * share / longest < 40  # too few places
        return
    true = np.flatnonzero(keep) / rate
    lost = int(np.count_nonzero(~keep))
    assert 0.2 * lost < missing.rows < 1.05 * lost
    late = np.diff(found.time) - np.diff(true)
    way = np.abs(np.diff(found.position))
    clear = way > 0.5 * np.quantile(way, 0.95)
    gone = np.abs(np.diff(true) - 1 / rate)  # while several rows are missing, a joint does not move evenly
    assert np.sum(np.abs(late[clear])) < 0.3 * np.sum(gone[clear])


@pytest.mark.parametrize(("rate", "bits"), [(1000.0, 12), (1000.0, 19), (100.0, 14)])
def test_nothing_is_counted_where_no_row_is_missing(rate: float, bits: int) -> None:
    recording = _log(rate, bits, np.ones(round(30 * rate), dtype=bool), 5)
    assert count_missing_rows(recording) == (recording, None)


def test_a_joint_that_knocks_misses_no_rows() -> None:
    recording = _log(500.0, 18, np.ones(20000, dtype=bool), 7)
    position = np.array(recording.position)
    for row in np.random.default_rng(1).integers(100, 19000, 60):
        position[row : row + 2] += 0.004 * np.array([1.0, -0.6])
    knocked = recording.with_channels(position=position)
    assert count_missing_rows(knocked)[1] is None


def test_stamps_that_tell_what_is_missing_stay() -> None:
    keep = _lose(20000, 0.02, 1, 2)
    recording = _log(500.0, 17, keep, 2).with_channels(time=np.flatnonzero(keep) / 500.0)
    assert count_missing_rows(recording) == (recording, None)


@pytest.mark.parametrize(("rate", "bits"), [(1000.0, 14), (500.0, 13), (250.0, 12)])
def test_how_many_are_missing_unseen_is_told_where_a_coarse_encoder_hides_them(rate: float, bits: int) -> None:
    keep = _lose(round(60 * rate), 0.02, 1, 7)
    _, missing = count_missing_rows(_log(rate, bits, keep, 7))
    assert missing is not None
    told = int(missing.sentence.split(": some ")[1].split()[0])
    assert missing.rows + told == pytest.approx(int(np.count_nonzero(~keep)), rel=0.25)
    assert "Log the time of the device" in missing.sentence

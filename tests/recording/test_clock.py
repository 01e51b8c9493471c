"""The clock of a log: its error is estimated, and stamps are replaced only where they are wrong."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from fricomp.recording import Recording, RecordingWarning, read_recording
from fricomp.recording.clock import mend_clock
from fricomp.recording.validity import mend_stamps

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


def test_rows_missing_of_an_even_clock_are_counted_by_it_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    def guess(*_: object) -> None:
        raise AssertionError("its steps are whole periods: nothing is to be guessed, which takes seconds in a long log")

    monkeypatch.setattr("fricomp.recording.clock.count_rows", guess)
    log = joint_log(20.0, 1000.0, 11)
    kept = np.ones(len(log), dtype=bool)
    kept[[31, 700, 701, 9000, 15000]] = False
    mended, clock = mend_clock(log.rows(kept))
    assert not clock.mended
    np.testing.assert_array_equal(mended.time, log.time[kept])


def test_two_parts_of_a_log_have_each_their_own_grid() -> None:
    log = joint_log(20.0, 300.0, 8)
    stamps = np.round(np.where(log.time > 10.0, log.time + 7.0016, log.time), 3)
    mended, clock = mend_clock(log.with_channels(time=stamps))
    assert clock.mended
    assert np.max(np.abs(np.diff(mended.time)[:2990] - 1.0 / 300.0)) < 1e-5


@pytest.mark.parametrize(("rate", "jitter"), [(500.0, 1e-4), (250.0, 3e-4)])
def test_noise_is_taken_off_a_clock_that_wanders(rate: float, jitter: float) -> None:
    log = joint_log(24.0, rate, 9)
    wanders = log.time + 4e-3 * np.sin(0.8 * log.time) + 1e-3 * np.maximum(log.time - 14.0, 0.0)
    stamps = wanders + np.random.default_rng(10).normal(0.0, jitter, len(log))
    mended, clock = mend_clock(log.with_channels(time=np.sort(stamps)))
    assert clock.mended
    assert clock.error == pytest.approx(jitter, rel=0.15)
    inner = slice(round(0.5 * rate), -round(0.5 * rate))
    assert np.std((mended.time - wanders)[inner]) < 0.3 * jitter


def test_a_clock_that_wanders_smoothly_keeps_its_stamps() -> None:
    log = joint_log(20.0, 400.0, 11)
    wanders = log.with_channels(time=log.time + 2e-3 * np.sin(1.1 * log.time))
    mended, clock = mend_clock(wanders)
    assert not clock.mended
    np.testing.assert_array_equal(mended.time, wanders.time)


@pytest.mark.parametrize(("rate", "jitter", "suffix"), [(1000.0, 3e-4, ".csv"), (250.0, 1.4e-3, ".parquet")])
def test_rows_that_a_clock_stamps_before_those_they_follow_are_kept(
    rate: float, jitter: float, suffix: str, tmp_path: Path
) -> None:
    log = joint_log(20.0, rate, 9)
    stamps = log.time + np.random.default_rng(10).normal(0.0, jitter, len(log))
    assert np.any(np.diff(stamps) < 0.0)
    table = pd.DataFrame({"time": stamps, "position": log.position, "torque": log.torque})
    path = tmp_path / f"log{suffix}"
    if suffix == ".csv":
        table.to_csv(path, index=False)
    else:
        table.to_parquet(path)
    with pytest.warns(RecordingWarning, match="stamped no later than the one before"):
        read = read_recording(path)
    assert len(read) == len(log)
    mended, clock = mend_clock(read)
    assert clock.mended
    assert clock.error == pytest.approx(jitter, rel=0.1)
    assert np.max(np.abs(np.asarray(mended.time) - log.time)) < 0.1 * jitter


@pytest.mark.parametrize(
    ("rate", "jitter", "lost", "rounded"),
    [(100.0, 0.35, 0.05, False), (250.0, 0.45, 0.01, True), (700.0, 0.25, 0.05, False), (1000.0, 0.2, 0.01, True)],
)
def test_rows_are_missing_between_stamps_that_jitter(rate: float, jitter: float, lost: float, rounded: bool) -> None:
    log = joint_log(3000.0 / rate, rate, 12)
    rng = np.random.default_rng(13)
    keep = rng.random(len(log)) >= lost
    keep[1500:1523] = keep[1700:1712] = False
    stamps = log.time + rng.normal(0.0, jitter / rate, len(log))
    stamps = np.round(stamps, 3) if rounded else stamps
    channels = {"time": stamps[keep], "position": log.position[keep], "torque": log.torque[keep]}
    risen, _ = mend_stamps(channels)
    assert len(risen["time"]) == np.count_nonzero(keep)  # a row that is stamped as the one before is none less
    mended, clock = mend_clock(Recording.from_channels(risen))
    assert clock.mended
    off = np.asarray(mended.time) - log.time[keep]
    speed = np.abs(np.gradient(np.asarray(log.position), log.time))[keep]
    assert np.std(off * speed) < 0.2 * jitter / rate * np.sqrt(np.mean(speed**2))  # a joint at rest tells no row


def test_rows_of_another_stamped_alike_are_left_out() -> None:
    log = joint_log(10.0, 100.0, 14)
    rows = np.sort(np.concatenate([np.arange(len(log)), np.arange(30, len(log), 17)]))
    channels = {name: np.array(values[rows]) for name, values in log.channels.items()}
    channels["torque"] += 1e-3 * np.arange(rows.size)
    kept, found = mend_stamps(channels)
    assert found[0].code == "repeated_rows"
    np.testing.assert_array_equal(kept["time"], log.time)


def test_a_clock_that_was_set_back_is_refused() -> None:
    time = np.concatenate([np.arange(0.0, 2.0, 0.01), np.arange(1.5, 3.0, 0.01)])
    channels, found = mend_stamps({"time": time, "position": np.sin(time)})
    assert not found
    np.testing.assert_array_equal(channels["time"], time)

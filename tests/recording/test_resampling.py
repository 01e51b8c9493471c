"""Resampling: exact on smooth signals, no delay, nothing folded down from above the new Nyquist."""

from collections.abc import Callable

import numpy as np
import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Recording, check_recording, resample
from fricomp.recording.resampling import resample_checked

MakeRecording = Callable[..., Recording]


def _inner(recording: Recording) -> slice:
    return slice(len(recording) // 10, -len(recording) // 10)


@pytest.mark.parametrize("rate", [250.0, 333.0, 1000.0, 2500.0])
def test_smooth_motion_keeps_value_and_phase_at_any_rate(make_recording: MakeRecording, rate: float) -> None:
    result = resample(make_recording(), rate)
    inner = _inner(result)
    assert np.ptp(np.diff(result.time)) < 1e-9
    assert 1 / result.sample_period == pytest.approx(rate)
    assert result.time[-1] <= make_recording().time[-1] + 1e-9
    assert np.abs(result.position - 0.8 * np.sin(np.pi * result.time))[inner].max() < 2e-6


def test_uneven_times_are_evened_without_error_of_first_or_second_order(make_recording: MakeRecording) -> None:
    recording = make_recording()
    time = recording.time + np.random.default_rng(4).uniform(-4e-4, 4e-4, len(recording))
    uneven = recording.with_channels(time=time, position=0.8 * np.sin(np.pi * time))
    result = resample(uneven, 1000.0)
    assert np.abs(result.position - 0.8 * np.sin(np.pi * result.time))[_inner(result)].max() < 1e-6


def test_decimation_removes_what_would_fold_and_keeps_the_band(make_recording: MakeRecording) -> None:
    recording = make_recording(10000)
    keep, fold = np.sin(2 * np.pi * 10 * recording.time), np.sin(2 * np.pi * 130 * recording.time)
    result = resample(recording.with_channels(torque=keep + fold), 100.0)
    error = result.torque - np.sin(2 * np.pi * 10 * result.time)
    assert np.abs(error[_inner(result)]).max() < 2e-3


def test_a_trend_and_a_constant_pass_unchanged_to_the_ends(make_recording: MakeRecording) -> None:
    recording = make_recording()
    result = resample(recording.with_channels(position=2 + 3 * recording.time, velocity=np.full(4000, 3.0)), 100.0)
    assert np.abs(result.position - 2 - 3 * result.time).max() < 1e-9
    assert result.velocity is not None
    assert np.abs(result.velocity - 3).max() < 1e-12


@pytest.mark.parametrize("rate", [0.0, -5.0, float("nan"), float("inf"), 0.1])
def test_impossible_rates_are_refused(make_recording: MakeRecording, rate: float) -> None:
    with pytest.raises(RecordingError, match="give a higher, finite rate"):
        resample(make_recording(), rate)


@pytest.mark.parametrize("rate", [300.0, 2500.0])
def test_a_gap_stays_a_gap(make_recording: MakeRecording, rate: float) -> None:
    whole = make_recording(8000)
    recording = whole.rows((whole.time < 2.0) | (whole.time > 5.0))
    result = resample(recording, rate)
    assert not ((result.time > 2.0) & (result.time < 5.0)).any()
    assert [finding.code for finding in check_recording(result)] == ["gap"]
    error = np.abs(result.position - 0.8 * np.sin(np.pi * result.time))
    near_an_end = (np.abs(result.time[:, None] - [0.0, 2.0, 5.0, 8.0]) < 0.05).any(axis=1)
    assert error[~near_an_end].max() < 2e-6


def test_a_change_of_rate_is_no_gap(make_recording: MakeRecording) -> None:
    rows = np.concatenate([np.arange(3000), np.arange(3000, 4000, 10)])
    result = resample(make_recording().rows(rows), 500.0)
    assert np.ptp(np.diff(result.time)) < 1e-9
    assert np.abs(result.position - 0.8 * np.sin(np.pi * result.time))[_inner(result)].max() < 1e-4


def test_what_the_checks_found_before_is_kept(make_recording: MakeRecording) -> None:
    recording = make_recording()
    slow = recording.with_channels(time=1000.0 * recording.time)
    result, found = resample_checked(slow, 500.0)
    assert "time_unit" in [finding.code for finding in found]
    assert "time_unit" not in [finding.code for finding in check_recording(result)]

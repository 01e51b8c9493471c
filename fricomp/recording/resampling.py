"""Uniform resampling without aliasing; what is missing stays missing.

Between samples the signal is a cubic through both neighbours with the slopes of the samples around
(Catmull-Rom for uneven steps), so nothing is delayed. A lower rate is reached through a symmetric
low-pass (a Kaiser-windowed sinc [kaiser1974], 60 dB, cut at 0.45 of the new rate); every channel sees the same one.
"""

from math import ceil, pi

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import RecordingError
from fricomp.recording.checks.checks import CheckedRecording, check_recording
from fricomp.recording.checks.timing_checks import GAP_PERIODS, locate_gaps
from fricomp.recording.recording import Recording
from fricomp.recording.validity import Samples

_MOST_ROWS = 2e8  # of a result: more does not fit into memory, and comes from a corrupt stamp
_ATTENUATION = 60.0  # [dB]
_TRANSITION = 0.1  # width of the filter's edge, as a part of the new rate
_CUTOFF = 0.45  # middle of the edge, as a part of the new rate: its end is the new Nyquist frequency
_AROUND = 10  # steps to either side that a gap is compared with
_MENDED = ("jitter", "two_rates")  # findings whose remedy is to resample


def resample(recording: Recording, rate: float) -> Recording:
    """Return the recording at a uniform rate, from its first to its last sample.

    A gap, a step of time longer than five periods and than one of the new ones, stays a gap: the parts between are
    filtered and interpolated each on its own.

    Args:
        recording: Samples at any times.
        rate: New rate [Hz].

    Raises:
        RecordingError: The rate is not positive or leaves fewer than two samples.
    """
    if not (np.isfinite(rate) and rate > 0) or recording.duration * rate < 1:
        raise RecordingError(f"cannot resample {recording.duration:.6g} s at {rate} Hz: give a higher, finite rate")
    if recording.duration * rate > _MOST_ROWS:
        is_rate = len(recording) > 0.5 * recording.duration / recording.sample_period
        advice = (
            f"give a lower rate, such as the recording's own {1.0 / recording.sample_period:.4g} Hz"
            if is_rate
            else "a stamp is far from all others; leave its row out (fricomp convert --skip-bad-rows)"
        )
        raise RecordingError(f"{recording.duration:.6g} s at {rate:g} Hz are more than {_MOST_ROWS:.0e} rows: {advice}")
    period = recording.sample_period
    target = recording.time[0] + np.arange(int(recording.duration * rate * (1 + 1e-12)) + 1) / rate
    kernel = _low_pass(rate * period) if rate * period < 1 - 1e-9 else None
    gaps = _find_gaps(recording, rate)
    starts = np.searchsorted(target, recording.time[gaps + 1])
    stops = np.searchsorted(target, recording.time[gaps], side="right")
    firsts, lasts = [0, *(gaps + 1)], [*(gaps + 1), len(recording)]
    parts = [
        _resample_part({n: values[a:b] for n, values in recording.channels.items()}, target[start:stop], period, kernel)
        for a, b, start, stop in zip(firsts, lasts, [0, *starts], [*stops, target.size], strict=True)
        if b - a > 1
    ]
    channels = {name: np.concatenate([part[name] for part in parts]) for name in recording.channels}
    return Recording.from_channels(channels, recording.metadata)


def resample_checked(recording: Recording, rate: float) -> CheckedRecording:
    """Resample, and keep what the checks found before, which interpolation hides from them.

    Raises:
        RecordingError: As for `resample`.
    """
    found = tuple(finding for finding in check_recording(recording) if finding.code not in _MENDED)
    return CheckedRecording(resample(recording, rate), found)


def _find_gaps(recording: Recording, rate: float) -> NDArray[np.intp]:
    """Rows before steps that are long beside those around them as well; a change of rate is no gap. Shape (n_gaps,)."""
    step, gaps = np.diff(recording.time), locate_gaps(recording, 1.0 / rate)
    around = np.clip(gaps[:, None] + np.arange(-_AROUND, _AROUND + 1), 0, step.size - 1)
    return np.asarray(gaps[step[gaps] > GAP_PERIODS * np.median(step[around], axis=1)])


def _resample_part(
    channels: dict[str, Samples], target: Samples, period: float, kernel: Samples | None
) -> dict[str, Samples]:
    """The channels at the times `target` [s], to lower rates through a low-pass on an even grid of `period` [s]."""
    time = grid = channels["time"]
    if kernel is not None:
        grid = time[0] + np.arange(max(round((time[-1] - time[0]) / period), 1) + 1) * period
    part = {"time": target}
    for name, values in channels.items():
        if name == "time":
            continue
        even = values if kernel is None else _filter(_interpolate(time, values, grid), kernel)
        part[name] = _interpolate(grid, even, target)
    return part


def _interpolate(time: Samples, values: Samples, target: Samples) -> Samples:
    """Cubic Hermite interpolation with slopes from the neighbouring samples."""
    slope = np.gradient(values, time)
    left = np.clip(np.searchsorted(time, target, side="right") - 1, 0, time.size - 2)
    step = time[left + 1] - time[left]
    u = np.clip((target - time[left]) / step, 0.0, 1.0)
    start = (1 + 2 * u) * values[left] + u * step * slope[left]
    end = (3 - 2 * u) * values[left + 1] + (u - 1) * step * slope[left + 1]
    return np.asarray((1 - u) ** 2 * start + u**2 * end, dtype=np.float64)


def _low_pass(ratio: float) -> Samples:
    """Windowed sinc for a new rate of `ratio` times the old one; sums to one."""
    half = ceil((_ATTENUATION - 8) / (2.285 * 2 * pi * _TRANSITION * ratio) / 2)
    k = np.arange(-half, half + 1)
    window = np.kaiser(k.size, 0.1102 * (_ATTENUATION - 8.7))
    kernel = np.sinc(2 * _CUTOFF * ratio * k) * window
    return np.asarray(kernel / kernel.sum(), dtype=np.float64)


def _filter(values: Samples, kernel: Samples) -> Samples:
    """Convolve with odd extension at both ends, so that a trend goes through unchanged."""
    half = kernel.size // 2
    reach = min(half, values.size - 1)
    before = 2 * values[0] - values[reach:0:-1]
    after = 2 * values[-1] - values[-2 : -reach - 2 : -1]
    padded = np.pad(np.concatenate([before, values, after]), half - reach, mode="edge")
    return np.convolve(padded, kernel, mode="valid")

"""A recorded motion as models are evaluated on it: one grid a part, derivatives, and where the joint moves."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, savgol_filter, sosfiltfilt

from fricomp.errors import RecordingError
from fricomp.laws import FloatArray
from fricomp.recording import Recording, resample
from fricomp.root_mean_square import compute_rms

from .settings import EVALUATION

Index = NDArray[np.intp]
Rows = NDArray[np.bool_]

_GAP = 5.0  # periods; a longer step of time is a gap
_FEWEST = 50  # samples of a part, which the filters need
_EVEN = 1e-3  # deviation of stamps from an even grid, in periods, below which the samples are taken as they are
_CHANNELS = ("load_torque", "normal_load", "temperature")
_DEGREE, _WINDOW = 3, 0.02  # of the local polynomial that estimates a velocity: its degree, and its length [s]


@dataclass(frozen=True)
class MotionPart:
    """Samples between two gaps. Arrays of shape (n,).

    Attributes:
        time: On an even grid [s].
        position: As recorded [rad] or [m].
        velocity: State of a simulation: recorded, or estimated from the position [rad/s] or [m/s].
        smooth_velocity: From the position in the band [rad/s] or [m/s].
        acceleration: Likewise [rad/s²] or [m/s²].
        torque: As recorded.
        moves: Whether the joint moves, and the filters have settled.
        channels: Load torque, normal load and temperature, where they were recorded.
    """

    time: FloatArray
    position: FloatArray
    velocity: FloatArray
    smooth_velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    moves: Rows
    channels: Mapping[str, FloatArray]

    @property
    def dt(self) -> float:
        """Time between samples [s]."""
        return float(self.time[1] - self.time[0])

    @cached_property
    def waves(self) -> tuple[FloatArray, FloatArray]:
        """Cosine and sine of the position, which gravity asks for again and again."""
        return np.cos(self.position), np.sin(self.position)


@dataclass(frozen=True)
class RecordedMotion:
    """What models are evaluated on.

    Attributes:
        parts: Between the gaps.
        band: Upper end of the band of torque errors [Hz].
        rest_speed: Speed below which the joint counts as resting [rad/s] or [m/s].
        velocity_recorded: Whether the velocity of the states was recorded.
        torque_unit: Of the recording.
        position_unit: `rad` or `m`.
        range: Of the position [rad] or [m].
    """

    parts: tuple[MotionPart, ...]
    band: float
    rest_speed: float
    velocity_recorded: bool
    torque_unit: str
    position_unit: str
    range: float

    @property
    def dt(self) -> float:
        """Time between samples [s]."""
        return self.parts[0].dt


def read_motion(recording: Recording, *, band: float | None = None) -> RecordedMotion:
    """Bring a recording onto even grids, and find in which band its motion is known.

    Args:
        recording: Its torque on the side of the joint.
        band: Upper end of the band [Hz]; chosen where it is None.

    Raises:
        RecordingError: It is too short, never moves, or the band does not fit its rate.
    """
    rows = _split_at_gaps(recording)
    if not rows:
        raise RecordingError(
            f"the recording has no {EVALUATION.shortest_part:g} s between gaps: an evaluation needs a longer one"
        )
    rate = 1.0 / recording.sample_period
    band = _choose_band(rows, rate) if band is None else _check_band(band, rate)
    smooth = [_differentiate(one, rate, band) for one in rows]
    rest = _find_rest_speed(recording, [velocity for velocity, _ in smooth], band)
    recorded = _has_velocity(rows, [velocity for velocity, _ in smooth], band)
    parts = tuple(_build_part(one, v, a, rest, band, recorded) for one, (v, a) in zip(rows, smooth, strict=True))
    if not any(part.moves.any() for part in parts):
        raise RecordingError("the joint never moves in this recording: an evaluation needs a motion")
    metadata = recording.metadata
    position = np.asarray(recording.position)
    return RecordedMotion(
        parts, band, rest, recorded, metadata.torque_unit, metadata.position_unit, float(np.ptp(position))
    )


def find_band(recording: Recording, noise_share: float) -> float:
    """Find the upper end of the widest band in which little of the acceleration is noise of the encoder [Hz].

    The narrowest band that is tried, where the recording has no part long enough to tell.

    Args:
        recording: Any motion of one joint.
        noise_share: Part of the acceleration's power that may be noise.
    """
    rows = _split_at_gaps(recording)
    return _choose_band(rows, 1.0 / recording.sample_period, noise_share) if rows else EVALUATION.bands[-1]


def low_pass(values: FloatArray, band: float, dt: float) -> FloatArray:
    """Butterworth low-pass up to `band` [Hz], forward and backward, so that nothing is delayed. Shape (n,)."""
    result: FloatArray = sosfiltfilt(_design_low_pass(band, dt), values)
    return result


@lru_cache(maxsize=64)
def _design_low_pass(band: float, dt: float) -> FloatArray:
    """Sections of the low-pass; a refit filters thousands of times with the same, and its design takes longer than that
    of filtering. Nobody writes into it."""
    sections: FloatArray = butter(EVALUATION.order, band, fs=1.0 / dt, output="sos")
    return sections


def _split_at_gaps(recording: Recording) -> list[Recording]:
    time, period = np.asarray(recording.time), recording.sample_period
    gaps = np.flatnonzero(np.diff(time) > _GAP * period) + 1
    spans = [(a, b) for a, b in pairwise([0, *gaps.tolist(), len(recording)]) if b - a > _FEWEST]
    parts = [recording.rows(slice(a, b)) for a, b in spans]
    long = [one for one in parts if one.duration >= EVALUATION.shortest_part]
    return [one if _is_even(one, period) else resample(one, 1.0 / period) for one in long]


def _is_even(recording: Recording, period: float) -> bool:
    time = np.asarray(recording.time)
    return bool(np.max(np.abs(np.diff(time) - period)) < _EVEN * period)


def _check_band(band: float, rate: float) -> float:
    if not 0.0 < band <= 0.4 * rate:
        raise RecordingError(
            f"a band up to {band:g} Hz does not fit samples at {rate:.4g} Hz: give up to {0.4 * rate:.3g}"
        )
    return band


def _choose_band(rows: list[Recording], rate: float, noise_share: float = EVALUATION.noise_share) -> float:
    """The same of the parts between gaps.

    White noise of the density S in the position gives (2 pi)^4 S f^5 / 5 of acceleration up to the frequency f.
    """
    fits = [one for one in EVALUATION.bands if one <= EVALUATION.of_rate * rate] or [EVALUATION.of_rate * rate]
    noise = float(np.median([np.median(np.abs(np.diff(one.position, 4))) / (0.6745 * 70.0**0.5) for one in rows]))
    quantum = min(_find_step(np.asarray(one.position)) for one in rows)
    density = 2.0 / rate * max(noise**2, quantum**2 / 12.0)
    for band in fits:
        power = float(np.mean([np.var(_differentiate(one, rate, band)[1]) for one in rows]))
        if (2.0 * np.pi) ** 4 * density * band**5 / 5.0 <= noise_share * power:
            return band
    return fits[-1]


def _find_step(position: FloatArray) -> float:
    """Least distance of neighbouring values; next to nothing of a position that is not quantised."""
    steps = np.abs(np.diff(position))
    return float(np.min(steps[steps > 0.0], initial=np.inf)) if np.any(steps > 0.0) else 0.0


def _differentiate(recording: Recording, rate: float, band: float) -> tuple[FloatArray, FloatArray]:
    """Velocity and acceleration of the position below the cutoff."""
    cutoff = min(EVALUATION.wider * band, 0.45 * rate)
    smooth = low_pass(np.asarray(recording.position), cutoff, 1.0 / rate)
    velocity = np.gradient(smooth, 1.0 / rate)
    return velocity, np.gradient(velocity, 1.0 / rate)


def _find_rest_speed(recording: Recording, velocities: list[FloatArray], band: float) -> float:
    speed = np.abs(np.concatenate(velocities))
    top = float(np.quantile(speed, EVALUATION.top))
    step = _find_step(np.asarray(recording.position))
    return min(max(EVALUATION.slowest * top, EVALUATION.counts * step * band), 0.2 * top)


def _has_velocity(rows: list[Recording], smooth: list[FloatArray], band: float) -> bool:
    """Whether a velocity was recorded that is the slope of the position at the same instant."""
    if any(one.velocity is None for one in rows):
        return False
    recorded = np.concatenate([low_pass(np.asarray(one.velocity), band, one.sample_period) for one in rows])
    slope = np.concatenate([low_pass(v, band, one.sample_period) for v, one in zip(smooth, rows, strict=True)])
    off = compute_rms(recorded - slope)
    return off < EVALUATION.velocity_lag * compute_rms(slope)


def _build_part(
    recording: Recording, velocity: FloatArray, acceleration: FloatArray, rest: float, band: float, recorded: bool
) -> MotionPart:
    time = np.asarray(recording.time)
    dt = recording.sample_period
    moves = np.abs(velocity) > rest
    margin = min(int(EVALUATION.margin / band / dt) + 1, moves.size // 4)
    moves[:margin] = moves[moves.size - margin :] = False
    return MotionPart(
        time=time[0] + dt * np.arange(time.size),
        position=np.asarray(recording.position),
        velocity=np.asarray(recording.velocity) if recorded else _estimate_velocity(recording, band),
        smooth_velocity=velocity,
        acceleration=acceleration,
        torque=np.asarray(recording.torque),
        moves=moves,
        channels={name: recording.channels[name] for name in _CHANNELS if name in recording.channels},
    )


def _estimate_velocity(recording: Recording, band: float) -> FloatArray:
    """Slope of a local cubic, over a time that is short enough to follow what the band holds. Shape (n,)."""
    dt = recording.sample_period
    window = 2 * round(max(_WINDOW, 0.5 / band) / dt / 2) + 1
    window = int(np.clip(window, 5, (len(recording) - 1) // 2 * 2 - 1))
    result: FloatArray = savgol_filter(np.asarray(recording.position), window, _DEGREE, deriv=1, delta=dt)
    return result


def join_motions(motions: Sequence[RecordedMotion]) -> RecordedMotion:
    """Motions of one joint in one band as parts of one, in the order given.

    Where their times overlap, as those of recordings do that all begin at 0, the later ones are moved behind them.

    Args:
        motions: At least one.
    """
    parts: list[MotionPart] = []
    for motion in motions:
        end = parts[-1].time[-1] if parts else -np.inf
        late = max(0.0, end + 1.0 - motion.parts[0].time[0]) if motion.parts[0].time[0] <= end else 0.0
        parts += [replace(part, time=part.time + late) for part in motion.parts]
    return replace(
        motions[0],
        parts=tuple(parts),
        band=min(one.band for one in motions),
        rest_speed=max(one.rest_speed for one in motions),
        velocity_recorded=all(one.velocity_recorded for one in motions),
        range=max(one.range for one in motions),
    )

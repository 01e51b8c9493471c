"""Filtered, decimated samples of a recorded motion, and which of them slide.

Torque and regressors pass through the same low-pass filter and are decimated together [gautier1997filtering], so the
filter cancels; position is differentiated after a zero-phase low-pass.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.interpolate import Akima1DInterpolator, CubicSpline
from scipy.ndimage import binary_opening
from scipy.signal import butter, lfilter, sosfiltfilt

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .noise import measure_position_noise, measure_torque_noise, pass_white_noise, position_filter
from .parts import MotionParts, split_motion


@dataclass(frozen=True)
class RegressionSettings:
    """How a recording is filtered.

    Attributes:
        position_cutoff: Low-pass of the position before it is differentiated [Hz].
        torque_cutoff: Low-pass of torque and regressors; samples are decimated to five times it [Hz].
        gravity: Whether gravity acts (a cosine and a sine of the position).
        level_gravity: Whether it may act over so small an angle that it is a constant torque, which is no friction.
        slowest: A joint counts as sliding above this fraction of its top speed. Below, it may rest or creep, where
            friction is anything up to the static torque, and encoders at rest make up speeds of their own.
        margin: Time left out at both ends, where filters start; around gaps too [s].
    """

    position_cutoff: float = 60.0
    torque_cutoff: float = 50.0
    gravity: bool = False
    level_gravity: bool = False
    slowest: float = 0.01
    margin: float = 0.05


_DEFAULTS = RegressionSettings()
FEWEST_SAMPLES = 200
"""Least samples of a recording."""
FEWEST_SLIDING = 200
"""Least of them that slide: eight times as many as those over which errors go together."""


_ROUNDING = 1e-6
"""Of a rate, which comes from differences of times: a factor of 1.9999999 is 2."""
_MIXED = 0.01
"""Share of the low-pass, by weight, that may see rest or the other direction where a sample counts as sliding. Such a
sample is wrong by that share of twice the friction, which is about the noise of a torque sensor. The low-pass rings: a
share of 1.05 is as mixed as one of 0.95."""
_LEAST_MIXED = 0.003
"""The same for a law without a bend, which does not need the slowest samples: all that are wrong by it are wrong the
same way, and a few parameters of thousands of samples are known better than one sample's noise."""
_KEPT = 0.8
"""Part of the samples that slide which that must leave, else the strokes are too short for it."""

_RING = 0.5
"""Periods of the low-pass's cutoff for which a direction must be one: where it rings it passes 1 for less."""


@dataclass(frozen=True)
class RecordedMotion:
    """What samples were decimated from, at the recording's own rate.

    Attributes:
        parts: Velocity of each part between gaps, before the low-pass [rad/s] or [m/s].
        torques: Torque of each part, after it [N·m], [N] or the recording's unit.
        low_pass: Second-order sections of the filter, which each part has gone through on its own.
        index: Positions of the samples in the parts, one after the other. Shape (n,).
        period: Of the recording [s].
        cutoff: Of the low-pass [Hz].
        clock_error: Standard deviation of the recording's stamps from the instants of the samples [s].
        acceleration_noise: Standard deviation of what the position's noise makes of the filtered acceleration
            [rad/s²] or [m/s²].
        torque_noise: Standard deviation of what is left of the torque's own noise [N·m] or [N].
    """

    parts: tuple[FloatArray, ...]
    torques: tuple[FloatArray, ...]
    low_pass: FloatArray
    index: np.ndarray[tuple[int], np.dtype[np.intp]]
    period: float
    cutoff: float
    clock_error: float = 0.0
    acceleration_noise: float = 0.0
    torque_noise: float = 0.0

    def count_samples(self, periods: float) -> int:
        """Samples in so many periods of the low-pass's cutoff, and at least one."""
        if len(self.index) < 2:
            return 1
        step = float(np.median(np.diff(self.index))) * self.period
        return max(1, round(periods / (self.cutoff * step)))

    @property
    def time(self) -> FloatArray:
        """Of the samples, without the gaps [s]. Shape (n,)."""
        return np.asarray(self.index * self.period, dtype=np.float64)

    def torque_after(self, lag: float) -> FloatArray:
        """The low-passed torque that was recorded `lag` [s] after the samples. Shape (n,)."""
        at = [np.arange(len(torque), dtype=np.float64) for torque in self.torques]
        shifted = [
            CubicSpline(t, torque)(np.clip(t + lag / self.period, 0.0, t[-1]))
            for t, torque in zip(at, self.torques, strict=True)
        ]
        return np.asarray(np.concatenate(shifted)[self.index])

    def low_passed_torque(self, time_constant: float) -> FloatArray:
        """The torque behind a low-pass of the first order with this time constant [s]. Shape (n,)."""
        part = -np.expm1(-self.period / time_constant)
        slow = [lfilter([part], [1.0, part - 1.0], one, zi=[one[0] * (1.0 - part)])[0] for one in self.torques]
        return np.asarray(np.concatenate(slow)[self.index])

    def filtered_torque(self, model: FrictionModel) -> FloatArray:
        """Friction of `model` as the low-pass shows it at the samples [N·m] or [N]. Shape (n,)."""
        torques = [np.asarray(model.torque(velocity), dtype=np.float64) for velocity in self.parts]
        return self._filtered(torques)

    def sliding_direction(self, slowest: float, travel: float) -> FloatArray:
        """Low-passed sign of the velocity, zero where the joint does not slide. Shape (n,).

        Args:
            slowest: It slides above this speed [rad/s] or [m/s],
            travel: and after this way from where it last did not, or turned round [rad] or [m].
        """
        directions, ways = zip(*(self._strokes(part, slowest) for part in self.parts), strict=True)
        return self._filtered([np.where(way >= travel, d, 0.0) for d, way in zip(directions, ways, strict=True)])

    def presliding(self, slowest: float, length: float) -> FloatArray:
        """sgn(v) exp(-way / length) of the way that the joint slides, low-passed: what friction lacks. Shape (n,)."""
        strokes = [self._strokes(part, slowest) for part in self.parts]
        return self._filtered([direction * np.exp(-way / length) for direction, way in strokes])

    def _strokes(self, velocity: FloatArray, slowest: float) -> tuple[FloatArray, FloatArray]:
        """Sign of the velocity where above `slowest`, else 0; way since that sign has changed. Shapes (n,)."""
        direction = np.where(np.abs(velocity) > slowest, np.sign(velocity), 0.0)
        path = np.cumsum(np.abs(velocity)) * self.period
        begins = np.concatenate([[True], np.diff(direction) != 0.0])
        return direction, path - np.maximum.accumulate(np.where(begins, path, 0.0))

    def _filtered(self, parts: Sequence[FloatArray]) -> FloatArray:
        """What the low-pass shows of `parts` at the samples. Shape (n,)."""
        return np.concatenate([sosfiltfilt(self.low_pass, part) for part in parts])[self.index]


@dataclass(frozen=True)
class JointSamples:
    """Filtered, decimated samples.

    Attributes:
        position: [rad] or [m]. Shape (n,).
        velocity: [rad/s] or [m/s]. Shape (n,).
        acceleration: [rad/s²] or [m/s²]. Shape (n,).
        direction: Low-passed sign of the velocity; between -1 and 1 near a reversal. Shape (n,).
        torque: [N·m], [N] or the recording's unit. Shape (n,).
        recorded: What they were decimated from.
    """

    position: FloatArray
    velocity: FloatArray
    acceleration: FloatArray
    direction: FloatArray
    torque: FloatArray
    recorded: RecordedMotion

    def sliding(
        self, slowest: float, travel: float = 0.0, *, bends: bool = True
    ) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Samples through whose low-pass the joint slides in one direction only, so that its friction is known.

        At rest friction is whatever keeps the joint there, such as minus gravity, and around a reversal the low-pass
        mixes both directions: neither says anything on sliding friction, inertia or gravity. Shape (n,).

        Args:
            slowest: Fraction of the top speed above which it slides,
            travel: after this way from rest or a reversal [rad] or [m].
            bends: Whether the slowest samples are needed, for a law that bends there; else fewer samples beside
                reversals are taken.
        """
        off = np.abs(np.abs(self.recorded.sliding_direction(slowest * self.top_speed, travel)) - 1.0)
        width = np.ones(self.recorded.count_samples(_RING), dtype=bool)
        slides, apart = (np.asarray(binary_opening(off < share, width)) for share in (_MIXED, _LEAST_MIXED))
        enough = max(_KEPT * np.count_nonzero(slides), FEWEST_SLIDING)
        return slides if bends or np.count_nonzero(apart) < enough else apart

    @property
    def top_speed(self) -> float:
        """[rad/s] or [m/s]."""
        return float(np.max(np.abs(self.velocity), initial=0.0))


def sample_joint(recording: Recording, settings: RegressionSettings = _DEFAULTS) -> JointSamples:
    """Filter and decimate a recording, each part between gaps on its own: nothing is known of the motion in a gap.

    Raises:
        IdentificationError: The recording is too short for the filters.
    """
    rate = 1.0 / recording.sample_period
    times = [np.arange(part.time[0], part.time[-1], 1.0 / rate) for part in split_for(recording, settings).parts]
    count = sum(map(len, times))
    if count < FEWEST_SAMPLES:
        raise IdentificationError(
            f"a motion needs at least {FEWEST_SAMPLES} samples between gaps, this one has {count}"
        )
    cutoff = min(settings.torque_cutoff, 0.4 * rate)
    low_pass = butter(4, cutoff, fs=rate, output="sos")
    filtered, velocities, torques, kept = zip(
        *(_filter(even, recording, low_pass, settings) for even in times), strict=True
    )
    starts = np.concatenate([[0], np.cumsum([len(even) for even in times])[:-1]])
    index = np.concatenate([start + part for start, part in zip(starts, kept, strict=True)])
    position, velocity, acceleration, direction, torque = np.concatenate(filtered, axis=1)
    clock_error = recording.metadata.clock_error or 0.0
    filters = low_pass, position_filter(settings.position_cutoff, rate)
    recorded = RecordedMotion(
        velocities, torques, low_pass, index, recording.sample_period, cutoff, clock_error,
        acceleration_noise=measure_position_noise(recording) * pass_white_noise(filters, rate, derivative=2),
        torque_noise=measure_torque_noise(recording) * pass_white_noise(filters[:1], rate),
    )  # fmt: skip
    return JointSamples(position, velocity, acceleration, direction, torque, recorded)


def split_for(recording: Recording, settings: RegressionSettings = _DEFAULTS) -> MotionParts:
    """The parts of a recording that are filtered; gaps below half a period of the position's cutoff are bridged."""
    return split_motion(recording, shortest_gap=0.5 / settings.position_cutoff, margin=settings.margin)


def _interpolate(even: FloatArray, recording: Recording) -> FloatArray:
    """Position at any times [rad] or [m]; a straight line over missing rows would take off an acceleration. Shape (n,).

    Akima's curve depends on few samples: a stamp that is wrong bends it nowhere else.
    """
    within = np.clip(even, recording.time[0], recording.time[-1])
    return np.asarray(Akima1DInterpolator(recording.time, recording.position)(within))


def _filter(
    even: FloatArray, recording: Recording, low_pass: FloatArray, settings: RegressionSettings
) -> tuple[FloatArray, FloatArray, FloatArray, np.ndarray[tuple[int], np.dtype[np.intp]]]:
    """One part without gaps: columns of `JointSamples`, velocity before the filter, torque after it, what is kept.

    Args:
        even: Times at the recording's rate [s]. Shape (n,).
        recording: What is sampled at them.
        low_pass: Second-order sections of the filter.
        settings: Cutoffs and margin.
    """
    rate = 1.0 / recording.sample_period
    position = _interpolate(even, recording)
    torque = np.interp(even, recording.time, recording.torque)
    smooth = sosfiltfilt(position_filter(settings.position_cutoff, rate), position)
    velocity, acceleration = _differentiate(even, smooth)
    factor = max(1, int(rate / (5.0 * settings.torque_cutoff) + _ROUNDING))
    skip = max(1, int(settings.margin * rate / factor))
    kept = np.arange(0, len(even), factor)[skip:-skip]
    columns = (smooth, velocity, acceleration, np.sign(velocity))
    filtered = [sosfiltfilt(low_pass, column)[kept] for column in columns]  # one at a time: they are long
    smooth_torque = sosfiltfilt(low_pass, torque)
    return np.stack([*filtered, smooth_torque[kept]]), velocity, smooth_torque, kept


def _differentiate(even: FloatArray, smooth: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Velocity and acceleration of a smooth position by a cubic spline: differences would lose an eighth of an
    acceleration at a tenth of the rate. Shapes (n,).

    At the knots both are coefficients of the spline as they stand.
    """
    curve = CubicSpline(even, smooth)
    last = float(even[-1])
    velocity = np.append(curve.c[2], curve(last, 1))
    return velocity, np.append(2.0 * curve.c[1], curve(last, 2))

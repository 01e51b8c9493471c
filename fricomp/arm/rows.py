"""Equations of an arm: torques beside the columns of links, rotors and friction, all through the same filter.

Position is smoothed first, since acceleration is not recorded; then columns and torques pass one low-pass more, so
that what the smoothing did to the motion is small where they are compared. Friction is a column of the samples, as the
torque is: a reversal lies between two of them wherever the rows are.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.signal import butter, sosfilt, sosfilt_zi, sosfreqz

from fricomp.laws import FloatArray

from .arm_recording import ArmPart, ArmRecording
from .rigid.inertia import N_INERTIA
from .rigid.regressor import N_GRAVITY, compute_regressors
from .rigid.simulated_arm import SimulatedArm

__all__ = ["ArmRows", "build_rows", "low_pass"]

_ORDER = 4
_SMOOTHING = 2.5
"""Cutoff of the smoothing of position, in that of the comparison: its own roll-off then lies outside of it."""

_COLUMN_RATE = 10.0
"""Rate at which columns are computed, in the cutoff of the comparison: four times the smoothing's."""

_ROW_RATE = 4.0
"""Rate of the rows, in the cutoff: closer ones say the same again."""

_EDGE = 3
"""Samples for each coefficient of a filter by which both ends are lengthened before it runs."""

_NYQUIST_SHARE = 0.4
"""Highest cutoff of the smoothing, as part of the sample rate."""

_SETTLING = 3.0
"""Left out at both ends of a part, in periods of the cutoff. Turned over, an arm in full swing brakes where it went on,
and its torque does not. The slowest poles of the filter are damped by 0.38: a tenth of that is left after one period,
and a thousandth after three."""

_COUNTS = 4.0
"""Steps of an encoder that a joint must advance in a period of the smoothing's cutoff for its direction to be known."""

_ROUNDING, _CHANCE = 1e-9, 5
"""Part of the range below which a step is the arithmetic's, and how many smaller ones are no step of the encoder's."""


_FEWEST = 4
"""Samples of a spline."""

_FREQUENCIES = 2001
"""Over which the noise that filters let pass is summed up."""

Motion = tuple[FloatArray, FloatArray, FloatArray]
"""Position [rad] or [m], velocity and acceleration of all joints. Shapes (n, n_joints)."""


@dataclass(frozen=True)
class ArmRows:
    """Equations of all parts, one after the other.

    Attributes:
        time: Of the rows [s]. Shape (n,).
        part: Number of the part that a row is of. Shape (n,).
        clocks: Times of the samples of each part, and their period [s].
        motion: Smoothed motion of each part, sample by sample.
        warmth: Temperature of the joints over that of their start, part by part [K].
        torque: Of the rows [N·m] or [N]. Shape (n, n_joints).
        torque_rate: Its derivative [N·m/s] or [N/s]. Shape (n, n_joints).
        links: Columns of the links. Shape (n, n_joints, 10 n_links).
        lean: Their change as gravity leans over, of mass and first moments. Shape (n, n_joints, 2, 4 n_links).
        cutoff: Of the comparison [Hz].
        parts: What was recorded.
        late: By how much the torques are taken to be late [s].
        least_speed: Below which the steps of its encoder leave a joint's direction open [rad/s] or [m/s]. Shape
            (n_joints,).
    """

    time: FloatArray
    part: NDArray[np.intp]
    clocks: tuple[tuple[FloatArray, float], ...]
    motion: tuple[Motion, ...]
    warmth: tuple[FloatArray, ...]
    torque: FloatArray
    torque_rate: FloatArray
    links: FloatArray
    lean: FloatArray
    cutoff: float
    parts: tuple[ArmPart, ...]
    late: float
    least_speed: FloatArray
    _ways: tuple[_Way, ...]

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    def compare(self, column: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]) -> FloatArray:
        """A column of the motion, through all filters that the torques pass.

        Args:
            column: Takes position, velocity and acceleration of a part, sample by sample; gives shape (n_samples, ...).

        Returns:
            Shape (n, ...).
        """
        return self.compare_samples([column(*motion) for motion in self.motion])

    def compare_samples(self, columns: Sequence[FloatArray]) -> FloatArray:
        """Samples of each part, through all filters that the torques pass. Shapes (n_samples, ...), and (n, ...)."""
        return np.concatenate([way.take(one) for way, one in zip(self._ways, columns, strict=True)])

    def weigh_lean(self, inertia: FloatArray) -> FloatArray:
        """Torque by which the links change those of the joints as gravity leans over by a radian [N·m/rad].

        Args:
            inertia: Ten numbers of each link. Shape (n_links, 10).

        Returns:
            For each of the arm's level axes. Shape (n, n_joints, 2).
        """
        return np.asarray(self.lean @ inertia.reshape(-1, N_INERTIA)[:, :N_GRAVITY].ravel())

    def measure_noise_gain(self) -> float:
        """Mean square acceleration at the rows by white noise of positions, over the density of that [Hz/s⁴]."""
        return self._ways[0].measure_noise_gain()

    def with_delay(self, delay: float) -> ArmRows:
        """The same motion with torques that are taken to be late by `delay` [s]."""
        torque, rate = _compare_torques(self._ways, self.parts, delay)
        return replace(self, torque=torque, torque_rate=rate, late=delay)

    def find_torques(self, own: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torques and their rates where each joint's are later than the others by a time of its own.

        Args:
            own: That time [s]. Shape (n_joints,).

        Returns:
            [N·m] or [N], and a second. Shapes (n, n_joints).
        """
        return _compare_torques(self._ways, self.parts, self.late + own)


@dataclass(frozen=True)
class _Way:
    """From the samples of a part to its rows: smoothing, thinning, the low-pass, the rows that are kept."""

    rate: float
    smoothing: float
    step: int
    cutoff: float
    kept: slice

    @classmethod
    def plan(cls, part: ArmPart, cutoff: float) -> _Way:
        rate = 1.0 / part.period
        step = max(1, int(rate / (_COLUMN_RATE * cutoff)))
        size, dense = -(-len(part.time) // step), rate / step
        edge = min(int(_SETTLING * dense / cutoff), size // 4)
        kept = slice(edge, size - edge, max(1, int(dense / (_ROW_RATE * cutoff))))
        return cls(rate, min(_SMOOTHING * cutoff, _NYQUIST_SHARE * rate), step, cutoff, kept)

    def smooth(self, columns: FloatArray) -> FloatArray:
        """Samples without what is faster than a position can be trusted."""
        return low_pass(columns, self.smoothing, self.rate)

    def compare(self, dense: FloatArray) -> FloatArray:
        """Rows of what is at the rate of the columns."""
        return (low_pass(dense, self.cutoff, self.rate / self.step) if self._is_filtered else dense)[self.kept]

    @property
    def _is_filtered(self) -> bool:
        """Whether a low-pass is left between the cutoff and the rate of the columns."""
        return self.cutoff < _NYQUIST_SHARE * self.rate / self.step

    def take(self, columns: FloatArray) -> FloatArray:
        """Rows of what is sampled as the torque is."""
        return self.compare(self.smooth(columns)[:: self.step])

    def measure_noise_gain(self) -> float:
        """As `ArmRows.measure_noise_gain`: ∫ (2πf)⁴ |H|² df, with all filters in H."""
        frequency = np.linspace(0.0, 0.5 * self.rate, _FREQUENCIES)
        filters = [(self.smoothing, self.rate), (self.cutoff, self.rate / self.step)]
        passed = (2.0 * np.pi * frequency) ** 2
        for cutoff, rate in filters if self._is_filtered else filters[:1]:
            passed *= np.abs(sosfreqz(_design_filter(cutoff, rate)[0], frequency, fs=rate)[1]) ** 2
        return float(np.trapezoid(passed**2, frequency))


def build_rows(arm: SimulatedArm, recording: ArmRecording, cutoff: float, delay: float = 0.0) -> ArmRows:
    """Set up the equations.

    Args:
        arm: Kinematics.
        recording: Of all joints of `arm`, in its order.
        cutoff: Highest frequency that is compared [Hz].
        delay: By how much the torques are late behind the positions [s].
    """
    ways = tuple(_Way.plan(part, cutoff) for part in recording.parts)
    motions = tuple(_differentiate(way.smooth(part.position), part.period) for way, part in _pair(ways, recording))
    torque, rate = _compare_torques(ways, recording.parts, delay)
    times = [part.time[:: way.step][way.kept] for way, part in _pair(ways, recording)]
    columns = [
        tuple(map(way.compare, compute_regressors(arm, *(column[:: way.step] for column in motion))))
        for way, motion in zip(ways, motions, strict=True)
    ]
    return ArmRows(
        time=np.concatenate(times),
        part=np.concatenate([np.full(len(time), i) for i, time in enumerate(times)]),
        clocks=tuple((part.time, part.period) for part in recording.parts),
        motion=motions,
        warmth=tuple(part.warmth for part in recording.parts),
        torque=torque,
        torque_rate=rate,
        links=np.concatenate([links for links, _ in columns]),
        lean=np.concatenate([lean for _, lean in columns]),
        cutoff=cutoff,
        parts=recording.parts,
        late=delay,
        least_speed=_COUNTS * ways[0].smoothing * np.array([_find_step(one.position) for one in recording.recordings]),
        _ways=ways,
    )


def _find_step(position: FloatArray) -> float:
    """Step of an encoder [rad] or [m]; next to none where positions were not rounded."""
    steps = np.abs(np.diff(position))
    steps = np.sort(steps[steps > _ROUNDING * max(float(np.ptp(position)), 1e-300)])
    return float(steps[min(_CHANCE, steps.size - 1)]) if steps.size else 0.0


def _compare_torques(
    ways: Sequence[_Way], parts: Sequence[ArmPart], delay: float | FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Torques and their rates at the rows, as early as the positions."""
    torques = [_advance(part, delay) for part in parts]
    rates = [_find_rate(torque, part.period) for torque, part in zip(torques, parts, strict=True)]
    return (
        np.concatenate([way.take(one) for way, one in zip(ways, torques, strict=True)]),
        np.concatenate([way.take(one) for way, one in zip(ways, rates, strict=True)]),
    )


def _pair(ways: Sequence[_Way], recording: ArmRecording) -> list[tuple[_Way, ArmPart]]:
    return list(zip(ways, recording.parts, strict=True))


def _differentiate(position: FloatArray, period: float) -> Motion:
    velocity = _find_rate(position, period)
    return position, velocity, _find_rate(velocity, period)


def _find_rate(samples: FloatArray, period: float) -> FloatArray:
    """Derivative of samples by a cubic spline. Differences of neighbours lose 6 % of what swings ten times a period."""
    if len(samples) < _FEWEST:
        return np.asarray(np.gradient(samples, period, axis=0))
    return np.asarray(CubicSpline(period * np.arange(len(samples)), samples)(period * np.arange(len(samples)), 1))


def _advance(part: ArmPart, delay: float | FloatArray) -> FloatArray:
    """Torques as early as the positions [N·m] or [N]. Shape (n, n_joints)."""
    each = np.broadcast_to(delay, part.torque.shape[1:])
    return np.stack([np.interp(part.time + by, part.time, one) for by, one in zip(each, part.torque.T, strict=True)], 1)


def low_pass(columns: FloatArray, cutoff: float, rate: float) -> FloatArray:
    """Columns through a low-pass of a cutoff [Hz] at a rate [Hz], forwards and back.

    Both ends are turned over a point beyond them, as by scipy's `sosfiltfilt`, which looks for the state at rest anew
    each time.
    """
    sections, rest = _design_filter(cutoff, rate)
    edge = _EDGE * (2 * len(sections) + 1)
    samples = columns.reshape(len(columns), -1).T
    first, last = samples[:, :1], samples[:, -1:]
    padded = np.hstack([2.0 * first - samples[:, edge:0:-1], samples, 2.0 * last - samples[:, -2 : -edge - 2 : -1]])
    for _ in range(2):
        padded = sosfilt(sections, padded, zi=rest * padded[:, :1])[0][:, ::-1]
    return np.asarray(padded[:, edge:-edge].T.reshape(columns.shape))


@cache
def _design_filter(cutoff: float, rate: float) -> tuple[FloatArray, FloatArray]:
    """Sections of the low-pass, and their state where it has met one for ever; a design takes longer than a column's
    way through it. Shapes (n_sections, 6) and (n_sections, 1, 2)."""
    sections = butter(_ORDER, cutoff, fs=rate, output="sos")
    return np.asarray(sections), np.asarray(sosfilt_zi(sections))[:, None, :]

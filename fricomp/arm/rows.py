"""Equations of an arm: torques beside the columns of links, rotors and friction, all through the same filter.

Position is smoothed first, since acceleration is not recorded; then columns and torques pass one low-pass more, so
that what the smoothing did to the motion is small where they are compared.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.signal import butter, sosfiltfilt

from fricomp.laws import FloatArray

from .arm_recording import ArmPart, ArmRecording
from .regressor import compute_regressor
from .simulated_arm import SimulatedArm

__all__ = ["ArmRows", "build_rows"]

_ORDER = 4
_SMOOTHING = 2.5
"""Cutoff of the smoothing of position, in that of the comparison: its own roll-off then lies outside of it."""

_COLUMN_RATE = 10.0
"""Rate at which columns are computed, in the cutoff of the comparison: four times the smoothing's."""

_ROW_RATE = 4.0
"""Rate of the rows, in the cutoff: closer ones say the same again."""

_NYQUIST_SHARE = 0.4
"""Highest cutoff of the smoothing, as part of the sample rate."""

_SETTLING = 1.0
"""Left out at both ends of a part, in periods of the cutoff: there a filter that runs both ways has no neighbours."""


@dataclass(frozen=True)
class ArmRows:
    """Equations of all parts, one after the other. Motions are dense, at the rate of the columns; rows are fewer.

    Attributes:
        time: Of the rows [s]. Shape (n,).
        part: Number of the part that a row is of. Shape (n,).
        motion: Smoothed position [rad], velocity [rad/s] and acceleration [rad/s²] of each part, dense. Shapes
            (n_dense, n_joints).
        dense_time: Of each part [s]. Shapes (n_dense,).
        dense_torque: Of each part, as late as the positions [N·m] or [N]. Shapes (n_dense, n_joints).
        torque: Of the rows [N·m] or [N]. Shape (n, n_joints).
        torque_rate: Its derivative [N·m/s] or [N/s]. Shape (n, n_joints).
        links: Columns of the links. Shape (n, n_joints, 10 n_links).
        cutoff: Of the comparison [Hz].
    """

    time: FloatArray
    part: np.ndarray
    motion: tuple[tuple[FloatArray, FloatArray, FloatArray], ...]
    dense_time: tuple[FloatArray, ...]
    dense_torque: tuple[FloatArray, ...]
    torque: FloatArray
    torque_rate: FloatArray
    links: FloatArray
    cutoff: float
    _low_passes: tuple[_LowPass, ...]

    def __len__(self) -> int:
        """Number of rows."""
        return len(self.time)

    def compare(self, column: Callable[[FloatArray, FloatArray, FloatArray], FloatArray]) -> FloatArray:
        """A column of the dense motion, through the filter of the rows.

        Args:
            column: Takes position, velocity and acceleration of a part; gives shape (n_dense, ...).

        Returns:
            Shape (n, ...).
        """
        return np.concatenate([f(column(*m)) for f, m in zip(self._low_passes, self.motion, strict=True)])


@dataclass(frozen=True)
class _LowPass:
    """From the dense rate of a part to its rows."""

    rate: float
    cutoff: float
    kept: slice

    def __call__(self, columns: FloatArray) -> FloatArray:
        if self.cutoff < _NYQUIST_SHARE * self.rate:
            columns = _filter(columns, self.cutoff, self.rate)
        return columns[self.kept]


def build_rows(arm: SimulatedArm, recording: ArmRecording, cutoff: float, delay: float = 0.0) -> ArmRows:
    """Set up the equations.

    Args:
        arm: Kinematics.
        recording: Of all joints of `arm`, in its order.
        cutoff: Highest frequency that is compared [Hz].
        delay: By how much the torques are late behind the positions [s].
    """
    dense = [_smooth(part, cutoff, delay) for part in recording.parts]
    filters = tuple(_low_pass(time, cutoff) for time, *_ in dense)
    motion = tuple((q, v, a) for _, q, v, a, _ in dense)
    return ArmRows(
        time=np.concatenate([one[0][f.kept] for one, f in zip(dense, filters, strict=True)]),
        part=np.concatenate(
            [np.full(len(one[0][f.kept]), i) for i, (one, f) in enumerate(zip(dense, filters, strict=True))]
        ),
        motion=motion,
        dense_time=tuple(one[0] for one in dense),
        dense_torque=tuple(one[4] for one in dense),
        torque=np.concatenate([f(one[4]) for one, f in zip(dense, filters, strict=True)]),
        torque_rate=np.concatenate([f(_differentiate(one)) for one, f in zip(dense, filters, strict=True)]),
        links=np.concatenate([f(compute_regressor(arm, *m)) for m, f in zip(motion, filters, strict=True)]),
        cutoff=cutoff,
        _low_passes=filters,
    )


def _smooth(
    part: ArmPart, cutoff: float, delay: float
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Time, position, velocity, acceleration and torque at the dense rate."""
    rate = 1.0 / part.period
    smoothing = min(_SMOOTHING * cutoff, _NYQUIST_SHARE * rate)
    position, torque = (_filter(column, smoothing, rate) for column in (part.position, part.torque))
    velocity = np.gradient(position, part.period, axis=0)
    acceleration = np.gradient(velocity, part.period, axis=0)
    step = max(1, int(rate / (_COLUMN_RATE * cutoff)))
    time = part.time[::step]
    late = np.stack([np.interp(time + delay, part.time, one) for one in torque.T], axis=1)
    return time, position[::step], velocity[::step], acceleration[::step], late


def _differentiate(dense: tuple[FloatArray, ...]) -> FloatArray:
    time, torque = dense[0], dense[-1]
    return np.asarray(np.gradient(torque, float(time[1] - time[0]), axis=0))


def _low_pass(time: FloatArray, cutoff: float) -> _LowPass:
    rate = 1.0 / float(time[1] - time[0])
    edge = min(int(_SETTLING * rate / cutoff), len(time) // 4)
    return _LowPass(rate, cutoff, slice(edge, len(time) - edge, max(1, int(rate / (_ROW_RATE * cutoff)))))


def _filter(columns: FloatArray, cutoff: float, rate: float) -> FloatArray:
    sections = butter(_ORDER, cutoff, fs=rate, output="sos")
    return np.asarray(sosfiltfilt(sections, columns, axis=0))

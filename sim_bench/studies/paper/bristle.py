"""A LuGre joint as it would be recorded: solved finely by a rule of its own, seen through an encoder and noise."""

from typing import NamedTuple

import numpy as np
from scipy.signal import butter, sosfiltfilt

from fricomp.laws import FloatArray

BRISTLE = (200.0, 0.5)
"""sigma_0 [N·m/rad] and sigma_1 [N·m·s/rad]."""
_RATE, _FINER = 1000.0, 20
"""Samples a second, and steps of the solution between two of them."""
_LEAD = 1.0
"""Motion before the record begins, which therefore does not begin with a bristle at rest [s]."""
_BITS, _CUTOFF, _NOISE = 18, 60.0, 0.02
"""Encoder, low-pass of its counts before they are differentiated [Hz], and noise as a fraction of the torque."""


class LugreRecord(NamedTuple):
    """What is known of the joint: time [s], velocity [rad/s] and torque [N·m]. Shape (n,) each."""

    time: FloatArray
    velocity: FloatArray
    torque: FloatArray


def record_lugre(static: tuple[float, ...], seconds: float, seed: int) -> LugreRecord:
    """A record at 1 kHz with reversals.

    Args:
        static: Four parameters of the curve forward, four in reverse.
        seconds: Its length [s].
        seed: Of the noise.
    """
    fine = np.arange(0.0, seconds + _LEAD, 1.0 / (_RATE * _FINER))
    velocity = 0.6 * np.sin(0.6 * np.pi * fine) * np.sin(0.1 * np.pi * fine + 0.3) + 0.02 * np.sin(2.2 * np.pi * fine)
    position = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(fine) * (velocity[1:] + velocity[:-1]))])
    torque = _solve(static, velocity, 1.0 / (_RATE * _FINER))
    step = 2.0 * np.pi / 2**_BITS
    counts = step * np.round(position[::_FINER] / step)
    seen = np.gradient(sosfiltfilt(butter(4, _CUTOFF, fs=_RATE, output="sos"), counts), 1.0 / _RATE)
    noise = _NOISE * np.random.default_rng(seed).normal(size=len(counts))
    part = slice(int(_LEAD * _RATE), None)
    return LugreRecord(fine[::_FINER][part], seen[part], (torque[::_FINER] * (1.0 + noise))[part])


def _solve(static: tuple[float, ...], velocity: FloatArray, dt: float) -> FloatArray:
    """Friction torque of the differential equation [canudas1995lugre] by the trapezoidal rule [N·m]. Shape (n,)."""
    sigma_0, sigma_1 = BRISTLE
    coulomb, breakaway, stribeck, viscous = np.where(velocity[:, None] >= 0.0, static[:4], static[4:]).T
    dry = coulomb + (breakaway - coulomb) * np.exp(-((velocity / stribeck) ** 2))
    decay = sigma_0 * np.abs(velocity) / dry
    z, deflection = 0.0, np.zeros_like(velocity)
    growth = (0.5 * dt * (velocity[1:] + velocity[:-1])).tolist()
    keep, divide = (1.0 - 0.5 * dt * decay[:-1]).tolist(), (1.0 + 0.5 * dt * decay[1:]).tolist()
    for k, (grown, kept, divisor) in enumerate(zip(growth, keep, divide, strict=True), start=1):
        z = (kept * z + grown) / divisor
        deflection[k] = z
    rate = velocity - decay * deflection
    return np.asarray(sigma_0 * deflection + sigma_1 * rate + viscous * velocity)

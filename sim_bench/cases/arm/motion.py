"""Motion of all joints at once: a sum of harmonics each, inside its limits of position, speed and acceleration."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

_BASE_PERIOD = 20.0  # [s]
_HARMONICS = 12
_RAMP = 2.0  # [s] over which the motion swells from rest

_CENTRES = np.array([0.0, 0.6, 0.7, 0.3, 0.0, 0.0])  # [rad]: bent, so that gravity acts on every joint but the first
_REACH = np.array([1.6, 0.9, 1.2, 1.3, 1.6, 1.8])  # [rad] about the centre
_SPEED = np.array([1.8, 1.5, 1.8, 2.5, 2.5, 3.0])  # [rad/s]
_ACCELERATION = np.array([6.0, 5.0, 7.0, 12.0, 12.0, 15.0])  # [rad/s²]


class ArmReference(NamedTuple):
    """What the joints are told. Shapes (n, 6).

    Attributes:
        position: [rad]
        velocity: [rad/s]
        acceleration: [rad/s²]
    """

    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]


def build_motion(rng: np.random.Generator, time: NDArray[np.float64]) -> ArmReference:
    """Harmonics of 0.05 Hz up to 0.6 Hz, as large as the limits allow times a draw of 0.6 to 1.

    Args:
        rng: Draws amplitudes, phases, centres.
        time: [s]. Shape (n,).
    """
    w = 2.0 * np.pi / _BASE_PERIOD * np.arange(1, _HARMONICS + 1)
    swell, rate, bend = _swell(time)
    columns = []
    for j in range(6):
        size = rng.normal(size=_HARMONICS) / np.sqrt(np.arange(1, _HARMONICS + 1))
        phase = np.outer(time, w) + rng.uniform(0.0, 2.0 * np.pi, _HARMONICS)
        q, v, a = np.sin(phase) @ size, np.cos(phase) @ (size * w), -np.sin(phase) @ (size * w**2)
        q = q - q.mean()
        limits = (_REACH[j] / np.ptp(q) * 2.0, _SPEED[j] / np.abs(v).max(), _ACCELERATION[j] / np.abs(a).max())
        scale = min(limits) * rng.uniform(0.6, 1.0)
        centre = _CENTRES[j] + rng.normal(0.0, 0.15)
        columns.append(
            (
                centre + scale * swell * q,
                scale * (swell * v + rate * q),
                scale * (swell * a + 2.0 * rate * v + bend * q),
            )
        )
    return ArmReference(*(np.stack(each, axis=1) for each in zip(*columns, strict=True)))


def _swell(time: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """A rise from 0 to 1 with its first two derivatives."""
    x = np.clip((time - time[0]) / _RAMP, 0.0, 1.0)
    rise = x**3 * (10.0 - 15.0 * x + 6.0 * x**2)
    return rise, 30.0 * x**2 * (1.0 - x) ** 2 / _RAMP, 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / _RAMP**2

"""One recording made ready for simulation: uniform time, velocity, quantisation and noise of its sensors."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import median_filter
from scipy.optimize import nnls
from scipy.signal import lfilter, savgol_filter

__all__ = ["FloatArray", "TorqueNoise", "Track", "smooth_derivative"]

FloatArray = NDArray[np.float64]

_VELOCITY_WINDOW = 0.021  # [s] longest Savitzky-Golay window that keeps the reversals of a joint
_SPIKE = 5.0  # noise deviations from the median of seven samples, beyond which a sample is no measurement
_SHORTEST_WINDOW = 7  # samples, for slow recordings


class TorqueNoise(NamedTuple):
    """Noise of a torque signal.

    Attributes:
        white: Standard deviation of its white part [N·m].
        coloured: Standard deviation of its first-order part [N·m].
        memory: Correlation of the first-order part from sample to sample.
    """

    white: float
    coloured: float
    memory: float

    @property
    def size(self) -> float:
        """Standard deviation of both parts together [N·m]."""
        return float(np.hypot(self.white, self.coloured))

    def draw(self, size: int, rng: np.random.Generator) -> FloatArray:
        """A sample of the noise [N·m]. Shape (size,)."""
        noise = self.white * rng.standard_normal(size)
        if self.coloured > 0.0:
            kick = self.coloured * np.sqrt(1.0 - self.memory**2)
            noise = noise + lfilter([kick], [1.0, -self.memory], rng.standard_normal(size + 500))[500:]
        return noise


@dataclass(frozen=True)
class Track:
    """Samples of one recording on a uniform time grid, joint side.

    Attributes:
        dt: Sample time [s].
        position: Recorded position [rad] or [m]. Shape (n,).
        velocity: Estimated velocity [rad/s] or [m/s]. Shape (n,).
        torque: Recorded torque [N·m], [N] or the recording's own unit. Shape (n,).
        resolution: Encoder step found in `position` [rad] or [m]; 0 where none is visible.
        torque_noise: White and coloured part of the torque's noise.
        rotary: Whether gravity depends on the sine of the position.
        channels: Further columns by name (load_torque, temperature, ...). Each of shape (n,).
        name: What to call this recording.
    """

    dt: float
    position: FloatArray
    velocity: FloatArray
    torque: FloatArray
    resolution: float
    torque_noise: TorqueNoise
    rotary: bool = True
    channels: Mapping[str, FloatArray] = field(default_factory=dict)
    name: str = "recording"

    @property
    def size(self) -> int:
        """Number of samples."""
        return int(self.position.size)

    @property
    def time(self) -> FloatArray:
        """Time since the first sample [s]. Shape (n,)."""
        return np.arange(self.size, dtype=np.float64) * np.float64(self.dt)

    @classmethod
    def build(
        cls,
        dt: float,
        position: FloatArray,
        torque: FloatArray,
        *,
        rotary: bool = True,
        channels: Mapping[str, FloatArray] | None = None,
        name: str = "recording",
    ) -> Track:
        """Estimate velocity, encoder step and torque noise from the samples, and take lone spikes out of the torque."""
        noise = torque_noise(torque)
        return cls(
            dt=dt,
            position=position,
            velocity=smooth_derivative(position, dt),
            torque=without_spikes(torque, noise.size),
            resolution=encoder_step(position),
            torque_noise=noise,
            rotary=rotary,
            channels=dict(channels or {}),
            name=name,
        )


def smooth_derivative(values: FloatArray, dt: float, window: float = _VELOCITY_WINDOW) -> FloatArray:
    """Derivative by a local cubic (Savitzky and Golay) over `window` [s]."""
    samples = min(max(_SHORTEST_WINDOW, 2 * round(window / dt / 2) + 1), values.size - 1 + values.size % 2)
    result: FloatArray = savgol_filter(values, samples, 3, deriv=1, delta=dt)
    return result


def encoder_step(position: FloatArray) -> float:
    """Smallest step that most changes of `position` are multiples of; 0 for a position that is not quantised."""
    steps = np.abs(np.diff(position))
    steps = steps[steps > 1e-12 * max(1.0, float(np.ptp(position)))]
    if steps.size < 10:
        return 0.0
    step = float(np.quantile(steps, 0.01))
    small = steps[(steps > 0.5 * step) & (steps < 20.5 * step)]
    step = float(np.median(small / np.maximum(np.round(small / step), 1.0)))
    multiple = small / step
    return step if float(np.mean(np.abs(multiple - np.round(multiple)) < 0.05)) > 0.95 else 0.0


def without_spikes(values: FloatArray, noise: float) -> FloatArray:
    """`values` with samples that stand out from their neighbours' median by many noise deviations put back on it."""
    middle = median_filter(values, 7, mode="nearest")
    limit = _SPIKE * max(noise, 1e-3 * float(np.std(values)))
    return np.where(np.abs(values - middle) > limit, middle, values)


def torque_noise(values: FloatArray) -> TorqueNoise:
    """White and first-order coloured noise in a smooth signal, from its second differences over 1 to 8 samples."""
    spans = np.array([1, 2, 3, 5, 8])
    variance = np.array(
        [(np.median(np.abs(values[2 * k :] - 2 * values[k:-k] + values[: -2 * k])) / 0.6745) ** 2 for k in spans]
    )
    if values.size < 100 or variance[0] <= 0.0:
        return TorqueNoise(0.0, 0.0, 0.0)
    best: tuple[float, TorqueNoise] | None = None
    for memory in (0.0, 0.3, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98):
        coloured = 6.0 - 8.0 * memory**spans + 2.0 * memory ** (2 * spans)
        parts = [np.full(spans.size, 6.0)] + ([coloured] if memory > 0.0 else [])
        found, misfit = nnls(np.stack(parts, axis=1) / variance[:, None], np.ones(spans.size))
        white, colour = found[0], found[-1] if memory > 0.0 else 0.0
        if best is None or misfit < 0.9 * best[0]:
            best = (float(misfit), TorqueNoise(float(np.sqrt(white)), float(np.sqrt(colour)), memory))
    assert best is not None
    return best[1]

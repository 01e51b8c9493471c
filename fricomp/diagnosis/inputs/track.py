"""One recording made ready for simulation: uniform time, velocity, quantisation and noise of its sensors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls
from scipy.signal import lfilter, savgol_filter

from fricomp.recording import Recording

from .controller import Controller
from .past import Past
from .settings import INPUT
from .signal import FloatArray, differentiate, draw_curve
from .spikes import remove_spikes
from .unrest import measure_unrest

__all__ = [
    "SIMULATED_SPRING",
    "SIMULATED_STIFFNESS",
    "FloatArray",
    "PositionNoise",
    "TorqueNoise",
    "Track",
    "differentiate",
]

SIMULATED_SPRING, SIMULATED_STIFFNESS = "simulated_spring", "simulated_stiffness"
"""Channels of a track: torque of the simulation's own spring, which its torque is without, and the stiffness."""


class TorqueNoise(NamedTuple):
    """Noise of a torque signal.

    Attributes:
        white: Standard deviation of its white part [N·m].
        coloured: Standard deviation of its first-order part [N·m].
        memory: Correlation of the first-order part from sample to sample.
        freedom: Degrees of freedom of its Student distribution; infinite for normal noise.
    """

    white: float
    coloured: float
    memory: float
    freedom: float = np.inf

    @property
    def size(self) -> float:
        """Standard deviation of both parts together [N·m]."""
        return float(np.hypot(self.white, self.coloured))

    def take_out(self, other: TorqueNoise) -> TorqueNoise:
        """What is left of the noise, were some of its power that of the `other`."""
        part = float(np.sqrt(max(1.0 - (other.size / self.size) ** 2, 0.0))) if self.size > 0.0 else 0.0
        return self._replace(white=part * self.white, coloured=part * self.coloured)

    def draw(self, size: int, rng: np.random.Generator) -> FloatArray:
        """A sample of the noise [N·m]. Shape (size,)."""
        noise = self.white * rng.standard_normal(size)
        if np.isfinite(self.freedom):
            noise = self.white * np.sqrt(1.0 - 2.0 / self.freedom) * rng.standard_t(self.freedom, size)
        if self.coloured > 0.0:
            kick = self.coloured * np.sqrt(1.0 - self.memory**2)
            noise = noise + lfilter([kick], [1.0, -self.memory], rng.standard_normal(size + 500))[500:]
        return noise


class PositionNoise(NamedTuple):
    """Noise of a position signal.

    Attributes:
        white: Standard deviation of its white part, rounding included [rad] or [m].
        jitter: Standard deviation of the instants at which the samples were taken [s].
    """

    white: float
    jitter: float

    def measure_own(self, step: float) -> float:
        """Normal noise of the position itself, beside the rounding to an encoder's `step`; 0 where that may be all."""
        rounding = INPUT.rounding * step
        own = float(np.sqrt(self.white**2 - rounding**2)) if self.white > INPUT.own_noise * rounding else 0.0
        return own / INPUT.trimmed_normal


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
        position_noise: White noise of `position`, rounding included, and jitter of its samples.
        loop: What moved the joint; None where that is not known, or was faster than the samples.
        rotary: Whether gravity depends on the sine of the position.
        channels: Further columns by name (load_torque, temperature, ...). Each of shape (n,).
        name: What to call this recording.
        substeps: In how many steps the observer takes each sample; empty before that is known. Shape (n,).
        usual_delay: By how much its torque is late without any flaw, and how far that strays [s].
        delays: Earliest and latest that a torque without any flaw comes [s].
        acts_late: Time by which the recorded torque was moved, since it acts so long after its stamp [s].
        missing: Samples at which no row was recorded, which lie on straight lines; empty where none are. Shape (n,).
        stamps: Instants of the rows where these are further apart than samples [s]; empty elsewhere. Shape (r,).
        source: Number of the recording that it is a part of: an encoder's zero and a payload are the same in all parts.
        past: How the joint was driven over all of that recording; None where this track is all of it.
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
    position_noise: PositionNoise = field(default_factory=lambda: PositionNoise(0.0, 0.0))
    loop: Controller | None = None
    substeps: NDArray[np.int64] = field(default_factory=lambda: np.ones(0, dtype=np.int64))
    usual_delay: tuple[float, float] = (0.0, 2.5e-4)
    delays: tuple[float, float] = (-5e-4, 5e-4)
    acts_late: float = 0.0
    missing: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    stamps: FloatArray = field(default_factory=lambda: np.zeros(0))
    source: int = 0
    past: Past | None = None

    @property
    def size(self) -> int:
        """Number of samples."""
        return int(self.position.size)

    @property
    def time(self) -> FloatArray:
        """Time since the first sample [s]. Shape (n,)."""
        return np.arange(self.size, dtype=np.float64) * np.float64(self.dt)

    def take_rows(self, values: FloatArray) -> FloatArray:
        """Take of values at the samples, shape (n,), those that rows hold, shape (r,)."""
        return draw_curve(self.time, values, self.stamps) if self.stamps.size else values

    def fill_rows(self, values: FloatArray) -> FloatArray:
        """Values at the samples as they follow from those of rows, shape (r,): curves between slow rows, straight lines
        where rows are missing. Shape (n,)."""
        if self.stamps.size:
            return draw_curve(self.stamps, values, self.time)
        if not self.missing.any():
            return values
        bridged: FloatArray = np.array(values)
        bridged[self.missing] = np.interp(
            np.flatnonzero(self.missing), np.flatnonzero(~self.missing), values[~self.missing]
        )
        return bridged

    @cached_property
    def waves(self) -> tuple[FloatArray, FloatArray]:
        """Cosine and sine of the position, which every simulation needs. Shapes (n,)."""
        return np.cos(self.position), np.sin(self.position)

    @cached_property
    def unrest(self) -> FloatArray:
        """By how much more noise its torque has than usual, at least 1. Shape (n,)."""
        return measure_unrest(self.torque, self.velocity, self.dt)

    def compute_position_variance(self, velocity: FloatArray) -> FloatArray:
        """Variance of the position's noise at this velocity [rad²] or [m²]. Shape (n,)."""
        white = max(self.position_noise.white, INPUT.rounding * self.resolution, INPUT.exact_position)
        return np.asarray(white**2 + (self.position_noise.jitter * velocity) ** 2)

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
        noise: TorqueNoise | None = None,
        position_noise: PositionNoise | None = None,
    ) -> Track:
        """Estimate velocity, encoder step and noise from the samples, and take lone spikes out of the torque.

        Samples that were interpolated do not show their noise: it is given, and the spikes were taken out before.
        """
        velocity = differentiate(position, dt)
        if noise is None:
            noise = measure_torque_noise(torque, find_calm_samples(position, velocity, dt))
            torque = remove_spikes(torque, noise.size, position, dt)
        return cls(
            dt=dt,
            position=position,
            velocity=velocity,
            torque=torque,
            resolution=find_encoder_step(position),
            torque_noise=noise,
            rotary=rotary,
            channels=dict(channels or {}),
            name=name,
            position_noise=measure_position_noise(position, velocity) if position_noise is None else position_noise,
        )


def choose_step(recordings: Sequence[Recording]) -> float:
    """Sample time of the grid on which recordings are simulated [s]: their own, or a part of a slow one's."""
    dt = min(recording.sample_period for recording in recordings)
    return float(np.clip(dt, 2.5e-4, 2.5e-3)) if dt < 3.5e-3 else float(dt / np.ceil(dt / 2.5e-3))


def goes_one_way(velocities: Sequence[FloatArray]) -> bool:
    """Whether hardly any part of the way of motions leads back.

    Args:
        velocities: Of the motions [rad/s] or [m/s]. Each of shape (n,).
    """
    forth, back = (sum(float(np.sum(np.maximum(side * one, 0.0))) for one in velocities) for side in (1.0, -1.0))
    return min(forth, back) <= INPUT.back * (forth + back)


def find_encoder_step(position: FloatArray) -> float:
    """Smallest step that most changes of `position` are multiples of; 0 for a position that is not quantised.

    Of the values and not of neighbouring samples, which slow ones leave many steps apart.
    """
    steps = np.diff(np.unique(position))
    steps = steps[steps > 1e-12 * max(1.0, float(np.ptp(position)))]
    if steps.size < 10:
        return 0.0
    step = float(np.quantile(steps, 0.01))
    small = steps[(steps > 0.5 * step) & (steps < 20.5 * step)]
    step = float(np.median(small / np.maximum(np.round(small / step), 1.0)))
    multiple = small / step
    return step if float(np.mean(np.abs(multiple - np.round(multiple)) < 0.05)) > 0.95 else 0.0


def find_calm_samples(position: FloatArray, velocity: FloatArray, dt: float) -> NDArray[np.bool_]:
    """Find the half of the moving samples in which the motion changes least, where the torque is smoothest. Shape
    (n,)."""
    samples = min(
        max(INPUT.shortest_window, 2 * round(3.0 * INPUT.velocity_window / dt / 2) + 1), position.size // 2 * 2 - 1
    )
    jerk = np.abs(savgol_filter(position, samples, 4, deriv=3))
    moving = np.abs(velocity) > INPUT.moving_share * np.quantile(np.abs(velocity), 0.98)
    if np.mean(moving) < INPUT.few_moving:
        moving = np.ones(position.size, dtype=bool)
    calm: NDArray[np.bool_] = moving & (jerk <= np.median(jerk[moving]))
    return calm


def measure_position_noise(position: FloatArray, velocity: FloatArray) -> PositionNoise:
    """Measure the white noise of a position, rounding included, and the part of it that grows with speed.

    Fourth differences hold next to nothing of a smooth motion; where they are not white after all, there is no
    telling noise from motion and the answer is 0.
    """
    fourth, fifth = np.diff(position, 4) ** 2 / 70.0, np.diff(position, 5) ** 2 / 252.0
    speed = np.abs(velocity[2:-2])
    moving = speed > 0.05 * np.quantile(speed, 0.98)
    if np.sum(moving) < 100:
        return PositionNoise(0.0, 0.0)
    edges = np.quantile(speed[moving], np.linspace(0.0, 1.0, 7))
    squares, variances = [], []
    for low, high in pairwise(edges):
        inside = (speed >= low) & (speed <= high)
        variance, check = (_compute_trimmed_mean(one[inside[: one.size]]) for one in (fourth, fifth))
        if check < INPUT.white_differences * variance and low >= edges[3]:
            return PositionNoise(0.0, 0.0)
        squares.append(float(np.mean(speed[inside] ** 2)))
        variances.append(variance)
    A = np.stack([np.ones(len(squares)), np.array(squares)], axis=1)
    weight = 1.0 / np.maximum(np.array(variances), 1e-30)
    found, _ = nnls(A * weight[:, None], np.array(variances) * weight)
    return PositionNoise(float(np.sqrt(found[0])), float(np.sqrt(found[1])))


def _compute_trimmed_mean(values: FloatArray) -> float:
    """Mean without the largest two per cent."""
    return float(np.mean(values[values <= np.quantile(values, 0.98)]))


def measure_torque_noise(values: FloatArray, calm: NDArray[np.bool_] | None = None) -> TorqueNoise:
    """White and first-order coloured noise in a signal, from its second differences over 1 to 8 samples.

    Args:
        values: The signal. Shape (n,).
        calm: Samples where the signal itself is smooth; None for all. Shape (n,).
    """
    spans = np.array([1, 2, 3, 5, 8])
    if values.size < 100:
        return TorqueNoise(0.0, 0.0, 0.0)
    use = np.ones(values.size, dtype=bool) if calm is None else calm
    second = [np.abs(values[2 * k :] - 2 * values[k:-k] + values[: -2 * k])[use[k:-k]] for k in spans]
    variance = np.array([(np.median(one) / 0.6745) ** 2 for one in second])
    if variance.min() <= 0.0:
        return TorqueNoise(0.0, 0.0, 0.0)
    freedom, robust = _match_tails(float(np.quantile(second[0], 0.99) / np.median(second[0])))
    variance /= robust**2
    best: tuple[float, TorqueNoise] | None = None
    for memory in (0.0, 0.3, 0.5, 0.65, 0.8, 0.9, 0.95, 0.98):
        coloured = 6.0 - 8.0 * memory**spans + 2.0 * memory ** (2 * spans)
        parts = [np.full(spans.size, 6.0)] + ([coloured] if memory > 0.0 else [])
        found, misfit = nnls(np.stack(parts, axis=1) / variance[:, None], np.ones(spans.size))
        white, colour = found[0], found[-1] if memory > 0.0 else 0.0
        if best is None or misfit < 0.9 * best[0]:
            best = (float(misfit), TorqueNoise(float(np.sqrt(white)), float(np.sqrt(colour)), memory, freedom))
    assert best is not None
    return best[1]


def _match_tails(spread: float) -> tuple[float, float]:
    """Match a Student distribution to tails: its degrees of freedom, and its robust over its true deviation, from the
    quotient of the 0.99 quantile and the median of the absolute second differences."""
    index = int(np.searchsorted(-np.array([one[2] for one in INPUT.student_tails]), -spread))
    return INPUT.student_tails[min(index, len(INPUT.student_tails) - 1)][:2]

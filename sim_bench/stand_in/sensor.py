"""The sensor chain of one joint: encoder, velocity estimate, torque sensor, and the delay of the bus."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from dataclasses import dataclass
from math import exp, isfinite, pi
from typing import NamedTuple

import numpy as np

from fricomp.errors import ParameterError

__all__ = ["Reading", "SensorChain", "SensorSettings"]

# Random numbers are drawn this many at a time.
NOISE_BLOCK = 4096


class Reading(NamedTuple):
    """What the sensors say.

    Attributes:
        time_ns: When it was taken [ns].
        position: [rad] or [m].
        velocity: [rad/s] or [m/s].
        torque: [N·m] or [N].
    """

    time_ns: int
    position: float
    velocity: float
    torque: float


@dataclass(frozen=True)
class SensorSettings:
    """How one joint is measured. The defaults are those of the stand-in's default joint but for the torque errors.

    Attributes:
        encoder_counts: Counts a turn [1/rev], or 2 pi counts a metre on a slide; 0 for a continuous reading.
        velocity_filter: Time constant of the low pass behind the difference of positions [s].
        torque_noise: Standard deviation of white noise, before the filter [N·m] or [N].
        torque_offset: Constant error [N·m] or [N].
        torque_gain: Measured over true torque, a wrong torque constant [1].
        torque_filter: Time constant of the torque sensor's low pass [s].
        delay: Age of every reading when it arrives [s]; rounded to whole periods.

    Raises:
        ParameterError: A value is not finite, or negative where that has no meaning.
    """

    encoder_counts: int = 2**18
    velocity_filter: float = 0.005
    torque_noise: float = 0.0
    torque_offset: float = 0.0
    torque_gain: float = 1.0
    torque_filter: float = 0.002
    delay: float = 0.001

    def __post_init__(self) -> None:
        for name in ("encoder_counts", "velocity_filter", "torque_noise", "torque_filter", "delay"):
            value = getattr(self, name)
            if not (isfinite(value) and value >= 0.0):
                raise ParameterError(f"{name} must be finite and not negative, got {value!r}")
        for name in ("torque_offset", "torque_gain"):
            if not isfinite(getattr(self, name)):
                raise ParameterError(f"{name} must be finite, got {getattr(self, name)!r}")

    @classmethod
    def ideal(cls) -> SensorSettings:
        """Sensors that show the truth, at once."""
        return cls(encoder_counts=0, velocity_filter=0.0, torque_filter=0.0, delay=0.0)

    @property
    def position_quantum(self) -> float:
        """Step of the encoder [rad] or [m]; 0 where it is continuous."""
        return 2.0 * pi / self.encoder_counts if self.encoder_counts else 0.0

    def velocity_quantum(self, period: float) -> float:
        """Change of the velocity estimate when the encoder moves by one count within `period` [s], [rad/s]."""
        return self.position_quantum / period * filter_gain(self.velocity_filter, period)


class SensorChain:
    """Turns the true state into readings, sampled once a period.

    Args:
        settings: What the sensors are like.
        period: Time between samples [s].
        seed: Of the noise; the same seed gives the same noise.
    """

    def __init__(self, settings: SensorSettings, period: float, seed: np.random.SeedSequence) -> None:
        self.settings, self._seed = settings, seed
        self._quantum = settings.position_quantum
        self._rate = 1.0 / period
        self._velocity_gain = filter_gain(settings.velocity_filter, period)
        self._torque_gain = filter_gain(settings.torque_filter, period)
        self._depth = round(settings.delay / period) + 1
        self.reset(0, 0.0, 0.0)

    def reset(self, time_ns: int, position: float, torque: float) -> None:
        """Start over at rest, with the noise from its beginning."""
        self._noise = _normal_numbers(self._seed, self.settings.torque_noise)
        quantum = self._quantum
        self.encoded = round(position / quantum) * quantum if quantum else position
        """What the encoder shows now, before any delay [rad] or [m]; the drive closes its loop on it."""
        self._velocity = 0.0
        self._torque = torque * self.settings.torque_gain + self.settings.torque_offset
        first = time_ns, self.encoded, 0.0, self._torque
        self._queue = deque([first] * self._depth, maxlen=self._depth)

    @property
    def newest(self) -> Reading:
        """The newest reading that has arrived."""
        return Reading(*self._queue[0])

    def sample(self, time_ns: int, position: float, velocity: float, torque: float) -> None:
        """Take one sample of the true state.

        Args:
            time_ns: Now [ns].
            position: True position [rad] or [m].
            velocity: True velocity, which only a continuous encoder sees [rad/s] or [m/s].
            torque: True torque on the joint [N·m] or [N].
        """
        settings, quantum = self.settings, self._quantum
        if quantum:
            position = round(position / quantum) * quantum
            velocity = (position - self.encoded) * self._rate
        self.encoded = position
        self._velocity += self._velocity_gain * (velocity - self._velocity)
        measured = torque * settings.torque_gain + settings.torque_offset + next(self._noise)
        self._torque += self._torque_gain * (measured - self._torque)
        self._queue.append((time_ns, position, self._velocity, self._torque))


def filter_gain(time_constant: float, period: float) -> float:
    """Weight of a new sample in a first-order low pass, exact for an input held over the period [1]."""
    return 1.0 - exp(-period / time_constant) if time_constant > 0.0 else 1.0


def _normal_numbers(seed: np.random.SeedSequence, deviation: float) -> Iterator[float]:
    generator = np.random.default_rng(seed)
    while True:
        yield from (generator.standard_normal(NOISE_BLOCK) * deviation).tolist()

"""The noise of one recording's sensors, and a recording without noise as these sensors would have shown it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.recording import Recording

from .settings import INPUT
from .track import (
    TorqueNoise,
    differentiate,
    find_calm_samples,
    find_encoder_step,
    measure_position_noise,
    measure_torque_noise,
)


@dataclass(frozen=True)
class SensorNoise:
    """What sensors add to torque and position.

    Attributes:
        period: Time between the samples [s].
        torque: White noise of the torque, with what of its coloured noise neighbouring samples show [N·m] or [N].
        encoder_step: Step of the position [rad] or [m]; 0 where none is visible.
        position: White noise of the position beyond the encoder's rounding [rad] or [m].
    """

    period: float
    torque: float
    encoder_step: float
    position: float

    def scale_to(self, period: float) -> SensorNoise:
        """Return the noise that weighs as much over the same time in samples of another period [s]."""
        scale = float(np.sqrt(self.period / period))
        return SensorNoise(period, scale * self.torque, self.encoder_step, scale * self.position)


def measure_sensor_noise(recording: Recording) -> SensorNoise:
    """The noise that the samples of a recording show."""
    period = recording.sample_period
    position, torque = np.array(recording.position), np.array(recording.torque)
    velocity = differentiate(position, period)
    step = recording.metadata.encoder_resolution or find_encoder_step(position)
    return SensorNoise(
        period=period,
        torque=_combine_noise(measure_torque_noise(torque, find_calm_samples(position, velocity, period))),
        encoder_step=step,
        position=measure_position_noise(position, velocity).measure_own(step),
    )


def add_sensor_noise(recording: Recording, like: Sequence[Recording], seed: int = 0) -> Recording:
    """Add the noise of other recordings where a recording has less: its joint as their sensors would have shown it.

    Of several others those count that have the least noise, each channel on its own. Where noise is added, the
    reference is left out: the loop of a simulation has not heard this noise.

    Args:
        recording: Often without any noise.
        like: Recordings on the joint side. In another unit of torque, the noise is taken over its own deviation.
        seed: Seed of the noise; the same seed gives the same recording.
    """
    rng = np.random.default_rng([seed, len(recording)])
    own, others = (
        measure_sensor_noise(recording),
        [_measure_visible(one).scale_to(recording.sample_period) for one in like],
    )
    loud = [_compute_scale(recording, one) * noise.torque for one, noise in zip(like, others, strict=True)]
    hiss = _subtract_variance(min(loud), own.torque)
    blur = _subtract_variance(min(one.position for one in others), own.position)
    step = min(one.encoder_step for one in others)
    coarser = step > own.encoder_step
    if hiss == 0.0 and blur == 0.0 and not coarser:
        return recording
    position = np.asarray(recording.position) + blur * rng.standard_normal(len(recording))
    sensed = recording.with_channels(
        torque=np.asarray(recording.torque) + hiss * rng.standard_normal(len(recording)),
        position=np.round(position / step) * step if coarser else position,
        position_reference=None,
    )
    return sensed.with_metadata(encoder_resolution=step) if coarser else sensed


def _compute_scale(recording: Recording, other: Recording) -> float:
    """Factor from the torque of another recording of one motion to that of this one."""
    if recording.metadata.torque_unit == other.metadata.torque_unit:
        return 1.0
    return float(np.std(recording.torque) / max(float(np.std(other.torque)), 1e-300))


def _measure_visible(recording: Recording) -> SensorNoise:
    """Measure the noise of a recording. That of its torque is at least what rounding makes, and never zero."""
    noise, torque = measure_sensor_noise(recording), np.array(recording.torque)
    least = max(INPUT.least_noise * float(np.std(torque)), INPUT.rounding * find_encoder_step(torque))
    return SensorNoise(noise.period, max(noise.torque, least), noise.encoder_step, noise.position)


def _combine_noise(noise: TorqueNoise) -> float:
    """Combine both parts of a noise to the white noise that makes neighbouring samples differ as much. Slow motion of
    the torque looks like coloured noise of a long memory, which hardly counts here."""
    return float(np.sqrt(noise.white**2 + noise.coloured**2 * (1.0 - noise.memory) * (3.0 - noise.memory) / 3.0))


def _subtract_variance(whole: float, part: float) -> float:
    """Return the standard deviation of a noise without a part of it."""
    return float(np.sqrt(max(whole**2 - part**2, 0.0)))

"""The sensor chain: what a drive would write down of a motion, and what it would write without noise."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .compiled import compile_cached
from .dynamics import SAMPLE_PERIOD, Motion
from .joint import Joint

NOISES = ("white", "coloured", "heavy_tailed", "quantised", "jittered")


@dataclass(frozen=True)
class Sensors:
    """The chain from the joint to the file.

    Attributes:
        noise_kind: One of `NOISES`.
        noise: Standard deviation of the torque noise [N·m].
        colour: Correlation of neighbouring noise samples, where it is coloured.
        step: Of the torque's quantisation [N·m].
        jitter: Standard deviation of the sampling instant [s].
        filter_time: Time constant of the torque's low pass [s], below a third of a sample.
        gain: Of the torque [1].
        offset: Of the torque [N·m].
        delay: Of the torque [s].
        velocity_filter: Time constant of the usual low pass of a velocity channel [s].
        velocity_lag: That of a slower one in its place [s]; 0 for the usual one.
        hysteresis: Share of the torque that runs through a loop [1].
        hysteresis_width: Half width of the loop [N·m].
        hysteresis_form: 0 for a play element, 1 for Bouc-Wen.
    """

    noise_kind: str
    noise: float
    colour: float = 0.0
    step: float = 0.0
    jitter: float = 0.0
    filter_time: float = 2e-4
    gain: float = 1.0
    offset: float = 0.0
    delay: float = 0.0
    velocity_filter: float = 1e-3
    velocity_lag: float = 0.0
    hysteresis: float = 0.0
    hysteresis_width: float = 1.0
    hysteresis_form: float = 0.0


class Sensed(NamedTuple):
    """Channels of the recording, and the errors of the two that matter; all of shape (n_samples,)."""

    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    torque: NDArray[np.float64]
    load_torque: NDArray[np.float64]
    position_error: NDArray[np.float64]
    torque_error: NDArray[np.float64]


def draw_sensors(rng: np.random.Generator, joint: Joint, noise_kind: str | None) -> Sensors:
    """Ordinary sensors with the noise of the joint."""
    kind = noise_kind or str(rng.choice(NOISES))
    return Sensors(
        noise_kind=kind,
        noise=joint.noise,
        colour=float(np.exp(-SAMPLE_PERIOD * 2.0 * np.pi * rng.uniform(15.0, 60.0))) if kind == "coloured" else 0.0,
        step=2.0 * joint.noise if kind == "quantised" else 0.0,
        jitter=rng.uniform(1e-5, 4e-5) if kind == "jittered" else 0.0,
        filter_time=rng.uniform(5e-5, 2.5e-4),
        velocity_filter=rng.uniform(5e-4, 2e-3),
    )


def lag_signal(values: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """First-order low pass with a time constant [s], by the trapezoidal rule: slow signals are late by just that."""
    from scipy.signal import lfilter

    if time <= 0.0:
        return values
    gain = SAMPLE_PERIOD / (2.0 * time + SAMPLE_PERIOD)
    start = np.array([(1.0 - gain) * values[0]])
    return np.asarray(lfilter([gain, gain], [1.0, 2.0 * gain - 1.0], values, zi=start)[0])


def _delay_signal(values: NDArray[np.float64], time: float) -> NDArray[np.float64]:
    """Shift by any fraction of a sample, by cubic interpolation."""
    from scipy.interpolate import CubicSpline

    if time == 0.0:
        return values
    index = np.arange(values.size, dtype=np.float64)
    return np.asarray(CubicSpline(index, values)(np.maximum(index - time / SAMPLE_PERIOD, 0.0)))


@compile_cached
def _follow_loop(torque: np.ndarray, width: float, form: float) -> np.ndarray:
    """Hysteretic part of a torque cell: play of half width `width`, or the smooth loop of Bouc and Wen."""
    state, out = 0.0, np.empty_like(torque)
    last = torque[0]
    for i in range(torque.size):
        value = torque[i]
        if form > 0.0:
            change = value - last
            state += change * (1.0 - abs(state / width) * (0.5 + 0.5 * np.sign(change * state)))
            last = value
            out[i] = value - state
        else:
            state = min(max(state, value - width), value + width)
            out[i] = state
    return out


def distort_torque(torque: NDArray[np.float64], sensors: Sensors) -> NDArray[np.float64]:
    """What the effects of measurement make of a torque, without noise."""
    seen = torque
    if sensors.hysteresis > 0.0:
        loop = torque - _follow_loop(torque, sensors.hysteresis_width, sensors.hysteresis_form)
        seen = seen - sensors.hysteresis * loop
    return _delay_signal(sensors.gain * seen + sensors.offset, sensors.delay)


def _draw_noise(rng: np.random.Generator, sensors: Sensors, n: int) -> NDArray[np.float64]:
    """Torque noise of the standard deviation `sensors.noise` [N·m]; heavy tails have three degrees of freedom."""
    from scipy.signal import lfilter

    if sensors.noise_kind == "heavy_tailed":
        return np.asarray(sensors.noise * rng.standard_t(3.0, n) / np.sqrt(3.0))
    white = rng.standard_normal(n)
    if sensors.colour > 0.0:
        scale = np.sqrt(1.0 - sensors.colour**2)
        return np.asarray(sensors.noise * scale * lfilter([1.0], [1.0, -sensors.colour], white))
    return np.asarray(sensors.noise * (0.8 if sensors.step > 0.0 else 1.0) * white)


def sense(motion: Motion, sensors: Sensors, joint: Joint, plant: dict[str, float], rng: np.random.Generator) -> Sensed:
    """Sample, filter, delay, disturb and quantise a motion."""
    n = motion.position.size
    late = sensors.jitter * rng.standard_normal(n)
    amplitude, order = plant.get("eccentricity", 0.0), plant.get("eccentricity_order", 1.0)
    true = motion.position + amplitude * np.sin(order * motion.position + plant.get("eccentricity_phase", 0.0))
    step = joint.fields["resolution"]
    position = np.round((true + motion.velocity * late) / step) * step
    clean = distort_torque(motion.torque, sensors)
    torque = lag_signal(clean, sensors.filter_time) + np.gradient(clean, SAMPLE_PERIOD) * late
    torque = torque + _draw_noise(rng, sensors, n)
    if sensors.step > 0.0:
        torque = np.round(torque / sensors.step) * sensors.step
    # As a drive forms it: from the steps of its encoder, at instants of its own.
    difference = np.gradient(np.round(true / step) * step, SAMPLE_PERIOD)
    velocity = lag_signal(difference, sensors.velocity_lag or sensors.velocity_filter)
    velocity = velocity + 5e-4 * joint.speed * rng.standard_normal(n)
    load = motion.load + joint.noise * rng.standard_normal(n)
    return Sensed(position, velocity, torque, load, position - true, torque - clean)

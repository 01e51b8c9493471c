"""Where compensation wins and loses when gain, friction and delay are not what was assumed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.control import CompensationSettings, LoopDynamics
from fricomp.control.compensation.choice import choose_settings
from fricomp.control.compensation.curve import split_law
from fricomp.control.loop.loop_simulation import LoopCases, simulate_loop
from fricomp.laws import FloatArray
from fricomp.model import FrictionModel

from ...stand_in import SensorSettings
from .case import REVERSAL_WINDOW
from .joint import PERIOD, TrackedJoint, loop_of

_FREQUENCY, _AMPLITUDE = 0.1, 0.5


@dataclass(frozen=True)
class RobustnessMap:
    """RMS error over that without compensation, minus one. Shape (n_gains, n_scales, n_delays).

    Attributes:
        joint: Whose friction.
        bandwidth: Of the PD loop [Hz].
        gain: Factors on the chosen gain, shape (n_gains,) [1].
        scale: True over modelled friction, shape (n_scales,) [1].
        delay: Of the sensors, shape (n_delays,) [s].
        ours: Of the default compensation, RMS over the whole motion.
        rival: Of tanh-Coulomb-viscous.
        ours_reversal: Of the default, after reversals.
        rival_reversal: Of the rival, after reversals.
    """

    joint: TrackedJoint
    bandwidth: float
    gain: FloatArray
    scale: FloatArray
    delay: FloatArray
    ours: FloatArray
    rival: FloatArray
    ours_reversal: FloatArray
    rival_reversal: FloatArray

    @property
    def share_won(self) -> float:
        """Share of the cells in which the default has the lower RMS [1]."""
        return float(np.mean(self.ours < self.rival))

    @property
    def share_helps(self) -> float:
        """Share of the cells in which the default is better than no compensation [1]."""
        return float(np.mean(self.ours < 0.0))


def compute_robustness(
    joint: TrackedJoint,
    bandwidth: float,
    *,
    gain: Sequence[float] = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3),
    scale: Sequence[float] = (0.7, 0.85, 1.0, 1.15, 1.3),
    delay: Sequence[float] = (0.0, 0.001, 0.002, 0.004, 0.006, 0.008),
) -> RobustnessMap:
    """Simulate a sine of 0.5 rad at 0.1 Hz for every combination; settings are chosen for a delay of 1 ms.

    Args:
        joint: Whose friction.
        bandwidth: Of the PD loop [Hz].
        gain: Of the compensation, both methods [1].
        scale: True over modelled friction [1].
        delay: Of the sensors [s].
    """
    sensor = SensorSettings()
    _, loop = loop_of(bandwidth, sensor)
    # With no gain the method does not matter, so one plane of the first run serves both as "without".
    axes = np.meshgrid([0.0, *gain], scale, delay, indexing="ij")
    settings = choose_settings(joint.model, loop=loop)
    found = _simulate(joint, loop, axes, (settings, joint.model), sensor)
    model = joint.coulomb_viscous_model
    plain = choose_settings(model, source="reference", smoothing=settings.smoothing)
    other = _simulate(joint, loop, [axis[1:] for axis in axes], (plain, model), sensor)
    ours = [rms[1:] / rms[0] - 1.0 for rms in found]
    rival = [rms / base[0] - 1.0 for rms, base in zip(other, found, strict=True)]
    return RobustnessMap(
        joint,
        bandwidth,
        np.array(gain),
        np.array(scale),
        np.array(delay),
        ours[0],
        rival[0],
        ours[1],
        rival[1],
    )


def _simulate(
    joint: TrackedJoint,
    loop: LoopDynamics,
    axes: Sequence[FloatArray],
    compensation: tuple[CompensationSettings, FrictionModel],
    sensor: SensorSettings,
) -> tuple[FloatArray, FloatArray]:
    """RMS error, over the motion and after reversals, each of the shape of the axes [rad]."""
    gain, scale, delay = (axis.ravel() for axis in axes)
    settings, model = compensation
    truth, compensated = split_law(joint.law), split_law(model.law)
    cases = LoopCases(loop, gain, scale, delay + 0.5 * PERIOD, sensor.velocity_quantum(PERIOD), sensor.velocity_filter)
    time = np.arange(0.0, 1.0 / _FREQUENCY + 0.5, PERIOD)
    omega = 2.0 * np.pi * _FREQUENCY
    reference = _AMPLITUDE * (1.0 - np.cos(omega * time)), _AMPLITUDE * omega * np.sin(omega * time)
    done = simulate_loop(truth, settings, cases, reference, period=PERIOD, compensated=compensated)
    error = reference[0][:, None] - done.position
    settled = time > 0.3 / _FREQUENCY
    half = 0.5 / _FREQUENCY
    reversal = settled & (np.mod(time, half) < REVERSAL_WINDOW)
    shape = axes[0].shape
    with np.errstate(over="ignore"):
        rms = [np.sqrt(np.mean(error[rows] ** 2, axis=0)).reshape(shape) for rows in (settled, reversal)]
    return rms[0], rms[1]

"""Where a loop with friction and its compensation starts to oscillate: describing functions, with the delay.

The joint obeys J q'' = u - F(v), the loop u = e^(-sT) (K e - D v + g C(v_r, v)). For v = v_0 + A sin(w t) friction
and compensation act like damping N_F(A) and N_C(A) [armstrong1994survey; olsson1998], so that an oscillation of
amplitude A grows if

    J s^2 + K e^(-sT) + s (D H + N_F - g N_C H) = 0,  H = e^(-sT)/(1 + s T_v)

has a root in the right half plane; their number is counted from the winding of the left side along s = jw.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from fricomp.control.compensation.batch import compute_compensation, compute_friction
from fricomp.control.compensation.curve import FrictionCurves
from fricomp.control.settings import CompensationSettings, LoopDynamics
from fricomp.laws import FloatArray

BoolArray = NDArray[np.bool_]

HIGHEST_GAIN = 4.0
"""Gain up to which oscillations are looked for [1]."""

LIMIT_CYCLE_MARGIN = 1.15
"""Gain at the limit cycle over gain in use that the default keeps [1]."""

_GAIN_STEPS = 31
_AMPLITUDES = 20
_SPEEDS = 5
_PHASES = 64
_FREQUENCIES = 200


class Oscillation(NamedTuple):
    """An oscillation that grows.

    Attributes:
        velocity: Reference velocity around which it does [rad/s] or [m/s].
        amplitude: Largest amplitude of velocity at which it still grows [rad/s] or [m/s].
        at_gains: For each gain that was asked for, whether any oscillation grows. Shape (n_gains,).
    """

    velocity: float
    amplitude: float
    at_gains: BoolArray


def find_oscillation(
    curves: FrictionCurves, loop: LoopDynamics, settings: CompensationSettings, gains: FloatArray
) -> Oscillation:
    """Look for growing oscillations at rest and around steady speeds of both directions.

    Args:
        curves: The joint's friction, which is also what is compensated.
        loop: The position loop.
        settings: Source, smoothing and so on; its gain is not used.
        gains: Gains of the compensation to try, shape (n_gains,) [1].
    """
    speeds = steady_speeds(curves, settings)
    amplitude = np.geomspace(0.02 * settings.smoothing, 2.0 * settings.velocity_range[1], _AMPLITUDES)
    grows = np.stack([_does_grow(curves, loop, settings, gains, v, amplitude) for v in speeds])
    at_gains: BoolArray = np.asarray(grows.any(axis=(0, 2)))
    if not at_gains.any():
        return Oscillation(0.0, 0.0, at_gains)
    row = int(np.argmax(grows.sum(axis=(1, 2))))
    widest = int(np.flatnonzero(grows[row].any(axis=0))[-1])
    return Oscillation(float(speeds[row]), float(amplitude[widest]), at_gains)


def find_gain_limit(curves: FrictionCurves, loop: LoopDynamics, settings: CompensationSettings) -> float:
    """Lowest gain from `settings.gain` on at which an oscillation grows; 0 if one grows there already, else up to 4.

    Returns:
        The gain [1]; 4 where none was found below.
    """
    gains = np.linspace(settings.gain, HIGHEST_GAIN, _GAIN_STEPS)
    at_gains = find_oscillation(curves, loop, settings, gains).at_gains
    if not at_gains.any():
        return HIGHEST_GAIN
    first = int(np.argmax(at_gains))
    return 0.0 if first == 0 else float(gains[first - 1])


def steady_speeds(curves: FrictionCurves, settings: CompensationSettings) -> FloatArray:
    """Rest, and speeds around the Stribeck velocity and up to the end of the range, in both directions."""
    top = min(-settings.velocity_range[0], settings.velocity_range[1])
    slow = 0.3 * (curves.stribeck_velocity or 0.1 * top)
    speeds = np.geomspace(min(slow, 0.5 * top), top, _SPEEDS)
    return np.concatenate([[0.0], speeds, -speeds])


def _does_grow(
    curves: FrictionCurves,
    loop: LoopDynamics,
    settings: CompensationSettings,
    gains: FloatArray,
    speed: float,
    amplitude: FloatArray,
) -> BoolArray:
    """Whether the oscillation around `speed` grows. Shape (n_gains, n_amplitudes)."""
    sine = np.sin(2.0 * np.pi * (np.arange(_PHASES) + 0.5) / _PHASES)
    velocity = speed + amplitude[:, None] * sine
    reference = np.full_like(velocity, speed)
    friction = 2.0 * np.mean(compute_friction(curves, velocity) * sine, axis=1) / amplitude
    compensation = 2.0 * np.mean(compute_compensation(curves, settings, reference, velocity) * sine, axis=1) / amplitude
    return _count_unstable(loop, friction[None, :], gains[:, None] * compensation[None, :]) > 0.5


def _count_unstable(loop: LoopDynamics, friction: FloatArray, compensation: FloatArray) -> FloatArray:
    """Number of roots in the right half plane, from the winding along the imaginary axis."""
    natural = np.sqrt(max(loop.stiffness, 1e-9) / loop.inertia)
    damping = float(np.max(np.abs(friction)) + np.max(np.abs(compensation))) + loop.damping
    top = 30.0 * max(natural, damping / loop.inertia, 1.0)
    omega = np.concatenate([[0.0], np.geomspace(1e-4 * natural, top, _FREQUENCIES)])
    s = 1j * omega[:, None, None]
    late = np.exp(-s * loop.delay)
    seen = late / (1.0 + s * loop.velocity_filter)
    z = loop.inertia * s**2 + loop.stiffness * late + s * (loop.damping * seen + friction - compensation * seen)
    turns = np.sum(np.angle(z[1:] / z[:-1]), axis=0)
    return np.asarray(np.rint(1.0 - turns / np.pi), dtype=np.float64)

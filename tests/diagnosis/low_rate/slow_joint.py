"""A joint under a PD loop, logged too slowly for its reversals to be seen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fricomp.recording import Recording, RecordingMetadata

__all__ = ["COULOMB", "INERTIA", "VISCOUS", "slow_log"]

INERTIA, COULOMB, VISCOUS = 0.06, 0.35, 0.2
"""Of the joint [kg·m², N·m, N·m·s/rad]."""
_STEP = 1e-3


def slow_log(
    rate: float,
    seed: int,
    *,
    seconds: float = 70.0,
    gravity: float = 0.0,
    load: float = 0.0,
    ripple: tuple[float, float] = (0.0, 0.0),
    more: Callable[[float, float], float] | None = None,
    delay: float = 0.0,
) -> Recording:
    """A recording at `rate` [Hz] whose torque is stamped `delay` [s] late.

    Args:
        rate: Rows a second.
        seed: Of the motion's phases and the noise.
        seconds: Its length.
        gravity: Torque of gravity, times the sine of the angle [N·m].
        load: Friction in parts of the size of gravity.
        ripple: Amplitude [N·m] and order [1/rad] of a torque over the angle.
        more: Further torque against the motor, by position [rad] and velocity [rad/s] [N·m].
        delay: By how much the torque is stamped late.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(int(seconds / _STEP), dtype=np.float64) * np.float64(_STEP)
    swings = [
        a * np.sin(2.0 * np.pi * f * t + rng.uniform(0.0, 6.28)) for a, f in ((1.1, 0.12), (0.5, 0.27), (0.1, 0.8))
    ]
    reference = np.sum(swings, axis=0)
    speed = np.gradient(reference, _STEP)
    q, v, rows = float(reference[0]), float(speed[0]), np.empty((t.size, 2))
    for k, (r, s) in enumerate(zip(reference.tolist(), speed.tolist(), strict=True)):
        torque = 60.0 * (r - q) + 4.0 * (s - v)
        rows[k] = q, torque
        weight, wave = gravity * np.sin(q), ripple[0] * np.sin(ripple[1] * q)
        further = 0.0 if more is None else more(q, v)
        free = v + _STEP / INERTIA * (torque - VISCOUS * v - weight - wave - further)
        v = float(np.copysign(max(abs(free) - _STEP / INERTIA * (COULOMB + load * abs(weight)), 0.0), free))
        q += _STEP * v
    every = round(1.0 / rate / _STEP)
    torque = np.interp(t - delay, t, rows[:, 1])[::every]
    count = 2.0 * np.pi / 2**15
    position = np.round(rows[::every, 0] / count) * count
    return Recording(
        t[::every], position, torque + rng.normal(0.0, 0.012, torque.size), metadata=RecordingMetadata(joint="slow")
    )

"""A motion of all joints as a sum of sines that starts and ends at rest [swevers1997].

    q_j(t) = c_j + w(t) Σ_k (a_jk sin(k ω t) + b_jk (cos(k ω t) - 1))

with w rising from 0 to 1 and falling again, so that position, velocity and acceleration are those of rest at both ends.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fricomp.control import ReferenceState
from fricomp.laws import FloatArray


@dataclass(frozen=True)
class FourierMotion:
    """A motion over time.

    Attributes:
        centre: c of each joint [rad] or [m]. Shape (n_joints,).
        sine: a [rad] or [m]. Shape (n_joints, n_harmonics).
        cosine: b [rad] or [m]. Shape (n_joints, n_harmonics).
        frequency: Of the first harmonic [Hz].
        duration: [s].
        ramp: Time over which w rises and falls [s].
    """

    centre: FloatArray
    sine: FloatArray
    cosine: FloatArray
    frequency: float
    duration: float
    ramp: float = 3.0

    def scaled(self, share: float) -> FourierMotion:
        """The same motion with all swings shorter."""
        return FourierMotion(
            self.centre, share * self.sine, share * self.cosine, self.frequency, self.duration, self.ramp
        )

    def sample(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Position, velocity and acceleration of all joints [SI]. Shapes (n, n_joints)."""
        steps = 2.0 * np.pi * self.frequency * np.arange(1, self.sine.shape[1] + 1)
        angle = np.outer(time, steps)
        s, c = np.sin(angle), np.cos(angle)
        x = s @ self.sine.T + (c - 1.0) @ self.cosine.T
        v = (c * steps) @ self.sine.T - (s * steps) @ self.cosine.T
        a = -(s * steps**2) @ self.sine.T - (c * steps**2) @ self.cosine.T
        w, w1, w2 = (each[:, None] for each in _open_and_close(time, self.duration, self.ramp))
        return self.centre + w * x, w1 * x + w * v, w2 * x + 2.0 * w1 * v + w * a


def _open_and_close(time: FloatArray, duration: float, ramp: float) -> tuple[FloatArray, FloatArray, FloatArray]:
    """w and its derivatives: 10 s³ - 15 s⁴ + 6 s⁵ at both ends."""
    rise, fall = np.clip(time / ramp, 0.0, 1.0), np.clip((duration - time) / ramp, 0.0, 1.0)
    s = np.minimum(rise, fall)
    sign = np.where(rise <= fall, 1.0, -1.0) / ramp
    w = s**3 * (10.0 - 15.0 * s + 6.0 * s**2)
    return w, sign * 30.0 * s**2 * (1.0 - s) ** 2, sign**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s)


class ReferenceTable:
    """A motion as the reference of a control loop: from where the joints stand to the start, and on.

    Args:
        motion: The motion.
        start: Where the joints stand [rad] or [m].
        approach: Time of the way to the motion's start [s].
        period: Between the rows of the table [s].
    """

    def __init__(self, motion: FourierMotion, start: FloatArray, approach: float, period: float) -> None:
        self.approach, self.duration = approach, approach + motion.duration
        time = np.arange(0.0, self.duration, period)
        s = np.clip(time / approach, 0.0, 1.0)[:, None]
        way = motion.centre - start
        on = (time > approach)[:, None]
        position, velocity, acceleration = motion.sample(np.maximum(time - approach, 0.0))
        self.position = np.where(on, position, start + way * s**3 * (10.0 - 15.0 * s + 6.0 * s**2))
        self._velocity = np.where(on, velocity, way * 30.0 * s**2 * (1.0 - s) ** 2 / approach)
        self._acceleration = np.where(on, acceleration, way * 60.0 * s * (1 - s) * (1 - 2 * s) / approach**2)
        self._rate, self._last = 1.0 / period, time.size - 1

    def sample(self, time: float, state: ReferenceState) -> None:
        """Fill in the reference at `time` since the start of the loop [s]."""
        at = min(max(time * self._rate, 0.0), float(self._last))
        k = min(int(at), self._last - 1)
        part = at - k
        for table, into in (
            (self.position, state.position),
            (self._velocity, state.velocity),
            (self._acceleration, state.acceleration),
        ):
            into[:] = ((1.0 - part) * table[k] + part * table[k + 1]).tolist()

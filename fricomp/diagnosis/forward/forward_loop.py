"""The loop and the drive of a joint that is simulated forward, with their states."""

from __future__ import annotations

from cmath import exp

import numpy as np

from ..inputs.controller import Controller
from ..inputs.track import FloatArray, Track


class Loop:
    """The controller with its state: the last position, the filtered velocity, the integral, and its answer."""

    def __init__(self, controller: Controller, track: Track, reference: FloatArray, start: int, step: float) -> None:
        self.controller = controller
        self.every = 1 if controller.frequency is None else max(1, round(1.0 / (controller.frequency * step)))
        self.period, self.wait, self.answer = self.every * step, 0, 0.0
        self.keep = controller.compute_filter_memory(self.period)
        self.wanted: list[float] = reference[0].tolist()
        self.speed: list[float] = reference[1].tolist()
        self.acceleration: list[float] = np.gradient(reference[1], track.dt).tolist()
        q, self.seen, self.integral = float(track.position[start]), float(track.velocity[start]), 0.0
        self.before = q - self.seen * self.period
        if controller.integral_gain:
            begun = self.before, self.seen
            rest = float(track.torque[start]) - self._compute_unlimited(start, q)
            (self.before, self.seen), self.integral = begun, rest / controller.integral_gain

    def compute_torque(self, k: int, q: float) -> float:
        """Torque in sample `k` at the simulated position [N·m], which holds until the loop sees the next one."""
        if self.wait == 0:
            wanted, limit = self._compute_unlimited(k, q), self.controller.torque_limit
            self.answer = wanted if limit is None else min(max(wanted, -limit), limit)
            self.wait = self.every
        self.wait -= 1
        return self.answer

    def _compute_unlimited(self, k: int, q: float) -> float:
        """Torque that the loop would give without a limit [N·m]."""
        c = self.controller
        rate, self.before = (q - self.before) / self.period, q
        self.seen = rate + (self.seen - rate) * self.keep
        error = self.wanted[k] - q
        self.integral += error * self.period
        damping = c.derivative_gain * (c.reference_share * self.speed[k] - self.seen)
        steady = c.proportional_gain * error + c.integral_gain * self.integral + c.bias
        return steady + damping + c.acceleration_gain * self.acceleration[k]


class Drive:
    """What the drive makes of its command: the low passes that were named, with their states."""

    def __init__(self, lags: tuple[complex, ...], torque: float, step: float) -> None:
        self.keep = [exp(-step / lag) for lag in lags]
        self.states: list[complex] = [torque] * len(self.keep)

    def follow(self, torque: float) -> float:
        """Torque that acts a step later [N·m]."""
        passed: complex = torque
        for i, keep in enumerate(self.keep):
            passed = self.states[i] = passed + (self.states[i] - passed) * keep
        return passed.real

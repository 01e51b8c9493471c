"""The loop and the drive of a joint that is simulated forward, with their states."""

from __future__ import annotations

from math import exp

import numpy as np

from .controller import Controller
from .track import FloatArray, Track

__all__ = ["Drive", "Loop"]


class Loop:
    """The controller with its state: the filtered velocity and the integral."""

    def __init__(self, controller: Controller, track: Track, reference: FloatArray, start: int, step: float) -> None:
        self.controller, self.step, self.integral = controller, step, 0.0
        self.keep = controller.filtered(step)
        self.seen = float(track.velocity[start])
        self.wanted: list[float] = reference[0].tolist()
        self.speed: list[float] = reference[1].tolist()
        self.acceleration: list[float] = np.gradient(reference[1], track.dt).tolist()
        if controller.integral_gain:
            rest = float(track.torque[start]) - self.torque(start, float(track.position[start]), self.seen)
            self.integral = rest / controller.integral_gain

    def torque(self, k: int, q: float, w: float) -> float:
        """Torque at sample `k` for the simulated position and velocity [N·m]."""
        c = self.controller
        self.seen = w + (self.seen - w) * self.keep
        error = self.wanted[k] - q
        self.integral += error * self.step
        damping = c.derivative_gain * (c.reference_share * self.speed[k] - self.seen)
        steady = c.proportional_gain * error + c.integral_gain * self.integral + c.bias
        total = steady + damping + c.acceleration_gain * self.acceleration[k]
        limit = c.torque_limit
        return total if limit is None else min(max(total, -limit), limit)


class Drive:
    """What the drive makes of its command: the low passes that were named, with their states."""

    def __init__(self, lags: tuple[float, ...], torque: float, step: float) -> None:
        self.keep = [exp(-step / lag) for lag in lags]
        self.states = [torque] * len(self.keep)

    def follow(self, torque: float) -> float:
        """Torque that acts a step later [N·m]."""
        for i, keep in enumerate(self.keep):
            torque = self.states[i] = torque + (self.states[i] - torque) * keep
        return torque

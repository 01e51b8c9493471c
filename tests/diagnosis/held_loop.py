"""Joints under a PD loop that holds its torque, integrated by Runge and Kutta's rule, for the forward simulation."""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin

import numpy as np
from numpy.typing import NDArray

from fricomp.diagnosis.effects.forward_part import ForwardPart
from fricomp.diagnosis.forward.forward_joint import Run
from fricomp.diagnosis.inputs.controller import Controller
from fricomp.diagnosis.inputs.track import Track
from fricomp.diagnosis.joint.observer import Plant

__all__ = ["DT", "Derivative", "moved", "run_of"]

FloatArray = NDArray[np.float64]
State = tuple[float, ...]
Derivative = Callable[[State, float], State]
"""Rates of a joint's state, motor position and velocity first, under a torque [N·m]."""

DT = 1e-3  # [s] of a sample, for which the loop holds its torque
_LOOP = Controller(300.0, 12.0, frequency=1.0 / DT)
_STEPS = 20  # of a sample


def _reference(seconds: float) -> FloatArray:
    """Position [rad] and velocity [rad/s] that rest, turn and go at several speeds. Shape (2, n)."""
    t = np.arange(round(seconds / DT), dtype=np.float64) * np.float64(DT)
    position = 0.25 * np.sin(1.7 * t) + 0.1 * np.sin(4.1 * t) - 0.05 * np.sin(9.0 * t)
    return np.stack([position, np.gradient(position, DT)])


def moved(rates: Derivative, rest: State, *, seconds: float = 4.0) -> tuple[Track, FloatArray]:
    """What the joint does from `rest`, and the reference that it is told."""
    reference, state, before = _reference(seconds), rest, rest[0]
    seen = np.empty((2, reference.shape[1]))
    for k in range(reference.shape[1]):
        q, speed = state[0], (state[0] - before) / DT
        torque = _LOOP.proportional_gain * (reference[0, k] - q) + _LOOP.derivative_gain * (reference[1, k] - speed)
        seen[:, k], before = (q, torque), q
        for _ in range(_STEPS):
            state = _step(rates, state, float(torque), DT / _STEPS)
    return Track.build(DT, *seen), reference


def _step(rates: Derivative, x: State, torque: float, h: float) -> State:
    def ahead(slope: State, share: float) -> State:
        return tuple(a + share * h * b for a, b in zip(x, slope, strict=True))

    first = rates(x, torque)
    second = rates(ahead(first, 0.5), torque)
    third = rates(ahead(second, 0.5), torque)
    fourth = rates(ahead(third, 1.0), torque)
    mean = tuple((a + 2.0 * b + 2.0 * c + d) / 6.0 for a, b, c, d in zip(first, second, third, fourth, strict=True))
    return ahead(mean, 1.0)


def run_of(track: Track, reference: FloatArray, plant: Plant, effects: ForwardPart | None = None) -> Run:
    """Its forward simulation from rest, as another joint."""
    return Run(plant, track, reference, _LOOP, 0, track.size, effects or ForwardPart())


def gravity_of(plant: Plant, q: float) -> float:
    """Torque of gravity [N·m]."""
    return plant.gravity[0] * cos(q) + plant.gravity[1] * sin(q)

"""Columns of what may act in one joint, made of its motion: samples that pass the filters of the torques."""

from __future__ import annotations

import numpy as np

from fricomp.laws import FloatArray

from .friction import ORDERS, TERMS, VISCOUS_EXPONENTS
from .rows import ArmRows

_LEAST_RATIO = 1e-9
"""Of a speed to the Stribeck velocity: a joint at rest has the whole excess."""

_LEAD = 0.02 * 0.95 / 2.0
"""[s] by which such friction is ahead of the velocity: half of MuJoCo's default time constant times its impedance."""

CREEP_ROUNDING = 0.75
"""Smoothing velocity of a hyperbolic tangent over the speed at which friction that creeps reaches its level, at which
the two differ least in the mean square up to twice that speed."""


def plain_columns(rows: ArmRows, joint: int) -> FloatArray:
    """Columns of one joint that `PLAIN` lists. Shape (n, 4)."""

    def build(_: FloatArray, velocity: FloatArray, __: FloatArray) -> FloatArray:
        v = velocity[:, joint]
        return np.stack([np.sign(v), np.ones_like(v), v, np.abs(v)], axis=1)

    return rows.compare(build)


def friction_columns(rows: ArmRows, joint: int, top_speed: float, *, rotary: bool = True) -> FloatArray:
    """Columns of one joint that are made of its motion and temperature.

    Args:
        rows: The equations.
        joint: Number of the joint.
        top_speed: Of the joint [rad/s] or [m/s].
        rotary: Whether it turns.

    Returns:
        Shape (n, n_columns).
    """
    middle = float(np.mean(np.concatenate([q[:, joint] for q, _, _ in rows.motion])))
    distances = TERMS["presliding_hysteresis"].list_values(rotary=rotary)

    def build(position: FloatArray, velocity: FloatArray, _: FloatArray) -> FloatArray:
        q, v = position[:, joint], velocity[:, joint]
        s = np.sign(v)
        columns = [turn_bristle(q, distance) - s for distance in distances]
        columns += [wave(n * q) * s for n in ORDERS for wave in (np.cos, np.sin)]
        columns += [v * np.abs(v)]
        columns += [s * (np.abs(v) / top_speed) ** n for n in VISCOUS_EXPONENTS]
        columns += [q - middle]
        return np.stack(columns, axis=1)

    warmth = [each[:, joint] for each in rows.warmth]
    warm = [
        np.stack([np.sign(v[:, joint]) * w, v[:, joint] * w], axis=1)
        for (_, v, _), w in zip(rows.motion, warmth, strict=True)
    ]
    return np.column_stack([plain_columns(rows, joint), rows.compare(build), rows.compare_samples(warm)])


def stribeck_columns(rows: ArmRows, joint: int, speed: float, exponent: float) -> FloatArray:
    """The Stribeck curve of one joint at a Stribeck velocity [rad/s] or [m/s]. Shape (n, 4)."""

    def build(_: FloatArray, velocity: FloatArray, __: FloatArray) -> FloatArray:
        v = velocity[:, joint]
        s, ratio = np.sign(v), np.maximum(np.abs(v / speed), _LEAST_RATIO)
        power = ratio**exponent
        fall = np.exp(-power)
        moved = s * exponent * power * fall
        return np.stack([s * fall, fall, moved, -np.log(ratio) * moved], axis=1)

    return rows.compare(build)


def creep_columns(rows: ArmRows, joint: int, speed: float, *, rounded: bool) -> FloatArray:
    """Friction of one joint that creeps below a speed [rad/s] or [m/s], less friction that sticks. Shape (n, 2).

    That of MuJoCo has a corner there and is ahead of the velocity; others are a hyperbolic tangent of the velocity.
    """

    def build(_: FloatArray, velocity: FloatArray, acceleration: FloatArray) -> FloatArray:
        v = velocity[:, joint]
        if rounded:
            ratio = v / (CREEP_ROUNDING * speed)
            part = np.tanh(ratio)
            return np.stack([part - np.sign(v), -ratio * (1.0 - part**2)], axis=1)
        ratio = (v + _LEAD * acceleration[:, joint]) / speed
        return np.stack([np.clip(ratio, -1.0, 1.0) - np.sign(v), np.where(np.abs(ratio) < 1.0, -ratio, 0.0)], axis=1)

    return rows.compare(build)


def load_columns(load: FloatArray, sign: FloatArray) -> FloatArray:
    """Columns that follow the transmitted torque [N·m] or [N], in the order of `column_names`. Shape (n, 3)."""
    return np.column_stack([np.abs(load) * sign, load**2 * sign, load])


def ripple_columns(rows: ArmRows, joint: int, order: float) -> FloatArray:
    """A wave over the position of a joint. Shape (n, 2)."""

    def build(position: FloatArray, _: FloatArray, __: FloatArray) -> FloatArray:
        angle = order * position[:, joint]
        return np.stack([np.cos(angle), np.sin(angle)], axis=1)

    return rows.compare(build)


def turn_bristle(position: FloatArray, distance: float) -> FloatArray:
    """Part of its level that a bristle holds along a path, from -1 to 1, by Dahl's law [dahl1968]. Shape (n,).

    Between two turns the path runs one way, and z - s falls by exp(-travel / distance).
    """
    steps = np.diff(position)
    moving = np.flatnonzero(steps)
    result = np.zeros_like(position)
    if not moving.size:
        return result
    ways = np.sign(steps[moving])
    turns = [0, *(np.flatnonzero(np.diff(ways)) + 1).tolist()]
    starts = [int(moving[k]) for k in turns]
    for k, first, last in zip(turns, starts, [*starts[1:], len(steps)], strict=True):
        travel = np.abs(position[first + 1 : last + 1] - position[first])
        result[first + 1 : last + 1] = ways[k] + (result[first] - ways[k]) * np.exp(-travel / distance)
    return result

"""A generic basis: any smooth torque over the joint's state and time, to see how much a named effect leaves over."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..effects import Context
from ..inputs.track import FloatArray
from ..joint.problem import Problem

_BINS = {"velocity": 7, "position": 8, "acceleration": 5, "load": 5, "reversal": 6, "time": 10, "level": 6, "slow": 4}
"""Knots of each spline. More of them explain noise, fewer miss what no effect says."""


def build_generic_rows(problem: Problem, contexts: Sequence[Context]) -> FloatArray:
    """Weighted rows of the generic basis. Shape (m, d)."""
    assert problem.weights is not None
    zero = problem.weights.mean
    parts = []
    quantities = [_list_quantities(context) for context in contexts]
    for name in quantities[0]:
        values = np.concatenate([q[name][0] for q in quantities])
        knots = _place_knots(values, _BINS.get(name.split(":")[0], 5))
        columns = [_build_hats(q[name][0], knots) * q[name][1][:, None] for q in quantities]
        for i in range(knots.size):
            rows = [grid.average(c[:, i]) + mean for grid, c, mean in zip(problem.grids, columns, zero, strict=True)]
            parts.append(problem.weights.apply(rows))
    return np.stack(parts, axis=1)


def _list_quantities(context: Context) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Argument of each spline, and the factor it is multiplied with."""
    v = context.velocity
    top = max(float(np.quantile(np.abs(v), 0.95)), 1e-6)
    one, sign = np.ones_like(v), np.sign(v) * (np.abs(v) > min(2e-3, 0.02 * top))
    since = np.log10(measure_time_since_reversal(v, context.dt, min(3e-3, 0.03 * top)) + 0.01)
    speed = np.sign(v) * np.sqrt(np.abs(v) / top)
    return {
        "velocity": (speed, one),
        "position": (context.position, one),
        "level:position": (context.position, sign),
        "acceleration": (np.clip(context.acceleration, *np.quantile(context.acceleration, [0.01, 0.99])), one),
        "load": (context.load_torque, sign),
        "reversal": (since, sign),
        "time": (context.time, one),
        "level:time": (context.time, sign),
        "slow:load": (context.load_torque, v / top),
        "slow:time": (context.time, v / top),
    }


def _place_knots(values: FloatArray, count: int) -> FloatArray:
    """Knots at quantiles, thinned where they fall together."""
    knots = np.unique(np.quantile(values, np.linspace(0.0, 1.0, count)))
    keep = np.concatenate([[True], np.diff(knots) > 0.02 * (knots[-1] - knots[0])])
    return knots[keep] if keep.sum() > 1 else np.array([values.min(), values.max() + 1e-9])


def _build_hats(values: FloatArray, knots: FloatArray) -> FloatArray:
    """Piecewise linear hat functions at the knots. Shape (n, knots)."""
    return np.stack([np.interp(values, knots, unit) for unit in np.eye(knots.size)], axis=1, dtype=np.float64)


def measure_time_since_reversal(velocity: FloatArray, dt: float, threshold: float = 3e-3) -> FloatArray:
    """Measure the time since the direction of motion last changed or motion began [s]. Shape (n,)."""
    direction = np.sign(velocity) * (np.abs(velocity) > threshold)
    moving = direction != 0.0
    last = np.where(moving, np.arange(velocity.size), 0)
    held = direction[np.maximum.accumulate(last)]
    index = np.arange(velocity.size)
    change = np.concatenate([[True], held[1:] != held[:-1]])
    started = np.concatenate([[True], moving[1:] & ~moving[:-1]])
    since = index - np.maximum.accumulate(np.where(change | started, index, 0))
    return np.asarray(since * dt, dtype=np.float64)

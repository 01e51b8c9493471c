"""Least squares for simulated residuals: Gauss-Newton with damping, bounds, priors and cheap Jacobian updates."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from .track import FloatArray

__all__ = ["Box", "Fit", "finite_differences", "minimise"]

Residual = Callable[[Sequence[FloatArray]], list[FloatArray]]


@dataclass(frozen=True)
class Box:
    """Domain of the parameters.

    Attributes:
        lower: Lower bounds. Shape (p,).
        upper: Upper bounds. Shape (p,).
        scale: Change of each parameter that matters; differences are taken over a small part of it. Shape (p,).
        centre: Where a weak prior pulls each parameter. Shape (p,).
        weight: Strength of that pull, as one over its standard deviation; 0 for none. Shape (p,).
        reach: Longest step, in units of `scale`. Shape (p,).
    """

    lower: FloatArray
    upper: FloatArray
    scale: FloatArray
    centre: FloatArray
    weight: FloatArray
    reach: FloatArray

    def clip(self, theta: FloatArray) -> FloatArray:
        """The nearest point inside."""
        return np.clip(theta, self.lower, self.upper)

    def joined(self, other: Box) -> Box:
        """This domain with further parameters behind."""
        pairs = zip(self.__dict__.values(), other.__dict__.values(), strict=True)
        return Box(*(np.concatenate(pair) for pair in pairs))


@dataclass(frozen=True)
class Fit:
    """A minimum.

    Attributes:
        theta: Parameters. Shape (p,).
        residual: Residual there. Shape (m,).
        jacobian: Its derivative, exact or updated. Shape (m, p).
        cost: Sum of squares, priors included.
    """

    theta: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    cost: float


def finite_differences(
    evaluate: Residual, theta: FloatArray, at: FloatArray, box: Box, which: Sequence[int]
) -> FloatArray:
    """Columns of the Jacobian for the parameters `which`, by one-sided differences. Shape (m, len(which))."""
    points, steps = [], []
    for i in which:
        step = 0.02 * box.scale[i]
        if theta[i] + step > box.upper[i]:
            step = -step
        point = theta.copy()
        point[i] += step
        points.append(point)
        steps.append(step)
    values = evaluate(points)
    columns = np.stack([(value - at) / step for value, step in zip(values, steps, strict=True)], axis=1)
    return np.where(np.isfinite(columns), columns, 0.0)


def minimise(
    evaluate: Residual,
    theta: FloatArray,
    box: Box,
    *,
    jacobian: FloatArray | None = None,
    iterations: int = 8,
    refresh: int = 1,
    tolerance: float = 1e-3,
) -> Fit:
    """Least squares from `theta`.

    Args:
        evaluate: Residuals at several points at once.
        theta: Start.
        box: Domain and priors.
        jacobian: Jacobian at the start where it is known.
        iterations: Most steps.
        refresh: Compute the Jacobian afresh every so many steps; between them it is updated by Broyden's formula.
        tolerance: Stop when the cost falls by less than this share of the mean squared residual times ten.
    """
    theta = box.clip(theta)
    residual = evaluate([theta])[0]
    cost = _cost(residual, theta, box)
    everything = range(theta.size)
    J = finite_differences(evaluate, theta, residual, box, everything) if jacobian is None else jacobian
    damping, age = 1e-3, 0
    for _ in range(iterations):
        trials = [_step(J, residual, theta, box, d) for d in (damping, 30 * damping)]
        values = evaluate(trials)
        costs = [_cost(value, trial, box) for value, trial in zip(values, trials, strict=True)]
        best = int(np.argmin(costs))
        gain = cost - costs[best]
        if gain <= 0.0:
            if age == 0 and damping > 10.0:
                break
            damping *= 100.0
            if age:
                J, age = finite_differences(evaluate, theta, residual, box, everything), 0
            continue
        move = trials[best] - theta
        J = J + np.outer(values[best] - residual - J @ move, move / box.scale**2) / max(
            float(np.sum((move / box.scale) ** 2)), 1e-30
        )
        theta, residual, cost, age = trials[best], values[best], costs[best], age + 1
        damping = max(1e-6, damping * (0.1 if best == 0 else 10.0))
        if gain < tolerance * 10.0 * cost / residual.size:
            break
        if age >= refresh:
            J, age = finite_differences(evaluate, theta, residual, box, everything), 0
    return Fit(theta, residual, J, cost)


def _cost(residual: FloatArray, theta: FloatArray, box: Box) -> float:
    pull = box.weight * (theta - box.centre)
    value = float(residual @ residual + pull @ pull)
    return value if np.isfinite(value) else np.inf


def _step(J: FloatArray, residual: FloatArray, theta: FloatArray, box: Box, damping: float) -> FloatArray:
    """Damped step in scaled parameters; those that would leave the box stay at its edge."""
    free = np.ones(theta.size, dtype=bool)
    target = theta
    for _ in range(3):
        S = box.scale[free]
        A = J[:, free] * S
        H = A.T @ A + np.diag((box.weight[free] * S) ** 2)
        g = (
            A.T @ (residual + J[:, ~free] @ (target - theta)[~free])
            + S * box.weight[free] ** 2 * (theta - box.centre)[free]
        )
        H += damping * np.diag(np.diag(H) + 1e-9 * np.trace(H) / H.shape[0])
        move = np.zeros(theta.size)
        move[free] = -S * np.linalg.lstsq(H, g, rcond=1e-12)[0]
        move[~free] = (target - theta)[~free]
        move = np.clip(move, -box.reach * box.scale, box.reach * box.scale)
        target = box.clip(theta + move)
        outside = free & (np.abs(target - theta - move) > 1e-12)
        if not outside.any():
            break
        free &= ~outside
    return target

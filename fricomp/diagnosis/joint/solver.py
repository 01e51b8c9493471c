"""Least squares for simulated residuals: Gauss-Newton with damping, bounds, priors and cheap Jacobian updates."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from ..inputs.track import FloatArray
from .race import Entry, Race
from .settings import JOINT

__all__ = [
    "Box",
    "Descent",
    "Fit",
    "choose_steps",
    "descend",
    "is_beaten",
    "minimise",
    "raise_diagonal",
    "run_together",
    "split_evaluation",
]


Residual = Callable[[Sequence[FloatArray]], list[FloatArray]]


@dataclass(frozen=True)
class Box:
    """Domain of the parameters.

    Attributes:
        lower: Lower bounds. Shape (p,).
        upper: Upper bounds. Shape (p,).
        scale: Change of each parameter that matters; differences are taken over a small part of it. Shape (p,).
        centre: Value to which a weak prior pulls each parameter. Shape (p,).
        precision: Inverse covariance of that prior; 0 for none. Shape (p, p).
        reach: Longest step, in units of `scale`. Shape (p,).
    """

    lower: FloatArray
    upper: FloatArray
    scale: FloatArray
    centre: FloatArray
    precision: FloatArray
    reach: FloatArray

    def clip(self, theta: FloatArray) -> FloatArray:
        """The nearest point inside."""
        return np.clip(theta, self.lower, self.upper)

    @property
    def scaled_precision(self) -> FloatArray:
        """The prior's inverse covariance where each parameter is measured in its scale. Shape (p, p)."""
        return self.precision * np.outer(self.scale, self.scale)

    def join(self, other: Box) -> Box:
        """This domain with further parameters behind."""
        joined = {
            name: block_diag(mine, theirs) if mine.ndim == 2 else np.concatenate([mine, theirs])
            for (name, mine), theirs in zip(self.__dict__.items(), other.__dict__.values(), strict=True)
        }
        return Box(**joined)


@dataclass(frozen=True)
class Fit:
    """A minimum.

    Attributes:
        theta: Parameters. Shape (p,).
        residual: Residual there. Shape (m,).
        jacobian: Derivative of the residual, exact or updated. Shape (m, p).
        cost: Sum of squares, priors included.
    """

    theta: FloatArray
    residual: FloatArray
    jacobian: FloatArray
    cost: float


def raise_diagonal(matrix: FloatArray, floor: float) -> FloatArray:
    """`matrix` with its diagonal raised to `floor`. Shape (p, p)."""
    result: FloatArray = matrix + np.diag(np.maximum(floor - np.diag(matrix), 0.0))
    return result


Descent = Generator[list[FloatArray], list[FloatArray], Fit]
"""A minimisation under way: asks for residuals at several points, and returns the minimum."""


def minimise(
    evaluate: Residual,
    theta: FloatArray,
    box: Box,
    *,
    iterations: int = 8,
    refresh: int = 1,
    tolerance: float = JOINT.tolerance,
) -> Fit:
    """Least squares from `theta`, for residuals that are evaluated at several points at once."""
    descent = descend(theta, box, iterations=iterations, refresh=refresh, tolerance=tolerance)
    (fit,) = run_together([descent], split_evaluation(evaluate))
    return fit


def split_evaluation(evaluate: Residual) -> Callable[[list[list[FloatArray]]], list[list[FloatArray]]]:
    """The residuals of several minimisations of one problem, evaluated all at once."""

    def evaluate_all(asked: list[list[FloatArray]]) -> list[list[FloatArray]]:
        values = iter(evaluate([point for points in asked for point in points]))
        return [[next(values) for _ in points] for points in asked]

    return evaluate_all


def run_together(
    descents: Sequence[Descent], evaluate: Callable[[list[list[FloatArray]]], list[list[FloatArray]]]
) -> list[Fit]:
    """Run minimisations side by side, so that their simulations share calls.

    Args:
        descents: The minimisations.
        evaluate: Residuals for the points that each of them asks for; none for those that have finished.
    """
    fits: list[Fit | None] = [None] * len(descents)
    asked = [next(one) for one in descents]
    while any(fit is None for fit in fits):
        answers = evaluate(asked)
        for i, (one, answer) in enumerate(zip(descents, answers, strict=True)):
            if fits[i] is None:
                try:
                    asked[i] = one.send(answer)
                except StopIteration as stop:
                    fits[i], asked[i] = stop.value, []
    return [fit for fit in fits if fit is not None]


def descend(
    theta: FloatArray,
    box: Box,
    *,
    jacobian: FloatArray | None = None,
    iterations: int = 8,
    refresh: int = 1,
    tolerance: float = JOINT.tolerance,
    entry: Entry | None = None,
) -> Descent:
    """Least squares from `theta`.

    Args:
        theta: Start.
        box: Domain and priors.
        jacobian: The first columns of the Jacobian at the start where they are known.
        iterations: Most steps.
        refresh: Compute the Jacobian afresh every so many steps; between them it is updated by Broyden's formula.
        tolerance: Fall of the cost in a step that ends the descent, in units of the mean squared residual.
        entry: The race that it runs in; None where it runs to its end.
    """
    theta = box.clip(theta)
    known = np.zeros((0, 0)) if jacobian is None else jacobian
    steps = choose_steps(theta, box)
    free = [i for i in _list_free(box) if i >= known.shape[1]]
    at, *moved = yield [theta, *_move_points(theta, steps, free)]
    residual, cost = at, _compute_cost(at, theta, box)
    if not np.isfinite(cost):  # a start that does not simulate
        return Fit(theta, residual, np.zeros((at.size, theta.size)), cost)
    J = _build_columns(moved, at, steps, free)
    J[:, : known.shape[1]] = known.reshape(at.size, -1)
    damping, age = JOINT.first_damping, 0
    if (
        entry is not None
        and entry.race.at_once
        and _is_lost(entry.race, _Normal(J, residual, box), theta, cost, damping)
    ):
        iterations = 0
    for _ in range(iterations):
        trials, promised = _propose_steps(_Normal(J, residual, box), theta, cost, damping)
        values = yield from _try_steps(trials, cost, promised, box)
        costs = [_compute_cost(value, trial, box) for value, trial in zip(values, trials, strict=False)]
        best = int(np.argmin(costs))
        gain = cost - costs[best]
        if not gain > 0.0:
            if age == 0 and damping > 10.0:
                break
            damping *= 100.0
            if age:
                J, age = (yield from _compute_jacobian(theta, residual, box)), 0
            continue
        move = trials[best] - theta
        J = J + np.outer(values[best] - residual - J @ move, move / box.scale**2) / max(
            float(np.sum((move / box.scale) ** 2)), 1e-30
        )
        theta, residual, cost, age = trials[best], values[best], costs[best], age + 1
        damping = max(1e-6, damping * JOINT.further_damping[best])
        ended = gain < tolerance * cost / residual.size or (
            entry is not None and entry.hurried and entry.race.is_settled(cost, gain)
        )
        # A short step by an old Jacobian may only mean that it is old.
        if ended and (age == 1 or refresh > iterations):
            break
        look = entry is not None and (age >= refresh or refresh > iterations)
        if entry is not None and look and _is_lost(entry.race, _Normal(J, residual, box), theta, cost, damping):
            break
        if age >= refresh:
            J, age = (yield from _compute_jacobian(theta, residual, box)), 0
    return Fit(theta, residual, J, cost)


def is_beaten(fit: Fit, box: Box, race: Race) -> bool:
    """Whether a fit with derivatives of its end, in the domain `box`, cannot win a race any more."""
    return _is_lost(race, _Normal(fit.jacobian, fit.residual, box), fit.theta, fit.cost, JOINT.first_damping)


def _is_lost(race: Race, normal: _Normal, theta: FloatArray, cost: float, damping: float) -> bool:
    """Whether a descent that is at `theta` cannot win its race any more."""
    return race.is_lost(cost, _propose_steps(normal, theta, cost, damping)[1])


def _propose_steps(normal: _Normal, theta: FloatArray, cost: float, damping: float) -> tuple[list[FloatArray], float]:
    """Points to try: the least damped step, more damped ones, parts of the first; and what a line promises of that."""
    box = normal.box
    trials = [_compute_step(normal, theta, box, damping * factor) for factor in JOINT.dampings]
    trials += [theta + part * (trials[0] - theta) for part in JOINT.step_parts]
    return trials, cost - normal.predict_cost(theta, trials[0])


def _try_steps(
    trials: Sequence[FloatArray], cost: float, promised: float, box: Box
) -> Generator[list[FloatArray], list[FloatArray], list[FloatArray]]:
    """Simulate the least damped step, and the others only where it does not bring what the linear model promised."""
    (first,) = yield [trials[0]]
    if cost - _compute_cost(first, trials[0], box) > JOINT.kept_promise * promised:
        return [first]
    return [first, *(yield list(trials[1:]))]


def _compute_jacobian(
    theta: FloatArray, at: FloatArray, box: Box
) -> Generator[list[FloatArray], list[FloatArray], FloatArray]:
    """Fresh Jacobian at `theta`, where the residual is `at`. Shape (m, p)."""
    steps = choose_steps(theta, box)
    free = _list_free(box)
    moved = yield _move_points(theta, steps, free)
    return _build_columns(moved, at, steps, free)


def _list_free(box: Box) -> list[int]:
    """Parameters that are not held: those whose bounds differ."""
    return [int(i) for i in np.flatnonzero(box.lower < box.upper)]


def choose_steps(theta: FloatArray, box: Box, part: float = JOINT.difference) -> FloatArray:
    """One-sided steps for differences, `part` of each parameter's scale, that stay inside. Shape (p,)."""
    step = part * box.scale
    return np.where(theta + step > box.upper, -step, step)


def _move_points(theta: FloatArray, steps: FloatArray, which: Sequence[int]) -> list[FloatArray]:
    return [theta + steps[i] * np.eye(theta.size)[i] for i in which]


def _build_columns(moved: Sequence[FloatArray], at: FloatArray, steps: FloatArray, which: Sequence[int]) -> FloatArray:
    """Derivatives by the parameters `which`, in columns of their own; 0 by all others. Shape (m, p)."""
    result = np.zeros((at.size, steps.size))
    for i, value in zip(which, moved, strict=True):
        column = (value - at) / steps[i]
        # A point that does not simulate says nothing about its parameter.
        if np.max(np.abs(column)) < JOINT.largest_derivative:
            result[:, i] = column
    return result


def _compute_cost(residual: FloatArray, theta: FloatArray, box: Box) -> float:
    away = theta - box.centre
    value = float(residual @ residual + away @ box.precision @ away)
    return value if np.isfinite(value) else np.inf


def _compute_step(normal: _Normal, theta: FloatArray, box: Box, damping: float) -> FloatArray:
    """Damped step in scaled parameters; those that would leave the box stay at its edge."""
    free = box.lower < box.upper
    target = theta
    for _ in range(3):
        S = box.scale[free]
        A, H = normal.reduce_to(free)
        g = (
            A.T @ (normal.residual + normal.jacobian[:, ~free] @ (target - theta)[~free])
            + S * (box.precision @ (np.where(free, theta, target) - box.centre))[free]
        )
        H = H + damping * np.diag(np.diag(H) + 1e-9 * np.trace(H) / H.shape[0])
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


@dataclass(frozen=True)
class _Normal:
    """The normal equations of a step, which all its dampings share.

    Attributes:
        jacobian: Shape (m, p).
        residual: Shape (m,).
        box: Domain and priors.
        known: Scaled columns and their products by the parameters that are free.
    """

    jacobian: FloatArray
    residual: FloatArray
    box: Box
    known: dict[bytes, tuple[FloatArray, FloatArray]] = field(default_factory=dict)

    def reduce_to(self, free: NDArray[np.bool_]) -> tuple[FloatArray, FloatArray]:
        """Scaled columns of the parameters `free`, shape (m, k), and their products with the prior, shape (k, k)."""
        key = free.tobytes()
        if key not in self.known:
            A = self.jacobian[:, free] * self.box.scale[free]
            self.known[key] = A, A.T @ A + self.box.scaled_precision[np.ix_(free, free)]
        return self.known[key]

    def predict_cost(self, theta: FloatArray, point: FloatArray) -> float:
        """Cost at `point` where the residual is a line from `theta` on."""
        return _compute_cost(self.residual + self.jacobian @ (point - theta), point, self.box)

"""Where to start an effect whose torque is no line in its parameters: many hypotheses, narrowed once by simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import cont2discrete, lfilter

from ..effects import EFFECTS
from ..effects.structure import Candidate, Structure
from ..inputs.track import FloatArray
from ..joint.problem import Problem
from .screening import project_out
from .settings import SEARCH

_Values = tuple[float, ...]
_Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class _Scan:
    """One effect on top of the fitted base.

    Attributes:
        problem: Recordings and weights.
        alone: The effect alone.
        residual: What the base leaves. Shape (m,).
        basis: Orthonormal columns of the base model. Shape (m, p).
    """

    problem: Problem
    alone: Structure
    residual: FloatArray
    basis: FloatArray

    @property
    def linear(self) -> _Mask:
        """Which parameters the torque is proportional to; they stand at their scale, and the size is free."""
        return np.array([p.linear for _, p in self.alone.parameters])

    def select_best(self, points: Sequence[FloatArray]) -> list[FloatArray]:
        """The hypotheses that take most off the sum of squares, refined along each parameter."""
        found = [points[i] for i in np.argsort(-self.compute_falls(points))[: SEARCH.kept_starts]]
        for size in 0.5 ** np.arange(SEARCH.start_rounds):
            found = [self.step(point, float(size)) for point in found]
        return found

    def step(self, point: FloatArray, size: float) -> FloatArray:
        """The best of `point` and its neighbours along each parameter, `size` scales away."""
        box = self.alone.build_box()
        steps = np.diag(np.where(self.linear, 0.0, size * box.scale))
        moves = [np.zeros_like(point)] + [sign * step for step in steps if step.any() for sign in (1.0, -1.0)]
        points: list[FloatArray] = [np.clip(point + move, box.lower, box.upper) for move in moves]
        return points[int(np.argmax(self.compute_falls(points)))]

    def compute_falls(self, points: Sequence[FloatArray]) -> FloatArray:
        """Fall of the sum of squares at each point, the base following linearly. Shape (n_points,)."""
        changes = _build_columns(self.problem, self.alone, points)
        change = project_out(np.where(np.isfinite(changes), changes, 0.0), self.basis)
        along, size = change.T @ self.residual, np.maximum(np.sum(change**2, axis=0), 1e-12)
        amplitude = -along / size
        if not self.linear.any():
            amplitude = np.clip(amplitude, *SEARCH.start_amplitude)
        result: FloatArray = -(2.0 * amplitude * along + amplitude**2 * size)
        return result


def narrow_starts(
    problem: Problem, structure: Structure, residual: FloatArray, basis: FloatArray
) -> dict[str, _Values]:
    """Narrow the starts of each effect that has more of them than can be fitted, by `start:` and its name.

    Args:
        problem: Recordings and weights.
        structure: The base alone, with the motion that effects are computed from.
        residual: What it leaves. Shape (m,).
        basis: Orthonormal columns of the base model. Shape (m, p).
    """
    found: dict[str, _Values] = {}
    for name, effect in sorted(EFFECTS.items()):
        hypotheses = effect.scan(structure.contexts)
        if not hypotheses or effect.find_obstacle(structure.contexts) is not None:
            continue
        scan = _Scan(problem, Structure(structure.contexts, (Candidate(name, ()),)), residual, basis)
        parameters = [p for _, p in scan.alone.parameters]
        points = [np.array([p.scale if p.linear else h.get(p.name, 0.0) for p in parameters]) for h in hypotheses]
        best = [np.where(scan.linear, 0.0, point) for point in scan.select_best(points)]
        found[f"start:{name}"] = tuple(float(value) for point in best for value in point)
    return found


def _build_columns(problem: Problem, alone: Structure, points: Sequence[FloatArray]) -> FloatArray:
    """Build what the effect adds to the weighted rows at each point while the joint slides. Shape (m, n_points).

    There the observer is a second-order low pass; at rest the bristle takes what comes.
    """
    assert problem.weights is not None
    K, D = problem.gains
    passes = [cont2discrete(([D, K], [c.plant.inertia, D, K]), c.dt, "bilinear")[:2] for c in alone.contexts]
    moving = [np.abs(context.velocity) > 2.0 * problem.observer.rest_speed for context in alone.contexts]
    columns = []
    for point in points:
        values, rows = alone.name_values(point)[alone.names[0]], []
        for i, (context, grid) in enumerate(zip(alone.contexts, problem.grids, strict=True)):
            numerator, denominator = passes[i]
            torque = alone.candidates[0].effect.compute_contribution(context, values).additive
            seen = lfilter(numerator[0], denominator, torque * moving[i])
            rows.append(grid.average(seen) + problem.weights.mean[i])
        columns.append(problem.weights.apply(rows))
    return np.stack(columns, axis=1)

"""Where to start: variable projection over a grid of the nonlinear parameters, so that no range is asked of the user.

At a fixed Stribeck velocity the curve is linear in its other parameters, whose best positive values are a small
linear problem [golub1973variable]. A scan of the velocity then sees every basin there is.
"""

import itertools
from typing import NamedTuple

import numpy as np
from scipy.optimize import nnls

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from .form import SeparableLaw, Shapes
from .likelihood import Noise
from .observation import Observations

_GRID = 48
_BASINS = 2
_STARTS = 3
_FASTEST = 2.0
"""Shapes are looked for up to this multiple of the fastest speed measured."""
_SMALLEST = 1e-3
"""A linear parameter that projection puts at zero starts at this fraction of its column's scale."""


class _Candidate(NamedTuple):
    cost: float
    logs: FloatArray


Scan = list[list[_Candidate]]
"""Basins of each branch, best first."""


def starting_points(
    law: SeparableLaw, observations: Observations, noise: Noise, *, robust: bool, scan: Scan | None = None
) -> list[FloatArray]:
    """Logarithms of the parameters in each basin that the projection sees, the most promising first.

    Args:
        law: The law.
        observations: The points.
        noise: Their noise.
        robust: Whether in least absolute values.
        scan: What `scan_basins` finds with all this, where it is known; it is the same for each noise of unknown level.

    Raises:
        IdentificationError: A direction has fewer points than parameters.
    """
    scan = scan or scan_basins(law, observations, noise, robust=robust)
    if noise.kind == "relative":
        best = np.concatenate([candidates[0].logs for candidates in scan])
        magnitude, _ = law.evaluate(with_sensitivity(law, best), observations)
        weight = observations.root_count / np.maximum(magnitude, 1e-3 * observations.torque_scale)
        scan = _scan_branches(law, observations, weight, robust=robust)
    combinations = sorted(itertools.product(*scan), key=lambda c: sum(candidate.cost for candidate in c))
    logs = [np.concatenate([candidate.logs for candidate in c]) for c in combinations[:_STARTS]]
    return [with_sensitivity(law, one) for one in logs]


def scan_basins(law: SeparableLaw, observations: Observations, noise: Noise, *, robust: bool) -> Scan:
    """What the projection sees with weights that do not follow the torque."""
    return _scan_branches(law, observations, _compute_plain_weight(observations, noise), robust=robust)


def _scan_branches(law: SeparableLaw, observations: Observations, weight: FloatArray, *, robust: bool) -> Scan:
    return [
        _scan(law, observations.select(np.flatnonzero(rows)), weight[rows], robust=robust, branch=k)
        for k, rows in enumerate(law.branches(observations))
    ]


def project_start(law: SeparableLaw, observations: Observations, noise: Noise, logs: FloatArray) -> FloatArray:
    """`logs` with its shape brought within the speeds measured and its linear parameters solved for.

    From a shape below the slowest speed the data have no slope to follow: every point then lies on the same side of
    the bend.
    """
    weight, branches = _compute_plain_weight(observations, noise), []
    for k, rows in enumerate(law.branches(observations)):
        points = observations.select(np.flatnonzero(rows))
        shapes = law.shapes_of(np.exp(logs[k * law.branch_size : (k + 1) * law.branch_size]))
        if shapes:
            velocity = float(np.clip(shapes[0], points.speed.min(), _FASTEST * points.speed.max()))
            shapes = (velocity, *shapes[1:])
        branches.append(project(law, points, weight[rows], shapes, robust=False).logs)
    return with_sensitivity(law, np.concatenate(branches))


def _compute_plain_weight(observations: Observations, noise: Noise) -> FloatArray:
    return observations.root_count / (1.0 if noise.deviation is None else noise.deviation)


def with_sensitivity(law: SeparableLaw, logs: FloatArray) -> FloatArray:
    """`logs` of the branches with a load sensitivity of 1 where it is estimated."""
    return np.append(logs, 0.0) if law.sensitivity_name else logs


def _scan(
    law: SeparableLaw, points: Observations, weight: FloatArray, *, robust: bool, branch: int
) -> list[_Candidate]:
    """Basins of one branch, best first."""
    if points.size < law.branch_size:
        direction = ("forward", "reverse")[branch] if law.bidirectional else "any"
        raise IdentificationError(
            f"the law {law.name!r} has {law.branch_size} parameters in {direction} direction and there are "
            f"{points.size} points; measure more speeds, or use a law with fewer parameters"
        )
    if not law.basis.shape_index:
        return [project(law, points, weight, (), robust=robust)]
    grid = np.geomspace(points.speed.min() / 3.0, points.speed.max() * _FASTEST, _GRID).tolist()
    candidates = [
        min((project(law, points, weight, (one, *bend), robust=robust) for bend in law.basis.bends), key=_get_cost)
        for one in grid
    ]
    costs = np.array([candidate.cost for candidate in candidates])
    padded = np.concatenate([[np.inf], costs, [np.inf]])
    valleys = np.flatnonzero((costs <= padded[:-2]) & (costs <= padded[2:]))
    return [candidates[i] for i in valleys[np.argsort(costs[valleys])][:_BASINS]]


def _get_cost(candidate: _Candidate) -> float:
    return candidate.cost


def project(law: SeparableLaw, points: Observations, weight: FloatArray, shapes: Shapes, *, robust: bool) -> _Candidate:
    """Best positive linear parameters at fixed shapes, in least squares or least absolute values."""
    columns = law.basis.columns(points.speed, shapes) * law.load_factor(points.normal_load, 1.0)
    return project_on_columns(law, columns, points.magnitude, weight, shapes, robust=robust)


def project_on_columns(
    law: SeparableLaw, columns: FloatArray, magnitude: FloatArray, weight: FloatArray, shapes: Shapes, *, robust: bool
) -> _Candidate:
    """The same with the columns of the law at these shapes. Shape (n_points, n_linear)."""
    columns, target = columns * weight[:, None], magnitude * weight
    scale = np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
    linear, cost = nnls(columns / scale, target)
    if robust:
        linear, cost = _fit_least_absolute(columns / scale, target, linear)
    floor = _SMALLEST * np.linalg.norm(target) + 1e-12
    values = np.empty(law.branch_size)
    values[law.linear_index] = np.maximum(linear, floor) / scale
    values[list(law.basis.shape_index)] = shapes
    return _Candidate(float(cost), np.log(values))


def _fit_least_absolute(columns: FloatArray, target: FloatArray, linear: FloatArray) -> tuple[FloatArray, float]:
    """Least absolute values by reweighting: an outlier pulls no harder than any other point."""
    error = target - columns @ linear
    for _ in range(12):
        spread = max(float(np.median(np.abs(error))), 1e-12)
        root = 1.0 / np.sqrt(np.maximum(np.abs(error), 0.05 * spread))
        linear, _ = nnls(columns * root[:, None], target * root)
        error = target - columns @ linear
    return linear, float(np.sum(np.abs(error)))

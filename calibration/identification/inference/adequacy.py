"""Whether the points follow the law, and whether they show what it claims: what a likelihood alone does not say."""

from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import nnls
from scipy.stats import f as fisher
from scipy.stats import t as student

from fricomp.laws import FloatArray

from ..estimation.form import SeparableLaw
from ..estimation.observation import Observations
from ..estimation.optimum import Optimum

_WAVES = 5
"""Cosines over the logarithm of speed, a direction, in which a misfit is looked for; fewer with few points."""
_POINTS_A_WAVE = 4
"""Free points for each cosine of a direction: both directions' take at most half of what the law leaves."""
_NEW = 0.03
"""Root mean square of a cosine's part that the law cannot follow, below which it is none."""
_NONE, _SLOWER, _FASTER = 1e-3, 0.25, 4.0
"""Stribeck velocities, over the slowest and the fastest speed measured, that stand for none, zero and infinity. At the
second, the curve above the slowest speed is as good as without a Stribeck effect: exp(-16)."""
_SHOWN = 0.99
"""Confidence at which a Stribeck effect is shown, in each direction. Its velocity means nothing without it, so that a
search over velocities gains more by chance than one parameter would: a chi-square of two fits what was simulated."""
_BOUNDED = 0.95
"""Level of the profile interval of a Stribeck velocity that must not be open."""
_FEWEST = 4
_DRIVEN = 1e-4
"""Chance that a block of points without friction passes for friction that drives the joint."""


class OpenBend(NamedTuple):
    """A branch of the law whose bend the points do not hold from one side.

    Attributes:
        branch: Its number.
        side: Where the bend may lie: far `below` the slowest speed, far `above` the fastest, or nowhere (`none`), since
            the points are explained as well without a Stribeck effect.
    """

    branch: int
    side: Literal["none", "below", "above"]


def compute_misfit_p_value(found: Optimum, points: Observations) -> float:
    """Chance that points of this law leave so much that is smooth over speed, by an F-test [1].

    Cosines over the logarithm of speed, in each direction, as far as small changes of the parameters cannot follow
    them, are compared with what is left beside them [seber2003nonlinear]. It is 1 where there are too few points.
    """
    law = _orthonormalise(_scale(found.whitened.weight[:, None] * found.jacobian), 1e-7)
    residual = found.whitened.weight * (points.magnitude - found.magnitude)
    residual = residual - law @ (law.T @ residual)
    waves = _build_waves(points, int(min(_WAVES, (points.total - law.shape[1]) // _POINTS_A_WAVE)))
    waves = points.root_count[:, None] * waves
    waves = _orthonormalise(waves - law @ (law.T @ waves), _NEW * np.sqrt(points.total))
    freedom = points.total - law.shape[1] - waves.shape[1]
    if not waves.shape[1] or freedom < 1:
        return 1.0
    smooth = float(np.sum((waves.T @ residual) ** 2))
    rest = max(float(residual @ residual) - smooth, 1e-300)
    return float(fisher.sf(smooth / waves.shape[1] / (rest / freedom), waves.shape[1], freedom))


def _build_waves(points: Observations, count: int) -> FloatArray:
    """Cosines of each direction, a constant among them. Shape (n_points, n_waves)."""
    columns = []
    for rows in (points.forward, ~points.forward):
        if count < 1 or not np.any(rows):
            continue
        place = np.log(points.speed) - np.log(points.speed[rows].min())
        place = place / max(float(place[rows].max()), 1e-12)
        columns += [np.where(rows, np.cos(np.pi * k * place), 0.0) for k in range(count + 1)]
    return np.stack(columns, axis=1) if columns else np.empty((points.size, 0))


def _scale(columns: FloatArray) -> FloatArray:
    return np.asarray(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300))


def _orthonormalise(columns: FloatArray, least: float) -> FloatArray:
    """Directions that `columns` span with singular values of `least` or more. Shape (n_points, n_directions)."""
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, values > least])


def find_open_bends(found: Optimum, form: SeparableLaw, points: Observations) -> list[OpenBend]:
    """Branches in which the profile of the velocity at which the curve bends is open towards zero or infinity.

    A standard deviation comes from the curvature at the optimum, which may be sharp where the profile levels off soon
    after. At a fixed velocity the curve is linear, so that the ends cost next to nothing; weights are held.
    """
    if not form.basis.shape_index:
        return []
    variance = found.noise.variance(found.whitened.residual, len(found.logs))
    freedom = max(points.total - len(found.logs), 1)
    lost = 1 + len(form.basis.shape_index)  # what a curve without a bend has less: its rise, and the shapes
    bounded, shown = float(fisher.ppf(_BOUNDED, 1, freedom)), lost * float(fisher.ppf(_SHOWN, lost, freedom))
    bends = []
    for branch, rows in enumerate(form.branches(points)):
        best = float(np.sum(found.whitened.residual[rows] ** 2))
        costs = _compute_bend_costs(found, form, points, rows)
        none, slower, faster = ((cost - best) / max(variance, 1e-300) for cost in costs)
        if none < shown and any(name.endswith("static_torque") for name in form.names):
            bends.append(OpenBend(branch, "none"))
        elif slower < bounded or faster < bounded:
            bends.append(OpenBend(branch, "below" if slower < bounded else "above"))
    return bends


def _compute_bend_costs(
    found: Optimum, form: SeparableLaw, points: Observations, rows: np.ndarray[tuple[int], np.dtype[np.bool_]]
) -> list[float]:
    """Sum of squares of a branch without a bend, with one below the slowest speed, and with one above the fastest."""
    some, weight = points.select(np.flatnonzero(rows)), found.whitened.weight[rows]
    factor = form.load_factor(some.normal_load, float(np.exp(found.logs[-1])) if form.sensitivity_name else 1.0)
    low, high = float(some.speed.min()), float(some.speed.max())
    costs = []
    for velocity in (_NONE * low, _SLOWER * low, _FASTER * high):
        at_it = []
        for bend in form.basis.bends:
            columns = form.basis.columns(some.speed, (velocity, *bend)) * factor * weight[:, None]
            _, norm = nnls(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-12), some.magnitude * weight)
            at_it.append(float(norm) ** 2)
        costs.append(at_it[-1] if velocity == _NONE * low else min(at_it))
    return costs


def find_driven_directions(points: Observations) -> list[str]:
    """Directions in which the mean of a quarter of the points, by speed, clearly has the sign that drives the joint."""
    driven = []
    for name, rows in (("forward", points.forward), ("reverse", ~points.forward)):
        some = points.select(np.flatnonzero(rows))
        some = some.select(np.argsort(some.speed, kind="stable"))
        blocks = np.array_split(np.arange(some.size), min(4, some.size // _FEWEST)) if some.size >= _FEWEST else []
        if any(_is_negative(some.select(block)) for block in blocks):
            driven.append(name)
    return driven


def _is_negative(block: Observations) -> bool:
    mean = float(np.average(block.magnitude, weights=block.count))
    variance = float(np.average((block.magnitude - mean) ** 2, weights=block.count)) / (block.total - 1.0)
    return bool(mean < -np.sqrt(variance) * student.ppf(1.0 - _DRIVEN, block.total - 1.0))

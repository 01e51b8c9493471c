"""Many friction points gathered into few rows that say the same about a law.

Points of nearly one speed and load form a cell. Two rows stand for it, at its mean plus and minus the standard
deviation, each for half of its points: their weighted sums of y, y² and log m(theta) are those of the points. Means and
deviations are taken of what a first fit leaves, so that what the curve changes within a cell does not count as noise.
"""

from collections.abc import Callable

import numpy as np

from fricomp.laws import FloatArray

from .observation import Observations

MOST_POINTS = 4000
"""Number of points up to which each of them is a row of its own. With more a fit only takes longer."""
_SPEEDS = 800
"""Cells over the logarithm of speed, in each direction: over three decades each is 0.9 % wide."""
_SPEEDS_UNDER_LOAD = 120
"""The same where the load varies as well."""
_LOADS = 12
"""Cells over the load, of as many points each."""
_AT_ONCE = 200_000
"""Points at which a curve is computed at once, so that its memory does not grow with the table."""

_Curve = Callable[[Observations], FloatArray]


def gather_points(
    points: Observations, curve: _Curve | None = None, *, most: int = MOST_POINTS, spread: bool = True
) -> Observations:
    """Gather points into rows that stand for them; up to `most` points are returned as they are.

    Args:
        points: The points.
        curve: Friction magnitude of a first fit at points, shape (n_points,); None for none.
        most: Number of points, and about of rows, from which on they are gathered.
        spread: Give each cell two rows that keep its scatter. With one row only the means are kept.
    """
    if points.size <= most:
        return points
    cell, number = _assign_cells(points, most / MOST_POINTS)
    count = np.bincount(cell, weights=points.count, minlength=number).astype(np.float64)
    filled = count > 0.0
    expected = np.zeros(points.size) if curve is None else _compute_in_parts(curve, points)

    def average(values: FloatArray) -> FloatArray:
        weights = values if points.count is None else values * points.count
        result: FloatArray = np.bincount(cell, weights=weights, minlength=number)[filled] / count[filled]
        return result

    left = points.magnitude - expected
    mean = average(left)
    centred = left - _spread_out(mean, filled)[cell]
    deviation = np.sqrt(average(centred**2))
    load = None if points.normal_load is None else average(points.normal_load)
    at = Observations(
        average(points.speed), average(points.forward.astype(np.float64)) > 0.5, mean, load, np.arange(len(mean))
    )
    at = at.with_magnitude(mean if curve is None else curve(at) + mean)
    at = at.counting(count[filled])
    return _split_by_spread(at, deviation) if spread else at


def _assign_cells(points: Observations, fineness: float) -> tuple[np.ndarray[tuple[int], np.dtype[np.intp]], int]:
    """The cell of each point, and how many there are at most."""
    load, loads = points.normal_load, 1
    varies = load is not None and float(np.ptp(load)) > 0.0
    speeds = max(2, round((_SPEEDS_UNDER_LOAD if varies else _SPEEDS) * fineness))
    cell = np.where(points.forward, 0, speeds)
    for side in (points.forward, ~points.forward):
        if np.any(side):
            place = np.log(points.speed[side] / points.speed[side].min())
            cell[side] += np.minimum(place / max(float(place.max()), 1e-12) * speeds, speeds - 1).astype(np.intp)
    if varies and load is not None:
        edges = np.unique(np.quantile(load, np.linspace(0.0, 1.0, _LOADS + 1)))
        loads = len(edges)
        cell = cell * loads + np.searchsorted(edges, load, side="right") - 1
    return cell, 2 * speeds * loads


def _compute_in_parts(curve: _Curve, points: Observations) -> FloatArray:
    """The curve at each point. Shape (n_points,)."""
    parts = np.array_split(np.arange(points.size), -(-points.size // _AT_ONCE))
    return np.concatenate([curve(points.select(part)) for part in parts])


def _spread_out(values: FloatArray, filled: np.ndarray[tuple[int], np.dtype[np.bool_]]) -> FloatArray:
    """Values of the filled cells at the numbers of all cells. Shape (n_cells,)."""
    result = np.zeros(len(filled))
    result[filled] = values
    return result


def _split_by_spread(at: Observations, deviation: FloatArray) -> Observations:
    """Two rows for each cell, at its mean plus and minus its deviation, each for half of its points."""
    twice = at.select(np.tile(np.arange(at.size), 2))
    assert twice.count is not None
    sides = np.repeat([1.0, -1.0], at.size) * np.tile(deviation, 2)
    return twice.with_magnitude(twice.magnitude + sides).counting(0.5 * twice.count)

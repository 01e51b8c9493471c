"""How far parameters stray: by how far fits go from which single stretches of the recording are left out.

    C = (n - 1)/n Σ_b d_b d_bᵀ + A⁻¹ P A⁻¹,  d_b = (A - H_b)⁻¹ g_b,  A = H + P

with g_b the slope of the objective over a stretch, H_b its curvature, H and P that of all and the prior's
[mackinnon2023leverage].
Rows whose noise is one another's, and a model that is wrong in the same way for a stroke, pull alike within a stretch;
a fit with them takes part of their pull up, so that what is left of them shows less than it is. Where fits go no
further than single rows make them, C is A⁻¹.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray

from ..equations import ArmEquations
from ..fit import ArmFit, measure_pulls
from ..rows import ArmRows

_STRETCH = 2.0
"""[s] of a stretch: noise lasts for less, and what friction and links have wrong for about a stroke of the joint."""

_FEWEST = 20
"""Stretches from which scatter is measured."""


def widen_covariance(fit: ArmFit, equations: ArmEquations, rows: ArmRows) -> ArmFit:
    """The fit with deviations as the stretches show them, where those are larger.

    Args:
        fit: Of these equations.
        equations: Of all joints.
        rows: Their times.
    """
    stretch = _number_stretches(rows)
    count = int(stretch.max()) + 1
    if count < _FEWEST:
        return fit
    inverse = np.linalg.inv(fit.covariance)
    moved = np.stack(
        [np.linalg.solve(inverse - curve, pull) for curve, pull in measure_pulls(fit, equations.split(stretch))]
    )
    moved -= moved.mean(axis=0)
    own = fit.covariance / fit.prior_deviation**2.0
    seen = np.einsum("ki,ki->i", moved, moved) * (count - 1) / count + np.einsum("ij,ij->i", own, fit.covariance)
    factor: FloatArray = np.sqrt(np.maximum(1.0, seen / np.diag(fit.covariance)))
    return replace(fit, covariance=fit.covariance * np.outer(factor, factor))


def _number_stretches(rows: ArmRows) -> NDArray[np.intp]:
    """Number of the stretch of each row; none goes over a gap. Shape (n,)."""
    of_time = np.floor((rows.time - rows.time[0]) / _STRETCH).astype(np.intp)
    _, numbers = np.unique(np.stack([rows.part, of_time]), axis=1, return_inverse=True)
    return np.asarray(numbers, dtype=np.intp).ravel()

"""Whether points ask for another exponent of the Stribeck curve than its usual 2."""

import numpy as np
from scipy.stats import chi2
from scipy.stats import f as fisher

from .estimation.form import separable_law
from .estimation.optimum import optimum_at
from .result import IdentificationResult
from .status import Status

FIXED_LAW, FREE_LAW = "stribeck", "free_stribeck"
_CHANCE = 1e-3
"""Chance at which points of an exponent of 2 ask for another one: a free exponent widens every interval of the bend."""
_USUAL = 2.0
_EXPONENTS = 2  # one a direction


def asks_for_exponent(result: IdentificationResult) -> bool:
    """Whether the slope of the likelihood by the exponents, at 2, is more than chance; or the law lacks fit anyway.

    An F-test on what these two columns explain beside those of the law: far cheaper than the fit with them.

    Args:
        result: Of `FIXED_LAW`.
    """
    if result.form.name != FIXED_LAW or result.status is Status.NOT_CONVERGED or result.optimum.is_exact():
        return False
    if result.status is Status.LACK_OF_FIT:
        return True
    at, rows = result.optimum, result.rows
    free = separable_law(FREE_LAW, free_sensitivity=result.form.sensitivity_name is not None)
    values = result.parameters
    start = np.log([values.get(name, _USUAL) for name in free.names])
    added = [i for i, name in enumerate(free.names) if name not in values]
    slopes = optimum_at(start, free, rows, at.noise).whitened.jacobian[:, added]
    known = np.linalg.qr(at.whitened.jacobian / np.maximum(np.linalg.norm(at.whitened.jacobian, axis=0), 1e-300))[0]
    residual = at.whitened.residual - known @ (known.T @ at.whitened.residual)
    slopes = np.linalg.qr(slopes - known @ (known.T @ slopes))[0]
    explained = float(np.sum((slopes.T @ residual) ** 2))
    freedom = rows.total - len(free.names)
    if freedom < 1:
        return False
    rest = max(float(residual @ residual) - explained, 1e-300)
    return bool(fisher.sf(explained / _EXPONENTS / (rest / freedom), _EXPONENTS, freedom) < _CHANCE)


def is_shown(fixed: IdentificationResult, free: IdentificationResult) -> bool:
    """Whether the exponents are determined, explain the points, and are likelier than 2 by more than chance.

    Where a fit with them still lacks fit, something else is there, and their intervals would not hold either.
    """
    gain = 2.0 * (fixed.negative_log_likelihood - free.negative_log_likelihood)
    return free.status is Status.CONVERGED and bool(gain > chi2.isf(_CHANCE, _EXPONENTS))

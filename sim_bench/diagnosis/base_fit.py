"""The weighted fit of the base, and another try where its bristle ran away from what friction looks like."""

from __future__ import annotations

import numpy as np

from .base import BASE_NAMES
from .problem import Problem
from .solver import Box, Fit, minimise
from .track import FloatArray

__all__ = ["fit_base", "with_other_bristle"]

_BREAKAWAY, _DAMPING = BASE_NAMES.index("log_breakaway"), BASE_NAMES.index("damping_time")
_FORWARD, _REVERSE = (BASE_NAMES.index(f"{side}.coulomb_torque") for side in ("forward", "reverse"))
_OFFSET = BASE_NAMES.index("offset")
_STARTS = (1e-6, 3e-5)  # [rad] presliding distances to start from
_LOUD = 1.1  # residual over noise
_NEAR = 0.9  # of the largest damping of a bristle
# Steps of a weighted fit, and fall of the cost in units of the noise that ends it: Coulomb, static and viscous torque
# of a slow motion lie along a narrow valley, and a fit that stops on its way down leaves the rest to any effect.
_STEPS, _SETTLED = 48, 0.3


def fit_base(problem: Problem, theta: FloatArray, box: Box) -> Fit:
    """The base fitted from `theta` with the problem's weights, to the bottom of its valley."""
    evaluate = problem.residual(problem.nothing, len(BASE_NAMES))
    return minimise(evaluate, theta, box, iterations=_STEPS, refresh=2, tolerance=_SETTLED)


def with_other_bristle(problem: Problem, fit: Fit, box: Box) -> Fit:
    """The fit, or a better one from stiff bristles with hardly any damping beside the same friction.

    A joint that turns over at once in a reversal looks, to a bristle that is too soft, as if it had damping instead of
    static friction: the way from there to the stiff bristle leads uphill. Such a fit is loud, and damped as much as
    the base allows.

    Args:
        problem: Recordings and weights.
        fit: Of the base, with these weights.
        box: Domain of the base parameters.
    """
    loud = fit.residual @ fit.residual > _LOUD**2 * fit.residual.size
    if not loud or fit.theta[_DAMPING] < _NEAR * box.upper[_DAMPING]:
        return fit
    tried = [fit_base(problem, _with_bristle(fit.theta, box, distance), box) for distance in _STARTS]
    return min([fit, *tried], key=lambda one: one.cost)


def _with_bristle(theta: FloatArray, box: Box, distance: float) -> FloatArray:
    """`theta` with a bristle of this presliding distance [rad], half of whose elements yield abruptly. Shape (p,).

    The difference of the directions goes into the offset: sliding shows their sum alone, and the wrong bristle has
    parted them by a start of motion that it had wrong.
    """
    start = theta.copy()
    difference = theta[_FORWARD] - theta[_REVERSE]
    start[[_FORWARD, _REVERSE, _OFFSET]] += [-0.5 * difference, 0.5 * difference, 0.5 * difference]
    usual = {"delay": 0.0, "damping_time": 0.01 * box.upper[_DAMPING], "sharpness": 0.5, "log_spread": 0.3}
    for name, value in {"log_breakaway": float(np.log(distance)), **usual}.items():
        start[BASE_NAMES.index(name)] = value
    return start

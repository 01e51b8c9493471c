"""The weighted fit of the base, and another try where its bristle ran away from what friction looks like."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from .base import BASE_NAMES, unpack
from .problem import Problem
from .solver import Box, Fit, minimise
from .track import FloatArray

__all__ = ["fit_base", "with_creep", "with_other_bristle"]

_BREAKAWAY, _DAMPING = BASE_NAMES.index("log_breakaway"), BASE_NAMES.index("damping_time")
_FORWARD, _REVERSE = (BASE_NAMES.index(f"{side}.coulomb_torque") for side in ("forward", "reverse"))
_OFFSET = BASE_NAMES.index("offset")
_STARTS = (1e-6, 3e-5)  # [rad] presliding distances to start from
_LOUD = 1.1  # residual over noise
_CREEP, _LEAD = BASE_NAMES.index("creep_velocity"), BASE_NAMES.index("creep_lead")
_SHARPNESS = BASE_NAMES.index("sharpness")
_SLOWEST, _FASTEST = 1e-3, 0.1  # creep velocity, of the fastest motion
_LONGEST_LEAD = 0.03  # [s]
# MuJoCo's friction loss with its usual impedance: F = d (tau + b J v), cut off at the level, with d = 0.9 and a rate b
# of 105 1/s or, in a stiffer simulation, ten times that.
_IMPEDANCE, _RATES = 0.9, (105.0, 1050.0)
_EXCESS = 0.95  # of the energy above the noise that creep must explain
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


def with_creep(problem: Problem, fit: Fit, box: Box, top_speed: float) -> tuple[Fit, Box]:
    """The fit and its domain, or those of friction that never holds, where it leaves about nothing.

    Friction of many simulators is no bristle: below a creep velocity it is viscous, and at rest it fades. Whatever is
    missing may look a little like that, so creep must explain all of a loud residual, not the better part.

    Args:
        problem: Recordings and weights.
        fit: Of the base, with these weights.
        box: Domain of the base parameters.
        top_speed: Of the recorded motion [rad/s].
    """
    energy = float(fit.residual @ fit.residual)
    if energy <= _LOUD**2 * fit.residual.size:
        return fit, box
    starts = [_creeping(fit.theta, rate) for rate in _RATES]
    tried = [(fit_base(problem, start, free), free) for start, free in ((s, _with_free_creep(box, s, top_speed)) for s in starts)]
    best, free = min(tried, key=lambda one: one[0].cost)
    left = float(best.residual @ best.residual)
    print("CREEP", (energy / best.residual.size) ** 0.5, [((t[0].residual @ t[0].residual) / best.residual.size) ** 0.5 for t in tried], unpack(best.theta))
    above = energy - fit.residual.size
    if left <= _LOUD**2 * fit.residual.size or energy - left > _EXCESS * above:
        return best, free
    return fit, box


def _creeping(theta: FloatArray, rate: float) -> FloatArray:
    """`theta` with the friction loss of MuJoCo at this rate [1/s]. Shape (p,)."""
    start, plant = theta.copy(), unpack(theta)
    start[_SHARPNESS] = 1.0
    start[_CREEP] = plant.level * (1.0 - _IMPEDANCE) / (_IMPEDANCE * rate * plant.inertia)
    start[_LEAD] = 1.0 / rate
    return start


def _with_free_creep(box: Box, start: FloatArray, top_speed: float) -> Box:
    lower, upper, scale = box.lower.copy(), box.upper.copy(), box.scale.copy()
    lower[[_CREEP, _LEAD]], upper[[_CREEP, _LEAD]] = (_SLOWEST * top_speed, 0.0), (_FASTEST * top_speed, _LONGEST_LEAD)
    scale[[_CREEP, _LEAD]] = 0.1 * float(np.clip(start[_CREEP], lower[_CREEP], upper[_CREEP])), 0.1 * start[_LEAD]
    return replace(box, lower=lower, upper=upper, scale=scale)

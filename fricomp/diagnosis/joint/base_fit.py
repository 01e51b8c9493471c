"""The weighted fit of the base, and other tries where it is loud: with another bristle, with friction that creeps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..inputs.track import FloatArray
from .base import BASE_NAMES, align_falls, even_directions, straighten_curves, unpack
from .problem import Problem
from .race import Entry, Race
from .settings import JOINT
from .solver import Box, Fit, descend, run_together, split_evaluation

_BREAKAWAY, _DAMPING = BASE_NAMES.index("log_breakaway"), BASE_NAMES.index("damping_time")
_CREEP, _LEAD = BASE_NAMES.index("creep_velocity"), BASE_NAMES.index("creep_lead")
_SHARPNESS = BASE_NAMES.index("sharpness")


def fit_base(problem: Problem, theta: FloatArray, box: Box) -> Fit:
    """Fit the base from `theta` to the bottom of its valley. Where both directions differ much, or friction falls over
    all of the motion, fit again from even directions, falls that are alike and straight curves, and keep the best."""
    fit, *_ = _fit_side_by_side(problem, [theta], box)
    other = even_directions(fit.theta), align_falls(fit.theta), straighten_curves(fit.theta, problem.usual_speed)
    others = [box.clip(start) for start in other if start is not None]
    return min([fit, *_fit_side_by_side(problem, others, box)], key=_get_cost)


def get_top_speed(box: Box) -> float:
    """Of the recordings [rad/s] or [m/s]: no friction of the base falls over a wider range."""
    return float(np.exp(box.upper[BASE_NAMES.index("forward.log_stribeck_velocity")]))


def _fit_side_by_side(problem: Problem, starts: Sequence[FloatArray], box: Box) -> list[Fit]:
    """Fit the base from each start to the bottom of its valley."""
    evaluate = problem.build_residual(problem.add_nothing)
    descents = [
        descend(theta, box, iterations=JOINT.base_steps, refresh=2, tolerance=JOINT.base_tolerance) for theta in starts
    ]
    return run_together(descents, split_evaluation(evaluate))


def is_loud(fit: Fit) -> bool:
    """Whether a weighted fit leaves more than noise."""
    return float(fit.residual @ fit.residual) > JOINT.loud**2 * fit.residual.size


def try_other_bristle(problem: Problem, fit: Fit, box: Box) -> Fit:
    """Return the fit, or a better one from a stiff bristle with hardly any damping.

    A joint that turns over at once in a reversal looks, to a bristle that is too soft, as if it had damping instead of
    static friction: the way from there to the stiff bristle leads uphill. Such a fit is loud, and damped as much as
    the base allows.

    Args:
        problem: Recordings and weights.
        fit: Fit of the base with these weights.
        box: Domain of the base parameters.
    """
    if not is_loud(fit) or fit.theta[_DAMPING] < JOINT.damped_share * box.upper[_DAMPING]:
        return fit
    tried = [fit_base(problem, _set_bristle(fit.theta, box, distance), box) for distance in JOINT.stiff_bristles]
    return min([fit, *tried], key=_get_cost)


def _get_cost(fit: Fit) -> float:
    return fit.cost


def _set_bristle(theta: FloatArray, box: Box, distance: float) -> FloatArray:
    """`theta` with a bristle of this presliding distance [rad], half of whose elements yield abruptly. Shape (p,).

    Both directions are evened: the wrong bristle has parted them by a start of motion that it had wrong.
    """
    even = even_directions(theta)
    start = theta.copy() if even is None else even
    usual = {"delay": 0.0, "damping_time": 0.01 * box.upper[_DAMPING], "sharpness": 0.5, "log_spread": 0.3}
    for name, value in {"log_breakaway": float(np.log(distance)), **usual}.items():
        start[BASE_NAMES.index(name)] = value
    return start


def fit_creep(problem: Problem, fit: Fit, box: Box) -> tuple[Fit, Box] | None:
    """Fit the base with friction that never holds; None where that leads nowhere. Returns its domain too.

    Friction of many simulators is no bristle: below a creep velocity it is viscous, and at rest it fades.

    Args:
        problem: Recordings and weights.
        fit: Fit of the base with these weights.
        box: Domain of the base parameters.
    """
    straight = straighten_curves(fit.theta, problem.usual_speed)
    about = [fit.theta] if straight is None else [fit.theta, box.clip(straight)]
    proposed = [start for theta in about for start in propose_creep_starts(theta, box)]
    starts, boxes = zip(*proposed, strict=True)
    problem = problem.cut_samples_for(unpack(starts[0]))  # no bristle asks for short steps
    evaluate = problem.build_residual(problem.add_nothing)
    entry = Entry(Race(JOINT.hopeless_cost * fit.cost, JOINT.hopeless_cost * fit.cost))
    descents = [
        descend(start, free, iterations=JOINT.creep_steps, refresh=2, entry=entry)
        for start, free in zip(starts, boxes, strict=True)
    ]
    fits = run_together(descents, split_evaluation(evaluate))
    best, free = min(zip(fits, boxes, strict=True), key=lambda one: one[0].cost)
    faded = unpack(best.theta).level < JOINT.faded_level * unpack(fit.theta).level
    if faded or best.cost >= JOINT.hopeless_cost * fit.cost:
        return None
    return fit_base(problem, best.theta, free), free


def fit_known(problem: Problem, theta: FloatArray, box: Box) -> tuple[Fit, Box]:
    """Fit the base from a joint that is known, whose friction may creep. Returns its domain too.

    Args:
        problem: Recordings and weights.
        theta: Base parameters of that joint. Shape (p,).
        box: Domain of the base parameters.
    """
    free = _free_creep(box, theta) if theta[_CREEP] > 0.0 else box
    return fit_base(problem.cut_samples_for(unpack(theta)), theta, free), free


def propose_creep_starts(theta: FloatArray, box: Box) -> list[tuple[FloatArray, Box]]:
    """Propose base parameters with friction that creeps in place of a bristle, each with its domain.

    Args:
        theta: Base parameters. Shape (p,).
        box: Domain of the base parameters.
    """
    starts = [_set_creep(theta, rate) for rate in JOINT.creep_rates]
    return [(start, _free_creep(box, start)) for start in starts]


def _set_creep(theta: FloatArray, rate: float) -> FloatArray:
    """`theta` with the friction loss of MuJoCo at this rate [1/s]. Shape (p,)."""
    start, plant = theta.copy(), unpack(theta)
    start[_SHARPNESS] = 1.0
    start[_CREEP] = plant.level * (1.0 - JOINT.impedance) / (JOINT.impedance * rate * plant.inertia)
    start[_LEAD] = 1.0 / rate
    return start


def _free_creep(box: Box, start: FloatArray) -> Box:
    """`box` in which friction creeps, with scales for a fit from `start`."""
    lower, upper, scale = box.lower.copy(), box.upper.copy(), box.scale.copy()
    at, top_speed = [_CREEP, _LEAD], get_top_speed(box)
    lower[at], upper[at] = (JOINT.slowest_creep * top_speed, 0.0), (JOINT.fastest_creep * top_speed, JOINT.longest_lead)
    creep, lead = max(float(start[_CREEP]), lower[_CREEP]), max(float(start[_LEAD]), 1.0 / max(JOINT.creep_rates))
    scale[at] = 0.1 * creep, 0.1 * lead
    return replace(box, lower=lower, upper=upper, scale=scale)

"""Intervals over models that the recording does not tell apart.

Of friction over the curves that a joint may have, and over those beside a drag, which looks like a wide curve.
Coulomb and viscous friction are what a curve goes over into, and each curve has its own. An interval beside one of them
says how well it is known if that is the curve; here all count by how probable they make the recording [hoeting1999],
and none is narrower than beside the curve that was taken. No curve is one with an excess of zero, and nobody knows that
a joint has exactly that: beside no curve at all, an excess too small to be taken in moves Coulomb and viscous friction
by several of their deviations.

Of links over what was not taken in and is not improbable: another link that is far off, beside those that are or in
place of one, or a spring, moves what they weigh.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq
from scipy.stats import norm

from fricomp.laws import FloatArray

from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit
from ..friction import PLAIN, TERMS
from ..glance import Glance
from ..prior import ArmPrior
from ..rigid.inertia import N_INERTIA
from ..search.stribeck import hold_curve
from .alternatives import Alternatives

__all__ = ["average_friction", "average_links"]

_TAIL = 0.025
"""Probability outside of an interval, on each side."""

_POSITIVE = ("coulomb", "viscous")
"""Of `PLAIN`, what no joint has less than none of."""

_DRAG = "quadratic_drag"
"""What bends friction over the speed as no curve does, and alone is told from viscous friction at any strength: a power
law of an exponent near one is the same."""

_EXCESSES = 40
"""Steps in which an excess is averaged over; twice as many move no end by a thousandth of its interval."""

_LEAST_ABOVE = 1e-300
"""Least probability of an excess above zero that is computed with."""

_SHOWN = 4
"""Numbers of a link whose intervals are told: its mass and its first moments."""

Interval = tuple[float, float]


def average_friction(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> tuple[dict[str, Interval], ...]:
    """95 % intervals of what `PLAIN` lists, joint by joint.

    Args:
        equations: Of all joints.
        fit: What was confirmed, with deviations as its stretches show them.
        prior: How far the simulation is trusted.
    """
    glance = Glance(equations, fit, prior)
    promised = np.diag(glance.solve(fit.model).covariance)
    wider = np.sqrt(np.maximum(1.0, np.diag(fit.covariance) / promised))
    return tuple(_average_joint(glance, fit, wider, j) for j in range(len(fit.model.forms)))


def average_links(fit: ArmFit, found: Alternatives) -> FloatArray:
    """95 % intervals of mass [kg] and first moments [kg·m] of each link. Shape (n_links, 4, 2).

    Args:
        fit: What was confirmed, with deviations as its stretches show them.
        found: The same as its rows promise, and what else may be.
    """
    first, spread = _measure_links(fit)
    wider, half = np.maximum(1.0, spread / _measure_links(found.own)[1]), float(norm.ppf(1.0 - _TAIL))
    ends = np.stack([first - half * spread, first + half * spread], axis=-1)
    for (_, *others), weights in found.groups:
        each = [(first, spread), *((mean, wider * wide) for mean, wide in map(_measure_links, others))]
        mean, wide = (np.stack(parts) for parts in zip(*each, strict=True))
        for at in np.ndindex(first.shape):
            low, high = _find_interval(mean[:, *at], wide[:, *at], weights)
            ends[at] = min(low, ends[*at, 0]), max(high, ends[*at, 1])
    return ends


def _measure_links(fit: ArmFit) -> tuple[FloatArray, FloatArray]:
    """Mass and first moments of each link, and their standard deviations. Shapes (n_links, 4)."""
    spread = []
    for i, link in enumerate(fit.arm.link_coordinates):
        at = slice(N_INERTIA * i, N_INERTIA * (i + 1))
        slope = link.jacobian(fit.x[at])
        spread.append(np.sqrt(np.diag(slope @ fit.covariance[at, at] @ slope.T))[:_SHOWN])
    return fit.inertia[:, :_SHOWN], np.stack(spread)


def _average_joint(glance: Glance, fit: ArmFit, wider: FloatArray, joint: int) -> dict[str, Interval]:
    first = fit.find_friction(joint)[0].start
    owns = range(first, first + len(PLAIN))
    curves = _mix_curves(glance, fit.model, joint, float(np.max(wider[owns])))
    half = float(norm.ppf(1.0 - _TAIL)) * np.sqrt(np.diag(fit.covariance))
    result = {}
    for k, (name, own) in enumerate(zip(PLAIN, owns, strict=True)):
        low, high = _find_interval(curves.mean[:, k], curves.spread[:, k], curves.weights)
        ends = min(low, float(fit.x[own] - half[own])), max(high, float(fit.x[own] + half[own]))
        if (joint, name) in fit.model.pinned:
            ends = min(ends[0], 0.0), max(ends[1], 0.5 * (high - low))
        result[name] = (max(ends[0], 0.0), max(ends[1], 0.0)) if name in _POSITIVE else ends
    return result


class _Mixture(NamedTuple):
    """What `PLAIN` lists beside each curve: normal distributions, and how probable each is.

    Attributes:
        weights: Shape (n,).
        mean: Shape (n, 4).
        spread: Standard deviations. Shape (n, 4).
    """

    weights: FloatArray
    mean: FloatArray
    spread: FloatArray


def _mix_curves(glance: Glance, model: ArmModel, joint: int, wider: float) -> _Mixture:
    """All Stribeck curves of one joint: of every velocity, and of every excess that is not below zero.

    The posterior of an excess is a normal distribution that is cut off at zero; steps of even probability stand for it.
    """
    steps = (np.arange(_EXCESSES) + 0.5) / _EXCESSES
    evidence, mean, spread = [], [], []
    for one in _solve_curves(glance, model, joint):
        first, at = one.find_friction(joint)[0].start, _find_parameter(one, joint, "stribeck")
        plain = slice(first, first + len(PLAIN))
        excess = wider * float(np.sqrt(one.covariance[at, at]))
        above = _measure_above(one, at, wider)
        dragged = _measure_above(one, _find_parameter(one, joint, _DRAG), wider) if _has(one, joint, _DRAG) else 1.0
        along = wider**2 * one.covariance[plain, at] / excess
        rest = np.sqrt(np.maximum(wider**2 * np.diag(one.covariance)[plain] - along**2, 0.0))
        evidence.append(np.full(_EXCESSES, one.log_evidence + np.log(above) + np.log(dragged)))
        mean.append(one.x[plain] + np.outer(norm.isf(above * steps), along))
        spread.append(np.tile(rest, (_EXCESSES, 1)))
    logarithms = np.concatenate(evidence)
    weights = np.exp(logarithms - logarithms.max())
    return _Mixture(weights / weights.sum(), np.concatenate(mean), np.concatenate(spread))


def _solve_curves(glance: Glance, model: ArmModel, joint: int) -> Iterator[ArmFit]:
    """Fits with each Stribeck curve in one joint, with a drag and without; the curves stand still."""
    forms, pinned = list(model.forms), frozenset(one for one in model.pinned if one[0] != joint)
    plain = forms[joint].without_term("stribeck")
    bent = [] if any(TERMS[name].family == "speed" for name in plain.names) else [plain.with_term(_DRAG, 0)]
    for form in (plain, *bent):
        for k in range(len(TERMS["stribeck"].values)):
            forms[joint] = form.with_term("stribeck", k)
            yield glance.solve(hold_curve(replace(model, forms=tuple(forms), pinned=pinned), joint))


def _has(fit: ArmFit, joint: int, term: str) -> bool:
    return term in fit.model.forms[joint].names


def _find_parameter(fit: ArmFit, joint: int, term: str) -> int:
    """Place of the first parameter of a joint's term in x."""
    place, names = fit.find_friction(joint)
    first = TERMS[term].names(dict(fit.model.forms[joint].terms)[term])[0]
    return int(place.start) + names.index(first)


def _measure_above(fit: ArmFit, at: int, wider: float) -> float:
    """Probability that a parameter is not below zero."""
    return max(float(norm.cdf(fit.x[at] / (wider * np.sqrt(fit.covariance[at, at])))), _LEAST_ABOVE)


def _find_interval(mean: FloatArray, spread: FloatArray, weights: FloatArray) -> Interval:
    """Ends that a mixture of normal distributions falls short of, and goes beyond, as seldom."""
    low, high = float(np.min(mean - 4.0 * spread)), float(np.max(mean + 4.0 * spread))

    def find(part: float) -> float:
        return float(brentq(lambda x: float(weights @ norm.cdf((x - mean) / spread)) - part, low, high))

    return find(_TAIL), find(1.0 - _TAIL)

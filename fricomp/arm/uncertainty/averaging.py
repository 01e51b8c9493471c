"""Intervals over models that the recording does not tell apart.

Of friction over the curves that a joint may have: which Stribeck velocity, if any, is known only so well.

Coulomb and viscous friction are what a curve goes over into, and each curve has its own. An interval beside one of them
says how well it is known if that is the curve; here all curves count by how probable they make the recording
[hoeting1999], and none is narrower than beside the curve that was taken. Of links over what was not taken in and is not
improbable: another link that is far off, or a spring, moves what they weigh.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

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
from .alternatives import Alternatives

__all__ = ["average_friction", "average_links"]

_TAIL = 0.025
"""Probability outside of an interval, on each side."""

_POSITIVE = ("coulomb", "viscous")
"""Of `PLAIN`, what no joint has less than none of."""

_NEGATIVE = -2.0
"""Standard deviations below zero from which an excess is no Stribeck effect."""

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
    own, others = found.own, list(found.others.values())
    evidence = np.array([0.0, *(one.log_evidence - own.log_evidence for one in others)])
    weights = np.exp(evidence - evidence.max())
    first, spread = _measure_links(fit)
    wider = np.maximum(1.0, spread / _measure_links(own)[1])
    each = [(first, spread), *((mean, wider * wide) for mean, wide in map(_measure_links, others))]
    mean, wide = (np.stack(parts) for parts in zip(*each, strict=True))
    ends = np.empty((*first.shape, 2))
    half = float(norm.ppf(1.0 - _TAIL))
    for at in np.ndindex(first.shape):
        low, high = _find_interval(mean[:, *at], wide[:, *at], weights / weights.sum())
        ends[at] = min(low, first[at] - half * spread[at]), max(high, first[at] + half * spread[at])
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
    solved = [glance.solve(model) for model in _propose(fit.model, joint)]
    solved = [one for one in solved if _has_excess(one, joint)]
    evidence = np.array([one.log_evidence for one in solved])
    weights = np.exp(evidence - evidence.max())
    result = {}
    for name in PLAIN:
        at = [one.find_friction(joint)[0].start + PLAIN.index(name) for one in solved]
        mean = np.array([one.x[k] for one, k in zip(solved, at, strict=True)])
        spread = np.sqrt([one.covariance[k, k] for one, k in zip(solved, at, strict=True)])
        own = fit.find_friction(joint)[0].start + PLAIN.index(name)
        low, high = _find_interval(mean, spread * wider[own], weights / weights.sum())
        half = float(norm.ppf(1.0 - _TAIL) * np.sqrt(fit.covariance[own, own]))
        ends = min(low, float(fit.x[own]) - half), max(high, float(fit.x[own]) + half)
        if (joint, name) in fit.model.pinned:
            ends = min(ends[0], 0.0), max(ends[1], 0.5 * (high - low))
        result[name] = (max(ends[0], 0.0), max(ends[1], 0.0)) if name in _POSITIVE else ends
    return result


def _propose(model: ArmModel, joint: int) -> Iterator[ArmModel]:
    """The model with every Stribeck curve in one joint, and with none."""
    forms = list(model.forms)
    plain = forms[joint].without_term("stribeck")
    free = frozenset(one for one in model.pinned if one[0] != joint)
    for form in (plain, *(plain.with_term("stribeck", k) for k in range(len(TERMS["stribeck"].values)))):
        forms[joint] = form
        yield replace(model, forms=tuple(forms), pinned=free)


def _has_excess(fit: ArmFit, joint: int) -> bool:
    variant = dict(fit.model.forms[joint].terms).get("stribeck")
    if variant is None:
        return True
    place, names = fit.find_friction(joint)
    at = place.start + names.index(TERMS["stribeck"].names(variant)[0])
    return float(fit.x[at]) > _NEGATIVE * float(np.sqrt(fit.covariance[at, at]))


def _find_interval(mean: FloatArray, spread: FloatArray, weights: FloatArray) -> Interval:
    """Ends that a mixture of normal distributions falls short of, and goes beyond, as seldom."""
    low, high = float(np.min(mean - 4.0 * spread)), float(np.max(mean + 4.0 * spread))

    def find(part: float) -> float:
        return float(brentq(lambda x: float(weights @ norm.cdf((x - mean) / spread)) - part, low, high))

    return find(_TAIL), find(1.0 - _TAIL)

"""One link that is heavier or lighter than simulated all over, the rest of the simulation being right.

Torques tell some sums of what neighbouring links weigh, and no link by itself: a heavier one looks like mass elsewhere
in several. But where the other links are as simulated, one factor explains all of it. How far the other links are
trusted is then told by the recording too: of some prior deviations the one that makes it most probable is taken, with a
factor on one link and without, and the two are weighed against each other.

    d log p / ds = dᵀ P (x - m),   -d² log p / ds² = dᵀ (P - P C P) d

s is the logarithm of the factor, d its direction in the coordinates of the link, P the precision of the prior, C the
covariance of the fit and m the prior's mean, which the factor moves.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.diagnosis.record.result import Quantity

from ..fit import Z95, ArmFit, fit_arm
from ..identification import EVIDENCE, ArmIdentification
from ..record import LoneLink
from ..rigid.inertia import N_INERTIA

_TRUST = (1.0, 0.3, 0.1, 0.03, 0.01)
"""Prior deviations of the links, in that of the answer: down to a simulation that is right to some thousandths."""

_ROUNDS = 3
"""In which a factor is found: links are not linear in it."""

_TRIED = 3
"""Links whose factor is found to the last, the most probable first."""

_FARTHEST = 3.0
"""Prior deviations of the logarithm of a factor beyond which none is looked for: those of a link that is far off."""

_ALIKE = 3.0
"""Logarithm of a Bayes factor below which another link does as well: odds of twenty to one."""

_DIAGONAL = slice(0, 4)
"""Coordinates of a link that grow by half of the logarithm of a factor on all of its inertia."""


class _Scaled(NamedTuple):
    """A factor on one link.

    Attributes:
        link: Its number.
        value: Logarithm of the factor.
        deviation: Standard deviation of that.
        log_evidence: Of the model with it.
    """

    link: int
    value: float
    deviation: float
    log_evidence: float


def find_lone_link(found: ArmIdentification) -> LoneLink | None:
    """The link that alone is off, by one factor on its mass, where that is more probable than anything else.

    Args:
        found: The confirmed fit.
    """
    fit = found.fit
    own = fit_arm(fit.arm, found.equations, fit.model, found.prior, fit, steps=1)
    plain, best = own.log_evidence, dict[int, _Scaled]()
    model = replace(fit.model, opened=frozenset())
    for part in _TRUST:
        prior = replace(found.prior, links=part * found.prior.links)
        start = fit_arm(fit.arm, found.equations, model, prior, fit)
        plain = max(plain, start.log_evidence)
        for one in _scale_links(replace(found, prior=prior), start):
            before = best.get(one.link, one)
            best[one.link] = max(one, before, key=lambda each: each.log_evidence)
    first = max(best.values(), key=lambda one: one.log_evidence, default=None)
    if first is None or first.log_evidence < plain + EVIDENCE + np.log(len(fit.arm.links)):
        return None
    alike = (one for one in best.values() if first.log_evidence - _ALIKE < one.log_evidence < first.log_evidence)
    ends = first.value + Z95 * first.deviation * np.array([-1.0, 1.0])
    low, high = np.exp(ends).tolist()
    return LoneLink(
        name=fit.arm.links[first.link],
        factor=Quantity(float(np.exp(first.value)), "1", (low, high)),
        alike=tuple(fit.arm.links[one.link] for one in alike),
    )


def _scale_links(found: ArmIdentification, start: ArmFit) -> Iterator[_Scaled]:
    """The most promising factors on single links, beside links that are trusted as the prior has it."""
    looks = sorted(
        (_look(found, start, i, 0.0) for i in range(len(start.arm.links))), key=lambda one: -one.log_evidence
    )
    for look in looks[:_TRIED]:
        one, fit = look, start
        for _ in range(_ROUNDS):
            if abs(one.value) > _FARTHEST * found.prior.opened:
                break
            fit = _fit_scaled(found, fit, one)
            one = _look(found, fit, look.link, one.value)
        else:
            yield one


def _look(found: ArmIdentification, fit: ArmFit, link: int, value: float) -> _Scaled:
    """A factor by slope and curvature at a fit about an arm whose link has another one already."""
    precision, at = fit.prior_deviation**-2.0, N_INERTIA * link
    direction = np.zeros(fit.x.size)
    direction[at : at + N_INERTIA][_DIAGONAL] = 0.5
    pull = precision * direction
    slope = float(pull[at : at + N_INERTIA] @ fit.x[at : at + N_INERTIA])
    curvature = max(float(pull @ direction - pull @ fit.covariance @ pull), 1e-300)
    known = curvature + found.prior.opened**-2.0
    moved = (slope - value * found.prior.opened**-2.0) / known
    volume = 1.0 + curvature * found.prior.opened**2
    prior = 0.5 * (value / found.prior.opened) ** 2
    evidence = fit.log_evidence + 0.5 * known * moved**2 - prior - 0.5 * float(np.log(volume))
    return _Scaled(link, value + moved, known**-0.5, evidence)


def _fit_scaled(found: ArmIdentification, start: ArmFit, one: _Scaled) -> ArmFit:
    """The fit about an arm in which a link has a factor."""
    simulated = found.fit.arm
    inertia = simulated.inertia.copy()
    inertia[one.link] *= np.exp(one.value)
    arm = replace(simulated, inertia=inertia)
    before = float(np.log(start.arm.inertia[one.link, 0] / simulated.inertia[one.link, 0]))
    x = start.x.copy()
    x[N_INERTIA * one.link :][_DIAGONAL] -= 0.5 * (one.value - before)
    return fit_arm(arm, found.equations, start.model, found.prior, replace(start, arm=arm, x=x))

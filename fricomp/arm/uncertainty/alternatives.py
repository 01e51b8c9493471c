"""What a recording does not tell from the answer: models with one thing more, or with a link in place of a spring or
of another link.

Gravity over a short travel looks like a spring, so that either may stand for the other: then both are told. So it is
with a link and what it carries, where torques tell the sum of what both weigh.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.laws import FloatArray

from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..glance import Glance
from ..identification import LOOK_STEPS
from ..physics import is_physical
from ..prior import ArmPrior
from ..rigid.inertia import N_INERTIA
from ..search.proposal import propose_models

SPRING = "spring_torque"

_IMPROBABLE, _NEARLY = -3.0, -6.0
"""Logarithms of Bayes factors from which a model counts, and from which it is looked at: a glance may be that wrong."""


@dataclass(frozen=True)
class Alternatives:
    """An answer, and models that are not improbable beside it.

    Attributes:
        own: The fit of the answer, with deviations as its rows promise them.
        others: Fits with one thing more, by its name; the best variant of each.
        swapped: Fits with one link that is far off in place of another, by the numbers of that and of the other.
    """

    own: ArmFit
    others: Mapping[str, ArmFit]
    swapped: Mapping[tuple[int, int], ArmFit]

    @property
    def groups(self) -> tuple[tuple[tuple[ArmFit, ...], FloatArray], ...]:
        """Fits with one thing more, and those with another link, each beside the answer, which is first.

        With how probable each is, as part of one; shape (n,). One thing more is weighed by the evidence, another link
        by how well it matches, and against the answer alone.
        """
        others = [one.log_evidence - self.own.log_evidence for one in self.others.values()]
        swapped = [_measure_match(one) - _measure_match(self.own) for one in self.swapped.values()]
        return (
            ((self.own, *self.others.values()), _share(others)),
            ((self.own, *self.swapped.values()), _share(swapped)),
        )

    def list_instead(self, link: int) -> tuple[str, ...]:
        """Links that would do in place of one that is far off."""
        return tuple(self.own.arm.links[other] for other, gone in self.swapped if gone == link)

    def find_spring(self, joint: int) -> tuple[float, float] | None:
        """Stiffness and its deviation [N·m/rad] of a spring that the recording neither shows nor speaks against."""
        found = self.others.get(f"{self.own.arm.joints[joint]}: {SPRING}")
        if found is None or found.log_evidence < self.own.log_evidence:
            return None
        place, names = found.find_friction(joint)
        at = place.start + next(k for k, name in enumerate(names) if name.startswith(SPRING))
        return float(found.x[at]), float(np.sqrt(found.covariance[at, at]))


def find_alternatives(equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> Alternatives:
    """Look for what is not improbable beside the answer.

    Args:
        equations: Of all joints.
        fit: What was confirmed.
        prior: How far the simulation is trusted.
    """
    own = fit_arm(fit.arm, equations, fit.model, prior, fit, steps=1)
    glance = Glance(equations, own, prior)
    best: dict[str, tuple[float, ArmModel]] = {}
    for name, model in propose_models(own.arm, own.model):
        gain = glance.measure_gain(model)
        if gain > max(_NEARLY, best.get(name, (_NEARLY, model))[0]):
            best[name] = gain, model
    looked = {name: fit_arm(fit.arm, equations, one, prior, own, steps=LOOK_STEPS) for name, (_, one) in best.items()}
    least = own.log_evidence + _IMPROBABLE
    others = {name: one for name, one in looked.items() if one.log_evidence > least and is_physical(one, own)}
    return Alternatives(own, others, _swap_links(equations, own, prior))


def _swap_links(equations: ArmEquations, own: ArmFit, prior: ArmPrior) -> dict[tuple[int, int], ArmFit]:
    """Fits in which another link is far off in place of one that the answer has so, and that match as well."""
    opened, fits = own.model.opened, {}
    for gone in opened:
        for other in set(range(len(own.arm.links))) - opened:
            model = replace(own.model, opened=opened - {gone} | {other})
            fits[other, gone] = fit_arm(own.arm, equations, model, prior, own, steps=LOOK_STEPS)
    least = _measure_match(own) + _IMPROBABLE
    return {key: one for key, one in sorted(fits.items()) if _measure_match(one) > least and is_physical(one, own)}


def _measure_match(fit: ArmFit) -> float:
    """Logarithm of how well a fit and what its links weigh match recording and simulation, where they match best.

    Without the volume about it, as an evidence has it: how many numbers of a link the motion tells says nothing of
    whether that link is off.
    """
    links = slice(N_INERTIA * len(fit.arm.links))
    return -0.5 * (fit.cost + float(np.sum((fit.x[links] / fit.prior_deviation[links]) ** 2)))


def _share(beside: Sequence[float]) -> FloatArray:
    """Probabilities of the answer and of others, from logarithms of theirs over its own."""
    every = np.array([0.0, *beside])
    weights = np.exp(every - np.max(every))
    return np.asarray(weights / np.sum(weights))


def list_links_instead(equations: ArmEquations, own: ArmFit, prior: ArmPrior, joint: int) -> tuple[str, ...]:
    """Links that explain the recording as well as the spring of a joint, were they far off.

    Args:
        equations: Of all joints.
        own: The fit with the spring, with deviations as its rows promise them.
        prior: How far the simulation is trusted.
        joint: Number of the joint.
    """
    less = own.model.without_terms(joint, SPRING)
    models = {
        name: replace(less, opened=less.opened | {i}) for i, name in enumerate(own.arm.links) if i not in less.opened
    }
    fits = {name: fit_arm(own.arm, equations, one, prior, own, steps=LOOK_STEPS) for name, one in models.items()}
    return tuple(name for name, one in fits.items() if one.log_evidence > own.log_evidence + _IMPROBABLE)

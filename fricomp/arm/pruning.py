"""What leaves the model of a fitted arm before its terms are confirmed: what is none, turned round, or not needed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from scipy.stats import chi2

from .coordinates import ArmModel
from .equations import ArmEquations
from .fit import Z95, ArmFit
from .friction import TERMS, JointForm
from .glance import Glance
from .identification import EVIDENCE
from .physics import find_reversed_term
from .prior import ArmPrior
from .rows import ArmRows
from .search.bend import find_bend
from .search.early_torque import EarlyTorques
from .search.stribeck import suit_creep, suit_curve

_MOST_GAIN = 3.5
"""Prior deviations by which a gain of all torques may be off: by more, it is the unit of the torques, or no gain."""


@dataclass
class Pruning:
    """Finds what a model is better without, one thing at a time, and remembers what it tried.

    Attributes:
        prior: How far the simulation is trusted.
        bent: Joints with forms of which it is known that their curve does not make what bends over the speed.
        freed: Joints at which viscous friction that was held at zero was tried free.
        asked: Joints with names of terms beside which a bend over the speed was asked for.
        gains: Logarithm of the Bayes factor of what was taken in here, by joint and name.
    """

    prior: ArmPrior
    bent: set[tuple[int, JointForm]] = field(default_factory=set)
    freed: set[int] = field(default_factory=set)
    asked: set[tuple[int, frozenset[str]]] = field(default_factory=set)
    gains: dict[tuple[int, str], float] = field(default_factory=dict)

    def find_less(self, rows: ArmRows, equations: ArmEquations, fit: ArmFit, widened: ArmFit) -> ArmModel | None:
        """The next model to fit in place of this one; None where it may stay.

        Args:
            rows: Motion and torques.
            equations: Of these rows.
            fit: Of these equations.
            widened: The same with deviations as its stretches show them.
        """
        return (
            _drop_empty_form(widened)
            or _drop_empty_lean(widened)
            or _drop_far_gain(fit, self.prior)
            or _drop_reversed_term(fit)
            or _drop_turned_delay(rows, equations, fit, self.prior)
            or _drop_needless_bend(rows, equations, fit, self.prior, self.bent)
            or _free_viscous(rows, equations, fit, self.prior, self.freed)
            or self._take_bend(equations, fit)
        )

    def _take_bend(self, equations: ArmEquations, fit: ArmFit) -> ArmModel | None:
        """The model with what bends over the speed, beside the curve that suits it; None for no such.

        What left the model since may have kept it out, and a curve that it came with.
        """
        forms = {(j, frozenset(form.names)): j for j, form in enumerate(fit.model.forms)}
        new = {key: j for key, j in forms.items() if key not in self.asked}
        glance = Glance(equations, fit, self.prior) if new else None
        for key, j in new.items():
            self.asked.add(key)
            bend = find_bend(glance, fit, j) if glance else None
            if bend is not None and bend.gain > EVIDENCE:
                self.gains[j, bend.term] = bend.gain
                return bend.model
        return None


def measure_size(fit: ArmFit, joint: int, term: str) -> float:
    """How far a term's parameters are from none of it, in the 95 % region about them; below 1 it holds none."""
    place, names = fit.find_friction(joint)
    own = TERMS[term].names(dict(fit.model.forms[joint].terms)[term])
    at = [place.start + names.index(name) for name in own]
    value, spread = fit.x[at], fit.covariance[np.ix_(at, at)]
    return float(value @ np.linalg.solve(spread, value)) / float(chi2.ppf(0.95, len(at)))


def _drop_empty_form(fit: ArmFit) -> ArmModel | None:
    """The model without a form of an effect that is none of it where another form is beside it; None for no such."""
    sizes = {
        (j, name): measure_size(fit, j, name)
        for j, form in enumerate(fit.model.forms)
        for name in form.names
        if form.has_other_form(name)
    }
    joint, name = min(sizes, key=lambda key: sizes[key], default=(0, ""))
    if not name or sizes[joint, name] >= 1.0:
        return None
    return fit.model.with_form(joint, JointForm(tuple(one for one in fit.model.forms[joint].terms if one[0] != name)))


def _drop_needless_bend(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, kept: set[tuple[int, JointForm]]
) -> ArmModel | None:
    """The model without a bend over the speed that the curve of its joint makes as well, or without a bristle that
    friction that creeps does as well as; None for no such.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
        kept: Joints with forms of which that is known not to be so; those that are found are added.
    """
    for j, form in enumerate(fit.model.forms):
        if (j, form) in kept:
            continue
        for name in (one for one in form.names if TERMS[one].family == "speed"):
            instead = suit_curve(rows, equations, fit, prior, fit.model.without_terms(j, name), j)
            if instead is not None and instead.lost < EVIDENCE:
                return instead.model
        if "presliding_hysteresis" in form.names:
            less = fit.model.without_terms(j, "presliding_hysteresis")
            creeping = suit_creep(rows, equations, fit, prior, less, j)
            if creeping.lost < EVIDENCE:
                return creeping.model
        kept.add((j, form))
    return None


def _free_viscous(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, freed: set[int]
) -> ArmModel | None:
    """The model in which viscous friction that was held at zero is free beside a curve that suits it; None for no such.

    While terms are chosen it may be below zero, and makes up for a curve that falls over most speeds.

    Args:
        rows: Motion and torques.
        equations: Of these rows.
        fit: Of these equations.
        prior: How far the simulation is trusted.
        freed: Joints at which that was tried; those that are tried are added.
    """
    for j, form in enumerate(fit.model.forms):
        if (j, "viscous") not in fit.model.pinned or j in freed or "power_law_viscous" in form.names:
            continue
        freed.add(j)
        free = replace(fit.model, pinned=frozenset(one for one in fit.model.pinned if one[0] != j))
        other = suit_curve(rows, equations, fit, prior, free, j)
        if other is not None and other.lost < 0.0:
            return other.model
    return None


def _drop_empty_lean(fit: ArmFit) -> ArmModel | None:
    """The model whose gravity does not lean over, where the intervals along both axes hold none; None for no such."""
    value, spread = fit.lean
    is_empty = fit.model.tilted and bool(np.all(np.abs(value) < Z95 * spread))
    return replace(fit.model, tilted=False) if is_empty else None


def _drop_far_gain(fit: ArmFit, prior: ArmPrior) -> ArmModel | None:
    """The model without a gain of all torques that is further off than it may be; None for no such.

    With all links at once it takes the place of what was not found yet when it was taken in.
    """
    is_far = fit.model.gain and abs(fit.gain[0] - 1.0) > _MOST_GAIN * prior.gain
    return replace(fit.model, gain=False) if is_far else None


def _drop_reversed_term(fit: ArmFit) -> ArmModel | None:
    """The model without a term that came out turned round; None for no such."""
    turned = find_reversed_term(fit)
    return None if turned is None else fit.model.without_terms(*turned)


def _drop_turned_delay(rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> ArmModel | None:
    """The model without a delay of one joint that came out early and is not shown to be; None for no such.

    Late when it was taken in, it stands in for friction that turns before its joint does once rows near reversals count
    for less.
    """
    (name,) = TERMS["torque_delay"].names(0)
    early = [j for j in range(len(fit.arm.joints)) if fit.friction(j).get(name, 0.0) < 0.0]
    if not early:
        return None
    glance, torques = Glance(equations, fit, prior), EarlyTorques(rows, equations, fit)
    unshown = next((j for j in early if not torques.shows(j, glance)), None)
    return None if unshown is None else fit.model.without_terms(unshown, "torque_delay")

"""Confirm the terms of a fitted arm: those that recur in halves stay, and are named where the held-out error falls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.stats import chi2

from fricomp.diagnosis.effects import EFFECTS
from fricomp.root_mean_square import compute_rms

from .confirmation import ConfirmedData, HeldOutErrors, without_term
from .coordinates import ArmModel
from .equations import ArmEquations
from .fit import Z95, ArmFit
from .friction import TERMS, JointForm
from .glance import Glance
from .identification import EVIDENCE, ArmIdentification
from .matter import LEAST_MATTER
from .own_delay import find_own_delay
from .physics import find_reversed_term, is_whole
from .prior import ArmPrior
from .robust_fit import fit_robustly
from .rows import ArmRows
from .search.early_torque import EarlyTorques
from .search.stribeck import suit_curve
from .uncertainty.scatter import widen_covariance

RECURRENCE = 0.9
"""Least share of halves that must ask for a term: the probability of a name that is printed."""

_LEAST_RECURRENCE = 0.5
"""The same of a term that stays in the model and is not named, since it lowers the held-out error by `LEAST_FALL`."""

LEAST_FALL = 0.1
"""Least part by which a named term lowers its joint's held-out error. On real arms further terms gain up to a tenth
whatever they are."""

_LEAST_FALL_OF_A_GAIN = 0.25
"""The same of the scale of one joint's torque. It is known only by comparison with other joints, so that what is wrong
with their models looks like it: on a real arm one joint gains a sixth by it. A delay shows in its own joint."""

_MOST_GAIN = 3.5
"""Prior deviations by which a gain of all torques may be off: by more, it is the unit of the torques, or no gain."""


@dataclass(frozen=True)
class TermEvidence:
    """What speaks for a term of a joint.

    Attributes:
        recurrence: Share of halves that ask for it.
        log_bayes_factor: By how much it makes the recording more probable.
        fall: Part by which the joint's held-out error falls with it.
    """

    recurrence: float
    log_bayes_factor: float
    fall: float


@dataclass(frozen=True)
class ArmAnswer:
    """The confirmed fit.

    Attributes:
        identification: With the model that was confirmed.
        evidence: Of each joint's terms that are effects, by number of the joint and name.
        errors: On data that took no part.
        own_delays: By how much later than all the torque of each joint is, and the standard deviation [s]; none where
            the model has no such term.
    """

    identification: ArmIdentification
    evidence: dict[tuple[int, str], TermEvidence]
    errors: HeldOutErrors
    own_delays: tuple[tuple[float, float], ...]

    def is_named(self, joint: int, term: str) -> bool:
        """Whether a term of a joint is physics that matters.

        It heads its family, recurs, lowers the held-out error, is no trifle, its interval does not hold a joint without
        it, and its variant is not the last that was tried.
        """
        form = self.identification.fit.model.forms[joint]
        if term not in EFFECTS or form.find_head(term) != term or self.evidence[joint, term].recurrence < RECURRENCE:
            return False
        fit = self.identification.fit
        matters = self.evidence[joint, term].fall >= LEAST_FALL and self._measure_part(joint, term) >= LEAST_MATTER
        sized = _measure_size(fit, joint, term) > 1.0 and _has_value(term, dict(form.terms)[term])
        timed = term != "torque_delay" or joint not in self._unshown
        return matters and sized and is_whole(fit, joint, term) and timed

    def list_unnamed(self, joint: int) -> dict[str, float]:
        """Effects of a joint that stay in the model without a name and are no trifle, with what each lowers the
        held-out error by, as part of it."""
        form = self.identification.fit.model.forms[joint]
        return {
            name: max(self.evidence[joint, name].fall, 0.0)
            for name in form.names
            if name in EFFECTS
            and form.find_head(name) == name
            and not self.is_named(joint, name)
            and self._measure_part(joint, name) >= LEAST_MATTER
        }

    def measure_unexplained(self, joint: int) -> float:
        """Held-out error of a joint over means of 0.2 s, as part of its friction."""
        _, names = self.identification.fit.find_friction(joint)
        return float(self.errors.means[-1, joint]) / max(self._measure_friction(joint, names), 1e-300)

    def _measure_part(self, joint: int, term: str) -> float:
        """RMS of what a term adds to a joint, as part of all friction of it."""
        fit = self.identification.fit
        own, (_, every) = TERMS[term].names(dict(fit.model.forms[joint].terms)[term]), fit.find_friction(joint)
        return self._measure_friction(joint, own) / max(self._measure_friction(joint, every), 1e-300)

    def _measure_friction(self, joint: int, names: Sequence[str]) -> float:
        """RMS of some of a joint's friction over the rows in which it moves [N·m] or [N]."""
        found = self.identification
        torque = found.equations.friction_of(joint, names) @ [found.fit.friction(joint)[name] for name in names]
        return compute_rms(torque[found.equations.moving[:, joint]])

    @cached_property
    def _unshown(self) -> frozenset[int]:
        """Joints whose torque is earlier or later than those of the others, and does not show it in the whole model.

        Friction alone is late where it builds up over a travel, or lags.
        """
        found, (delay,) = self.identification, TERMS["torque_delay"].names(0)
        values = {j: found.fit.friction(j)[delay] for j in range(len(found.fit.arm.joints)) if self._has_delay(j)}
        if not values:
            return frozenset()
        glance = Glance(found.equations, found.fit, found.prior)
        torques = EarlyTorques(found.rows, found.equations, found.fit)
        shown = {j: torques.shows(j, glance) if one <= 0.0 else torques.is_link_late(j) for j, one in values.items()}
        return frozenset(j for j, one in shown.items() if not one)

    def _has_delay(self, joint: int) -> bool:
        return "torque_delay" in self.identification.fit.model.forms[joint].names

    def list_named(self, joint: int) -> tuple[str, ...]:
        """Terms of a joint that are named, in the order in which they were taken in."""
        names = self.identification.fit.model.forms[joint].names
        return tuple(name for name in names if self.is_named(joint, name))


def _has_value(term: str, variant: int) -> bool:
    """Whether a variant lies within what was tried. A bristle whose interval, from the distance below to that above,
    holds either end of that has no distance, and a drag whose exponent is the least is a curve of another kind."""
    last = len(TERMS[term].values) - 1
    ends = {"presliding_hysteresis": (0, 1, last - 1, last), "power_law_viscous": (0,)}
    return variant not in ends.get(term, ())


def _measure_size(fit: ArmFit, joint: int, term: str) -> float:
    """How far a term's parameters are from none of it, in the 95 % region about them; below 1 it holds none."""
    place, names = fit.find_friction(joint)
    own = TERMS[term].names(dict(fit.model.forms[joint].terms)[term])
    at = [place.start + names.index(name) for name in own]
    value, spread = fit.x[at], fit.covariance[np.ix_(at, at)]
    return float(value @ np.linalg.solve(spread, value)) / float(chi2.ppf(0.95, len(at)))


def _drop_empty_form(fit: ArmFit) -> ArmModel | None:
    """The model without a form of an effect that is none of it where another form is beside it; None for no such."""
    sizes = {
        (j, name): _measure_size(fit, j, name)
        for j, form in enumerate(fit.model.forms)
        for name in form.names
        if form.has_other_form(name)
    }
    joint, name = min(sizes, key=lambda key: sizes[key], default=(0, ""))
    if not name or sizes[joint, name] >= 1.0:
        return None
    forms = list(fit.model.forms)
    forms[joint] = JointForm(tuple(term for term in forms[joint].terms if term[0] != name))
    return replace(fit.model, forms=tuple(forms))


def _drop_needless_bend(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior, kept: set[tuple[int, JointForm]]
) -> ArmModel | None:
    """The model without a bend over the speed that the curve of its joint makes as well; None for no such.

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
            instead = suit_curve(rows, equations, fit, prior, without_term(fit.model, j, name), j)
            if instead is not None and instead[1] < EVIDENCE:
                return instead[0]
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
        if other is not None and other[1] < 0.0:
            return other[0]
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
    return None if turned is None else without_term(fit.model, *turned)


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
    return None if unshown is None else without_term(fit.model, unshown, "torque_delay")


def confirm_terms(found: ArmIdentification, seed: int = 0) -> ArmAnswer:
    """Keep the terms that come again in halves of the recording, and measure what they matter on held-out data.

    Args:
        found: The identified arm.
        seed: Of the halves.
    """
    arm, rows, prior = found.fit.arm, found.rows, found.prior
    fit, equations = found.fit, found.equations
    bent: set[tuple[int, JointForm]] = set()
    freed: set[int] = set()
    while True:
        widened = widen_covariance(fit, equations, rows)
        less = (
            _drop_empty_form(widened)
            or _drop_empty_lean(widened)
            or _drop_far_gain(fit, prior)
            or _drop_reversed_term(fit)
            or _drop_turned_delay(rows, equations, fit, prior)
            or _drop_needless_bend(rows, equations, fit, prior, bent)
            or _free_viscous(rows, equations, fit, prior, freed)
        )
        if less is not None:
            fit, equations = fit_robustly(arm, rows, equations, less, prior, settled=True)
            continue
        data = ConfirmedData(arm, equations, prior, rows)
        recurrence = data.measure_stability(fit, seed)
        errors = data.measure_errors(fit)
        evidence = {
            (j, name): TermEvidence(
                share,
                found.trials.get(f"{arm.joints[j]}: {name}", 0.0),
                _measure_fall(data, fit, errors, (j, name)),
            )
            for (j, name), share in recurrence.items()
        }
        heads = {(j, name): evidence[j, fit.model.forms[j].find_head(name)] for j, name in evidence}
        weak = {key: one for key, one in evidence.items() if not _stays(key[1], one, heads[key])}
        if not weak:
            final = replace(found, fit=widened, equations=equations)
            return ArmAnswer(final, evidence, errors, tuple(find_own_delay(final, j) for j in range(len(arm.joints))))
        weakest = min(weak, key=lambda key: (weak[key].recurrence, weak[key].fall))
        fit, equations = fit_robustly(arm, rows, equations, without_term(fit.model, *weakest), prior, settled=True)


def _stays(name: str, evidence: TermEvidence, head: TermEvidence) -> bool:
    """What recurs and lowers the held-out error at all stays in the model, and what half of the halves ask for where it
    lowers that as a name would: without it, links and friction would take its place.

    What a model has wrong recurs as well, and may ask for anything; held-out data then gain nothing by that. What would
    be wrong with the torque signal of one joint must recur and matter, and so must a gear: all links bend with it. What
    mends the form of an effect needs one that matters.
    """
    signal = name in EFFECTS and EFFECTS[name].kind == "measurement"
    if head is evidence and (signal or TERMS[name].whole):
        least = _LEAST_FALL_OF_A_GAIN if name == "torque_gain_error" else LEAST_FALL
        return evidence.recurrence >= RECURRENCE and evidence.fall >= least
    helps = evidence.recurrence >= _LEAST_RECURRENCE and evidence.fall >= LEAST_FALL
    recurs = evidence.recurrence >= RECURRENCE and evidence.fall > 0.0
    return (recurs or helps) and (head is evidence or head.fall >= LEAST_FALL)


def _measure_fall(data: ConfirmedData, fit: ArmFit, errors: HeldOutErrors, term: tuple[int, str]) -> float:
    """Part by which a joint's held-out error falls with a term.

    That of rows or that of means over 0.1 or 0.2 s, whichever falls furthest: a ripple shows in rows alone, and what
    acts for longer among less noise. Of a law without a factor, such as a gap's, also that of rows as they count in the
    fit: it acts where the load turns, and what is left about the joint's own reversals hides it. What has a factor may
    take what is left elsewhere for its own.

    A gain must do better than links that may weigh anything and a rotor that may be less than none: a sensor that asks
    for such a one is wrong in another way.
    """
    less = without_term(fit.model, *term)
    if term[1] == "torque_gain_error":
        opened = less.opened | frozenset(range(term[0], len(fit.arm.links)))
        less = replace(less, opened=opened, rotorless=less.rotorless - {term[0]})
    joint, whole = term[0], TERMS[term[1]].whole
    after, before = (
        np.array([rows[joint], *means[:, joint], *([weighted[joint]] if whole else [])])
        for rows, means, weighted in (
            (errors.model, errors.means, errors.weighted),
            data.measure_model(less, fit),
        )
    )
    return float(np.max(1.0 - after / np.maximum(before, 1e-300)))

"""Confirm the terms of a fitted arm: those that recur in halves stay, and are named where the held-out error falls."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from fricomp.diagnosis.effects import EFFECTS
from fricomp.root_mean_square import compute_rms

from .confirmation import ConfirmedData, HeldOutErrors
from .coordinates import ArmModel
from .fit import ArmFit
from .friction import TERMS
from .glance import Glance
from .identification import ArmIdentification
from .matter import LEAST_MATTER
from .physics import is_whole
from .pruning import Pruning, measure_size
from .robust_fit import fit_robustly
from .search.early_torque import EarlyTorques
from .search.own_delay import measure_own_delay, refine_delays
from .search.shared_delay import are_others_early
from .search.stribeck import hold_curve, is_at_end, suit_curve
from .uncertainty.held_rotor import free_rotors
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
        """Whether a term of a joint is physics that matters: an effect that lacks nothing."""
        form = self.identification.fit.model.forms[joint]
        return term in EFFECTS and form.find_head(term) == term and not self.find_lack(joint, term)

    def find_lack(self, joint: int, term: str) -> str:
        """What keeps a term of a joint that heads its family from its name, in words; empty where nothing does.

        It recurs, lowers the held-out error, is no trifle, its interval does not hold a joint without it, and its
        variant is not the last that was tried.
        """
        fit, evidence = self.identification.fit, self.evidence[joint, term]
        variant = dict(fit.model.forms[joint].terms)[term]
        if evidence.recurrence < RECURRENCE:
            return f"only {evidence.recurrence:.0%} of the halves of the recording ask for it"
        if evidence.fall < LEAST_FALL:
            return f"it lowers the held-out error by {max(evidence.fall, 0.0):.0%} only"
        if self._measure_part(joint, term) < LEAST_MATTER:
            return f"it is less than {LEAST_MATTER:.1%} of the friction of its joint"
        if not measure_size(fit, joint, term) > 1.0:
            return "its interval holds a joint without it"
        if not _has_value(term, variant):
            label = TERMS[term].label.replace("_", " ")
            return f"what fits best is at the end of what was tried of its {label}, so that it may be something else"
        if not is_whole(fit, joint, term):
            return "less than half of what its law asks for is there"
        if term == "torque_delay" and joint in self._unshown:
            return "links and friction do not ask for it both, or the other joints ask for torques that are early"
        return ""

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
        """Held-out error of a joint that lasts from one mean of 0.2 s to the next, as part of its friction."""
        _, names = self.identification.fit.find_friction(joint)
        return float(self.errors.lasting[joint]) / max(self._measure_friction(joint, names), 1e-300)

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
        shown = {
            j: torques.shows(j, glance)
            if one <= 0.0
            else torques.is_link_late(j) and not are_others_early(glance, found.fit, j)
            for j, one in values.items()
        }
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


def confirm_terms(found: ArmIdentification, seed: int = 0) -> ArmAnswer:
    """Keep the terms that come again in halves of the recording, and measure what they matter on held-out data.

    Args:
        found: The identified arm.
        seed: Of the halves.
    """
    arm, rows, prior = found.fit.arm, found.rows, found.prior
    fit, equations = found.fit, found.equations
    pruning = Pruning(prior)
    if any(form.geared and "torque_delay" in form.names for form in fit.model.forms):
        # A gear that gives way is the second derivative of a torque, and so is what a term linear in a delay leaves.
        fit, equations = refine_delays(rows, equations, fit, prior)
    while True:
        widened = widen_covariance(fit, equations, rows)
        less = pruning.find_less(rows, equations, fit, widened)
        if less is not None:
            fit, equations = fit_robustly(arm, rows, equations, less, prior, settled=True)
            continue
        data = ConfirmedData(arm, equations, prior, rows)
        recurrence = data.measure_stability(fit, seed)
        errors = data.measure_errors(fit)
        evidence = {
            (j, name): TermEvidence(
                share,
                pruning.gains.get((j, name), found.trials.get(f"{arm.joints[j]}: {name}", 0.0)),
                _measure_fall(data, fit, errors, (j, name)),
            )
            for (j, name), share in recurrence.items()
        }
        heads = {(j, name): evidence[j, fit.model.forms[j].find_head(name)] for j, name in evidence}
        weak = {key: one for key, one in evidence.items() if not _stays(key[1], one, heads[key])}
        if not weak:
            final = replace(found, fit=free_rotors(widened, equations, prior), equations=equations)
            # Only now: taken earlier while terms are chosen, the torque of a joint that is late by chance makes others.
            moved, late = refine_delays(rows, equations, widened, prior)
            delays = tuple(measure_own_delay(rows, late, moved, prior, j) for j in range(len(arm.joints)))
            return ArmAnswer(final, evidence, errors, delays)
        less = fit.model
        for joint, term in _choose_weakest(weak):
            less = less.without_terms(joint, term)
        fit, equations = fit_robustly(arm, rows, equations, less, prior, settled=True)


def _choose_weakest(weak: dict[tuple[int, str], TermEvidence]) -> list[tuple[int, str]]:
    """What leaves the model at once: the weakest term of each joint, and a gear, with which all links bend, alone."""
    order = sorted(weak, key=lambda key: (weak[key].recurrence, weak[key].fall))
    gears = [key for key in order if TERMS[key[1]].whole]
    return gears[:1] or list({joint: (joint, term) for joint, term in reversed(order)}.values())


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
    less = fit.model.without_terms(*term)
    if term[1] == "torque_gain_error":
        opened = less.opened | frozenset(range(term[0], len(fit.arm.links)))
        less = replace(less, opened=opened, rotorless=less.rotorless - {term[0]})
    bent = _measure_bend(data, fit, less, term)
    if bent is not None:
        return bent
    joint, whole = term[0], TERMS[term[1]].whole
    after, before = (
        np.array([rows[joint], *means[:, joint], *([weighted[joint]] if whole else [])])
        for rows, means, weighted in (
            (errors.model, errors.means, errors.weighted),
            data.measure_model(less, fit),
        )
    )
    return float(np.max(1.0 - after / np.maximum(before, 1e-300)))


def _measure_bend(data: ConfirmedData, fit: ArmFit, less: ArmModel, term: tuple[int, str]) -> float | None:
    """The same of what bends over the speed, beside curves that stand still; None for anything else.

    Free to move along its slopes, a wide Stribeck curve makes any bend, also such as no curve has. So the term is
    compared with the curve that suits the joint without it, unless that is pressed against the end of what curves are.
    """
    joint, name = term
    form = fit.model.forms[joint]
    if TERMS[name].family != "speed" or form.has_other_form(name):
        return None
    instead = suit_curve(data.rows, data.equations, fit, data.prior, less, joint)
    if instead is None:
        return None
    own, other, rest = _hold(fit.model, joint), _hold(instead.fit.model, joint), data
    if is_at_end(instead.equations, instead.fit, joint):
        other, start = _hold(less, joint), fit
    else:
        rest, start = ConfirmedData(fit.arm, instead.equations, data.prior, data.rows), instead.fit
    after, before = (
        np.array([rows[joint], *means[:, joint]])
        for rows, means, _ in (data.measure_model(own, fit), rest.measure_model(other, start))
    )
    return float(np.max(1.0 - after / np.maximum(before, 1e-300)))


def _hold(model: ArmModel, joint: int) -> ArmModel:
    return hold_curve(model, joint) if "stribeck" in model.forms[joint].names else model

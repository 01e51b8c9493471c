"""Confirm the terms of a fitted arm: those that recur in halves stay, and are named where the held-out error falls."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fricomp.diagnosis.effects import EFFECTS

from .confirmation import ConfirmedData, HeldOutErrors, without_term
from .fit import ArmFit
from .identification import ArmIdentification, fit_robustly

__all__ = ["ArmAnswer", "TermEvidence", "confirm_terms"]

_RECURRENCE = 0.9
"""Least share of halves that must ask for a term: the probability of a name that is printed."""

_LEAST_FALL = 0.1
"""Least part by which a named term lowers its joint's held-out error. On real arms further terms gain up to a tenth
whatever they are."""

_LEAST_FALL_OF_A_SIGNAL = 0.25
"""The same of what would be wrong with one joint's torque signal. Its scale and delay are known only by comparison with
other joints, so that what is wrong with their models looks like it: on a real arm one joint gains a sixth by a gain."""


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
    """

    identification: ArmIdentification
    evidence: dict[tuple[int, str], TermEvidence]
    errors: HeldOutErrors

    def is_named(self, joint: int, term: str) -> bool:
        """Whether a term of a joint is physics that matters: it lowers the held-out error, and heads its family."""
        form = self.identification.fit.model.forms[joint]
        matters = self.evidence[joint, term].fall >= _LEAST_FALL
        return term in EFFECTS and form.find_head(term) == term and matters


def confirm_terms(found: ArmIdentification, seed: int = 0) -> ArmAnswer:
    """Keep the terms that come again in halves of the recording, and measure what they matter on held-out data.

    Args:
        found: The identified arm.
        seed: Of the halves.
    """
    arm, rows, prior = found.fit.arm, found.rows, found.prior
    fit, equations = found.fit, found.equations
    while True:
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
        heads = {(j, name): fit.model.forms[j].find_head(name) == name for j, name in evidence}
        weak = {key: one for key, one in evidence.items() if not _stays(key[1], one, named=heads[key])}
        if not weak:
            return ArmAnswer(replace(found, fit=fit, equations=equations), evidence, errors)
        weakest = min(weak, key=lambda key: (weak[key].recurrence, weak[key].fall))
        fit, equations = fit_robustly(arm, rows, equations, without_term(fit.model, *weakest), prior)


def _stays(name: str, evidence: TermEvidence, *, named: bool) -> bool:
    """What recurs stays in the model: without it, links and friction would take its place.

    What would be wrong with the torque signal of one joint must matter, too.
    """
    matters = evidence.fall >= _LEAST_FALL_OF_A_SIGNAL
    of_a_signal = named and name in EFFECTS and EFFECTS[name].kind == "measurement"
    return evidence.recurrence >= _RECURRENCE and (matters or not of_a_signal)


def _measure_fall(data: ConfirmedData, fit: ArmFit, errors: HeldOutErrors, term: tuple[int, str]) -> float:
    """Part by which a joint's held-out error falls with a term."""
    before = data.measure_model(without_term(fit.model, *term), fit)
    return 1.0 - float(errors.model[term[0]] / max(before[term[0]], 1e-300))

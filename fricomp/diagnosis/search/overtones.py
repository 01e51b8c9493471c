"""Ripples that are no sines: overtones of what was found, where they take much of what it leaves."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..effects.overtones import MULTIPLES, list_overtones, start_overtone
from ..effects.structure import N_BASE, Candidate
from .explanation import Explanation
from .preparation import Baseline
from .refit import fit_from, rebuild_contexts
from .screening import screen
from .settings import SEARCH


def fit_overtones(baseline: Baseline, explanations: Sequence[Explanation], threshold: float) -> list[Explanation]:
    """Fit explanations whose ripples leave overtones again, with these.

    No part of a joint waves as a sine alone. What is left of its wave would be taken for another effect, or hide one.
    """
    wanted, boxes = [], []
    for one in explanations:
        settled = tuple(_add_overtones(baseline, one, candidate, threshold) for candidate in one.settled)
        if settled != one.settled:
            more = replace(one.structure, candidates=settled).move_to(rebuild_contexts(baseline, one))
            wanted.append((more, one.fit.theta[:N_BASE]))
            boxes.append(one.box)
    return fit_from(baseline, wanted, boxes)


def _add_overtones(baseline: Baseline, one: Explanation, candidate: Candidate, threshold: float) -> Candidate:
    """Add those overtones to a ripple of an explanation that take much of what it leaves above the noise.

    They stand out of noise as well that was measured too loud, since a fine ripple was taken for it.
    """
    values, fit = dict(candidate.values), one.fit
    if not candidate.effect.ripple:
        return candidate
    excess = float(fit.residual @ fit.residual) - fit.residual.size
    further = [times for times in MULTIPLES if times not in list_overtones(values)]
    waves = {candidate.at_order(times * values["order"]): times for times in further}
    columns = screen(baseline.problem, one.structure, fit.theta, fit.residual, fit.jacobian, list(waves)).columns
    loud = [column for column in columns if column.energy > max(threshold, SEARCH.overtone_takes * excess)]
    for column in loud:
        values |= start_overtone(waves[column.candidate])
    return replace(candidate, values=tuple(values.items()))

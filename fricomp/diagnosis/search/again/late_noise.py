"""The noise, measured anew beside what was found: a ripple of torque had been taken for a part of it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...effects.structure import N_BASE
from ...joint.base import unpack
from ...joint.base_fit import fit_base
from ..explanation import Explanation
from ..preparation import Baseline, build_structure, weigh_by_nulls
from ..refit import fit_from, rebuild
from ..search import SearchResult
from ..settings import SEARCH


def remeasure_noise(baseline: Baseline, found: SearchResult, seed: int) -> Baseline | None:
    """Measure the noise beside the best explanation; None where that leaves about what was taken for noise, is one
    effect that leaves no more than noise and there is no simulation beside which inertia and gravity count as well, or
    does not simulate with its noise.

    Nulls of the base vary from row to row as the recording does. A torque that is missing and changes within a few
    rows, such as cogging, makes them as loud as itself, and what else is missing is weighed by that, found or not.

    Args:
        baseline: The base with the nulls that were searched with.
        found: What the search found.
        seed: Seed of the nulls' noise.
    """
    best = found.best
    if best is None or baseline.measure_typical_loudness(best.fit) > SEARCH.quieter:
        return None
    try:
        return _measure_beside(baseline, best, seed)
    except FloatingPointError:
        return None


def _measure_beside(baseline: Baseline, best: Explanation, seed: int) -> Baseline | None:
    structure = rebuild(baseline, best)
    theta = np.concatenate([best.fit.theta[:N_BASE], structure.build_start()])
    plant, effects = structure.unpack_plant(theta), structure.compute_contributions(theta)
    problem, nulls = weigh_by_nulls(baseline.problem, plant, effects, baseline.nulls.count, seed)
    problem = problem.cut_samples_for(plant, unpack(baseline.fit.theta))  # without the effects the bristle may be stiff
    fit = fit_base(problem, baseline.fit.theta, baseline.box)
    quieter = replace(baseline, problem=problem, fit=fit, nulls=nulls, recolouring=None)
    (again,) = fit_from(quieter, [(structure, theta[:N_BASE])], best.box)
    alone = len(best.names) == 1 and baseline.rigid is None
    if alone and quieter.measure_loudness(again.fit) <= SEARCH.something_left:
        return None
    return replace(quieter, structure=build_structure(problem, fit, baseline.box))

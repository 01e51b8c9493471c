"""Friction that creeps, seen only beside the effects that bend the base."""

from __future__ import annotations

from ..effects import EFFECTS
from ..effects.structure import N_BASE, Structure
from ..joint.base import BASE_NAMES
from ..joint.base_fit import propose_creep_starts
from .preparation import Baseline, find_top_speed
from .refit import fit_from
from .search import SearchResult
from .settings import SEARCH

_CREEP = BASE_NAMES.index("creep_velocity")


def has_late_creep(baseline: Baseline, found: SearchResult) -> bool:
    """Tell whether the best explanation leaves far less when friction creeps in place of a bristle.

    A strong effect, such as a ripple as large as the friction, hides from the base alone what its friction does. A
    power law of the speed may draw the creep.
    """
    if not found.explanations or baseline.fit.theta[_CREEP] > 0.0:
        return False
    best = found.best or found.explanations[0]
    residual, draws_curve = best.fit.residual, any(EFFECTS[name].viscous_exponent for name in best.names)
    if float(residual @ residual) < SEARCH.late_creep_loud**2 * residual.size and not draws_curve:
        return False
    starts = propose_creep_starts(best.fit.theta[:N_BASE], baseline.box, find_top_speed(baseline.problem.tracks))
    structure = Structure(best.structure.contexts, best.settled)
    fits = [one for start, box in starts for one in fit_from(baseline, [(structure, start)], box)]
    return min(one.fit.cost for one in fits) < SEARCH.late_creep_cost * best.fit.cost

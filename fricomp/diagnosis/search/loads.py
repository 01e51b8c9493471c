"""Friction under load by another law, under the load of the joint that was found."""

from __future__ import annotations

from ..effects import EFFECTS
from ..effects.structure import N_BASE, Candidate, Structure
from ..joint.solver import Race
from .explanation import Explanation
from .preparation import Baseline
from .refit import fit_from, polish, rebuild_contexts
from .settings import SEARCH


def fit_loads(baseline: Baseline, best: Explanation) -> list[Explanation]:
    """Fit each other law of friction under load in place of that of the best explanation, and beside it; none where it
    has none.

    A base without such friction has another gravity, and with it another load: from there one law may get no further
    than to another minimum, however well it would explain the joint that another one has led to.
    """
    own = [one for one in best.settled if one.effect.follows_load]
    others = [name for name, effect in EFFECTS.items() if effect.follows_load and name not in best.names]
    if not own:
        return []
    contexts, theta = rebuild_contexts(baseline, best), best.fit.theta[:N_BASE]
    wanted = []
    for name in others:
        starts = EFFECTS[name].propose_starts(contexts)
        kept = [tuple(one for one in best.settled if one not in own), best.settled]
        wanted += [(*rest, Candidate(name, tuple(start.items()))) for rest in kept for start in starts[:1]]
    race = Race(baseline.fit.cost, best.fit.cost)
    fitted = fit_from(baseline, [(Structure(contexts, one), theta) for one in wanted], best.box, race=race)
    return polish(baseline, fitted, iterations=SEARCH.last_steps, lead=best.fit.cost)

"""The whole search: once more where what was found shows that friction, first estimate or noise were others."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from ..effects.structure import N_BASE
from .again.late_creep import does_creep, find_late_creep, propose_creep
from .again.late_joint import find_far_joint, measure_left, measure_plain_left
from .again.late_noise import remeasure_noise
from .again.lower_base import find_lower_base
from .explanation import Explanation
from .preparation import Baseline
from .search import SearchResult, search
from .settings import SEARCH

Tell = Callable[[str], None]


def search_in_rounds(
    baseline: Baseline, base: Callable[..., Baseline], seed: int, tell: Tell
) -> tuple[Baseline, SearchResult]:
    """Search for effects; once more from another valley of the base that leaves less, with friction that creeps, where
    a strong effect hid that from the base, or with friction that holds, where creep had stood in for one, from the
    joint that was found, where such an effect had bent the first estimate, and with the noise that is left beside what
    was found, where that had passed for noise.

    Args:
        baseline: The base fitted to the recordings.
        base: Fits it anew; takes `known`, `holds` and `start` of `prepare`.
        seed: Seed of the nulls' noise.
        tell: Called with a few words before each round.

    Returns:
        The base of the last round, and what was found with it.
    """
    tell("searching for effects")
    base, baseline, found = _search_from_lower_base(baseline, search(baseline), base, tell)
    other = _search_with_bristle if does_creep(baseline) else _search_with_creep
    base, baseline, found = other(baseline, found, base, tell)
    baseline, found = _search_from_joint(baseline, found, base, tell)
    quieter = remeasure_noise(baseline, found, seed)
    if quieter is None:
        return baseline, found
    tell("searching again, with the noise that is left")
    return quieter, search(quieter, found.best)


def _search_from_lower_base(
    baseline: Baseline, found: SearchResult, base: Callable[..., Baseline], tell: Tell
) -> tuple[Callable[..., Baseline], Baseline, SearchResult]:
    """Search again from a base that leaves less, to which what was found has led; keep it where it does with weights
    of its own."""
    lower = find_lower_base(baseline, found)
    if lower is None:
        return base, baseline, found
    tell("searching again, from a base that leaves less")
    lowered = partial(base, known=lower)
    begun = _begin_again(lowered, found.best)
    kept = begun is not None and begun[0].noise_ratio < baseline.noise_ratio
    return (lowered, *begun) if begun is not None and kept else (base, baseline, found)


def _search_with_creep(
    baseline: Baseline, found: SearchResult, base: Callable[..., Baseline], tell: Tell
) -> tuple[Callable[..., Baseline], Baseline, SearchResult]:
    """Search again with friction that creeps, where what was found leaves less beside it, or the base takes the torque
    too early; keep it where it leaves far less, or the search does."""
    creeps, best = find_late_creep(baseline, found), found.leading
    known = propose_creep(baseline, found) if creeps is None else creeps.fit.theta[:N_BASE]
    if known is None:
        return base, baseline, found
    tell("searching again, with friction that creeps")
    creeping = partial(base, known=known)
    begun = _begin_again(creeping, creeps)
    if begun is None:
        return base, baseline, found
    if creeps is None or best is None:
        kept = measure_plain_left(*begun) ** 2 < SEARCH.creep_leaves * measure_plain_left(baseline, found) ** 2
    else:
        is_clear = creeps.fit.cost < SEARCH.clear_creep_cost * best.fit.cost
        kept = is_clear or measure_left(*begun) < measure_left(baseline, found)
    return (creeping, *begun) if kept else (base, baseline, found)


def _search_with_bristle(
    baseline: Baseline, found: SearchResult, base: Callable[..., Baseline], tell: Tell
) -> tuple[Callable[..., Baseline], Baseline, SearchResult]:
    """Search again with friction that holds, where more than noise is left beside friction that creeps; keep it where
    it leaves none, and less torque. Creep draws much of what another curve over speed does, and hides the rest of it;
    by what nulls of its own leave, a base that is far off leaves nothing."""
    if found.leading is None or measure_left(baseline, found) <= SEARCH.something_left:
        return base, baseline, found
    tell("searching again, with friction that holds")
    holding = partial(base, holds=True, known=None)
    begun = _begin_again(holding)
    if begun is None or begun[1].best is None or measure_left(*begun) > SEARCH.something_left:
        return base, baseline, found
    less = measure_plain_left(*begun) < measure_plain_left(baseline, found)
    return (holding, *begun) if less else (base, baseline, found)


def _begin_again(
    base: Callable[..., Baseline], known: Explanation | None = None
) -> tuple[Baseline, SearchResult] | None:
    """The base fitted anew, and what is found from it; None where such a joint runs away without its effects."""
    try:
        other = base()
        return other, search(other, known)
    except (FloatingPointError, np.linalg.LinAlgError):
        return None


def _search_from_joint(
    baseline: Baseline, found: SearchResult, base: Callable[..., Baseline], tell: Tell
) -> tuple[Baseline, SearchResult]:
    """Search again from the joint that was found, as long as it is far from the estimate and leaves less that way."""
    for _ in range(SEARCH.estimates):
        joint = find_far_joint(baseline, found)
        if joint is None:
            break
        tell("searching again, from the joint that was found")
        try:
            nearer = base(start=joint)
        except FloatingPointError:
            break
        again = search(nearer, found.best)
        if again.best is None or measure_left(nearer, again) >= measure_left(baseline, found):
            break
        baseline, found = nearer, again
    return baseline, found

"""Single effects beside the base: the strong ones refitted quickly, the best with care, and from other ends as well."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..effects import EFFECTS, Context
from ..effects.structure import N_BASE, Candidate, Structure
from ..joint.race import Entry, Race
from ..joint.solver import Fit
from .beside_shapes import fit_beside_shapes
from .explanation import Explanation
from .hypotheses import narrow_starts
from .preparation import Baseline
from .refit import compute_preference, fit_from, polish, rebuild, refit
from .screening import Column, Screen, orthonormalise, screen
from .settings import SEARCH
from .simulated_body import N_BODY, hold, move_to


def fit_singles(baseline: Baseline, first: Screen, ready: Sequence[Explanation]) -> list[Explanation]:
    """Fit each strong effect on its own, as long as it may come near what is `ready`: quickly from its best starts, and
    with care where it is among the best. Where none explains most, fit all other effects too, since a base that is bent
    far screens badly."""
    lead = min((one.fit.cost for one in ready), default=np.inf)
    strong, contexts = rank_groups(first, SEARCH.singles), baseline.structure.contexts
    replacing = _select_replacing(baseline, first)
    suspected = [group for group in _group_columns(first) if group[0].candidate.effect.is_suspected(contexts)]
    groups = [*strong, *(group for group in suspected if group not in strong)]
    tried = _refit_groups(baseline, [group for group in groups if group not in replacing], lead)
    tried += fit_with_care(baseline, replacing, baseline)
    if baseline.noise_ratio > SEARCH.bent and not _reaches(SEARCH.most_covered, (*tried, *ready)):
        tried += _refit_groups(baseline, [group for group in _group_columns(first) if group not in groups], lead)
        tried += _fit_from_afar(baseline, min((one.fit.cost for one in tried if not one.refused), default=lead))
    if baseline.noise_ratio > SEARCH.bent_far:
        tried += fit_beside_shapes(baseline)
        tried += _fit_to_the_end(baseline, tried)
    return sorted(tried, key=compute_preference, reverse=True)


def fit_from_simulation(baseline: Baseline, free: Sequence[Explanation]) -> list[Explanation]:
    """Fit the effects that stand out beside the simulation as given, from there, where none from the free base covers.

    The free base bends inertia and gravity into the shape of what is missing, and a fit that starts there may stay:
    a stop at one end has come as another gravity and a ripple.
    """
    if baseline.rigid is None or _reaches(SEARCH.enough, free):
        return []
    box = hold(baseline.box, baseline.rigid)
    start = move_to(box.centre[:N_BODY], baseline.fit.theta, baseline.structure.contexts)
    (given,) = fit_from(baseline, [(baseline.structure, start)], box)
    fit = given.fit
    held = replace(fit, jacobian=fit.jacobian[:, N_BODY:])  # nothing follows where the body is as given
    structure = replace(given.structure, contexts=scan_again(baseline, given.structure.move_contexts(fit.theta), held))
    screened = screen(baseline.problem, structure, fit.theta, fit.residual, fit.jacobian)
    groups = rank_groups(screened, SEARCH.from_simulation)
    wanted = [(replace(structure, candidates=(group[0].candidate,)), fit.theta) for group in groups]
    return fit_from(baseline, wanted, baseline.box)


def select_suspected(at: Baseline | Explanation, screened: Screen) -> list[list[Column]]:
    """Select effects, grouped by name, at which a fitted base points itself: one of its parameters stands at a bound.

    Its own column hides theirs there, however much they would add beyond the bound.
    """
    contexts = at.structure.move_contexts(at.fit.theta)
    return [group for group in _group_columns(screened) if group[0].candidate.effect.is_suspected(contexts)]


def fit_with_care(
    baseline: Baseline, groups: Sequence[Sequence[Column]], at: Baseline | Explanation
) -> list[Explanation]:
    """Fit effects that take over a parameter at its bound in the base, with fresh Jacobians. All else there is bent to
    make up for that bound, and no column of the base is that of the joint without it."""
    beside = at.settled if isinstance(at, Explanation) else ()
    tried = [(*beside, column.candidate) for group in groups for column in group[: SEARCH.hypotheses]]
    theta, contexts = at.fit.theta[:N_BASE], at.structure.contexts
    return fit_from(baseline, [(Structure(contexts, candidates), theta) for candidates in tried], baseline.box)


def rank_groups(screened: Screen, count: int) -> list[list[Column]]:
    """Candidates grouped by effect, strongest effect first, the faintest left out."""
    strongest = screened.columns[0].energy if screened.columns else 0.0
    return [group for group in _group_columns(screened) if group[0].energy > SEARCH.faint_effect * strongest][:count]


def scan_again(baseline: Baseline, contexts: Sequence[Context], fit: Fit) -> tuple[Context, ...]:
    """Scan the starts of effects in what a fit leaves, as far as its columns do not follow."""
    alone = Structure(tuple(contexts))
    starts = narrow_starts(baseline.problem, alone, fit.residual, orthonormalise(fit.jacobian))
    return tuple(replace(context, hints={**context.hints, **starts}) for context in contexts)


def _select_replacing(at: Baseline | Explanation, screened: Screen) -> list[list[Column]]:
    """Select effects, grouped by name, that take the place of parameters which stand at a bound in a fitted base."""
    suspected, contexts = select_suspected(at, screened), at.structure.move_contexts(at.fit.theta)
    alone = [Structure(contexts, (group[0].candidate,)) for group in suspected]
    base = at.fit.theta[:N_BASE]
    added = [one.compute_contributions(np.concatenate([base, one.build_start()])) for one in alone]
    return [group for group, each in zip(suspected, added, strict=True) if any(one.plant for one in each)]


def _fit_to_the_end(baseline: Baseline, tried: Sequence[Explanation]) -> list[Explanation]:
    """Fit the best effects that are physical to their end where the best of them leaves much, however far it has come:
    from a base that is bent far, the quick steps of the right one may hardly have begun."""
    best: dict[tuple[str, ...], Explanation] = {}
    for one in sorted(tried, key=compute_preference, reverse=True):
        if not one.refused:
            best.setdefault(one.names, one)
    first = list(best.values())[: SEARCH.more_careful]
    if first and first[0].left < SEARCH.much_left:
        return []
    wanted = [(rebuild(baseline, one), one.fit.theta[:N_BASE]) for one in first]
    return fit_from(baseline, wanted, [one.box for one in first])


def _fit_from_afar(baseline: Baseline, lead: float) -> list[Explanation]:
    """Fit effects with many minima from starts far from each other, as long as they may come near the cost `lead`."""
    contexts, theta = baseline.structure.contexts, baseline.fit.theta
    starts = [(name, start) for name, effect in EFFECTS.items() for start in effect.propose_far_starts(contexts)]
    wanted = [(Structure(contexts, (Candidate(name, tuple(start.items())),)), theta) for name, start in starts]
    return fit_from(baseline, wanted, baseline.box, entry=Entry(Race(baseline.fit.cost, lead), hurried=True))


def _refit_groups(baseline: Baseline, groups: Sequence[Sequence[Column]], lead: float) -> list[Explanation]:
    """Refit the best starts of each effect that may come near the cost `lead`, and the best effects with care.

    Where its best starts lead to none that is physical, its next ones are refitted as well: a drive that falls short
    looks cut off at a limit, and from there becomes one that gives more than was recorded.
    """
    quick = _refit_starts(baseline, groups, 0, lead)
    astray = [group for group, best in quick if best.refused]
    quick += _refit_starts(baseline, astray, SEARCH.hypotheses, lead)
    ranked = sorted((best for _, best in quick), key=compute_preference, reverse=True)
    careful = polish(baseline, ranked[: SEARCH.careful], lead=lead)
    if not _reaches(SEARCH.enough, careful):
        careful += polish(baseline, ranked[SEARCH.careful : SEARCH.more_careful], lead=lead)
    return careful + ranked[len(careful) :]


def _reaches(coverage: float, explanations: Sequence[Explanation]) -> bool:
    """Whether one of the explanations covers that much, with numbers that it can have: others explain nothing."""
    return any(not one.refused and one.coverage >= coverage for one in explanations)


def _refit_starts(
    baseline: Baseline, groups: Sequence[Sequence[Column]], first: int, lead: float
) -> list[tuple[Sequence[Column], Explanation]]:
    """Refit starts of each effect, from its `first` on; each effect that has such with the best of them."""
    options = [(group, _select_options(baseline, group, first)) for group in groups]
    wanted = [((column.candidate,), baseline) for _, part in options for column in part]
    trials = iter(refit(baseline, wanted, lead))
    return [(group, max((next(trials) for _ in part), key=compute_preference)) for group, part in options if part]


def _select_options(baseline: Baseline, group: Sequence[Column], first: int) -> Sequence[Column]:
    """The hypotheses of one effect, from its `first` on, that are worth a refit."""
    chosen = group[first : first + SEARCH.hypotheses]
    if group[0].candidate.effect.is_suspected(baseline.structure.contexts):
        return chosen
    least = max(0.3 * group[0].energy, float(np.log(baseline.fit.residual.size)))
    return [column for column in chosen if column.energy > least]


def _group_columns(screened: Screen) -> list[list[Column]]:
    """Candidates grouped by effect, strongest effect first."""
    groups: dict[str, list[Column]] = {}
    for column in screened.columns:
        groups.setdefault(column.candidate.name, []).append(column)
    return list(groups.values())

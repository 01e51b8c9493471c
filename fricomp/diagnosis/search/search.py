"""The search: single effects and pairs screened at once, the best refitted jointly, a third on top of the best pair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np

from ..effects.identity import find_twin
from ..effects.structure import N_BASE, Candidate, Structure
from ..inputs.track import FloatArray
from ..joint.base import BASE_NAMES
from .choice import choose, rank_acceptable, select_finalists
from .explanation import Explanation, compute_spread_excess, curb
from .overtones import fit_overtones
from .preparation import Baseline
from .refit import fit_from, polish, rebuild, refit
from .screening import Column, Screen, orthonormalise, project_out, screen
from .settings import SEARCH
from .siblings import fit_siblings
from .singles import fit_from_simulation, fit_singles, fit_with_care, rank_groups, scan_again, select_suspected
from .straightened import fit_straightened


@dataclass(frozen=True)
class SearchResult:
    """What the search found.

    Attributes:
        explanations: All that were refitted, best first, refused ones too.
        best: The best accepted one; None where nothing stands out.
        threshold: Gain that an effect must exceed.
        explainable: Energy that a generic basis explains of the base's residual beyond chance, no row counting for
            more than a few.
        explainable_null: The largest such energy over the nulls, at the same quantile as the threshold.
        first: Screening about the base model.
    """

    explanations: tuple[Explanation, ...]
    best: Explanation | None
    threshold: float
    explainable: float
    explainable_null: float
    first: Screen

    @property
    def leading(self) -> Explanation | None:
        """The best accepted explanation, else the one that gains most; None where none was refitted."""
        return self.best or next(iter(self.explanations), None)


def search(baseline: Baseline, known: Explanation | None = None) -> SearchResult:
    """Find the effects that explain the residual of the base.

    Args:
        baseline: The base fitted to the recordings.
        known: What was found with another base or other weights, to go on from as well; from a base that is bent far a
            fit may not come there again.
    """
    fit = baseline.fit
    first = screen(baseline.problem, baseline.structure, fit.theta, fit.residual, fit.jacobian)
    threshold = max(SEARCH.least_gain, SEARCH.material_gain * fit.residual.size, _compute_null_gain(baseline, first))
    span = orthonormalise(project_out(baseline.generic, baseline.basis), 1e-4)
    explainable = compute_spread_excess(span, fit.residual)
    null = float(np.quantile([compute_spread_excess(span, v) for v in baseline.null_residuals], SEARCH.null_quantile))
    ready = [] if known is None else _fit_known(baseline, known)
    free = fit_singles(baseline, first, ready)
    tried = ready + free + fit_from_simulation(baseline, free)
    tried += fit_overtones(baseline, rank_acceptable(tried, threshold)[: SEARCH.careful], threshold)
    accepted = rank_acceptable(tried, threshold)
    if accepted:
        tried += _grow(baseline, tried, accepted[:1], threshold, first)
        if all(one is not accepted[0] for one in free):  # what lies beside it may show from the free base alone
            tried += _grow(baseline, tried, rank_acceptable(free, threshold)[:1], threshold, first)
        tried += _grow(baseline, tried, _select_own(accepted), threshold)
        tried += _grow(baseline, tried, _select_partners(tried, accepted[0], threshold), threshold)
        tried += _grow(baseline, tried, _rank_pairs(tried, threshold)[:1], threshold)
        tried += _swap_pairs(baseline, tried, threshold)
    best = choose(baseline, tried, threshold)
    if best is not None:
        tried += fit_overtones(baseline, [best], threshold)
        best = choose(baseline, tried, threshold) or best
        close = select_finalists(best, rank_acceptable(tried, threshold))
        close += _fit_twins(baseline, best) + fit_straightened(baseline, best)
        finished = polish(baseline, close, iterations=SEARCH.last_steps, refresh=2)
        tried = finished + [explanation for explanation in tried if explanation not in close]
        parted: list[Explanation] = []
        while wholes := _select_wholes(tried, choose(baseline, tried, threshold), threshold, parted):
            parted += wholes
            for whole in wholes:  # what is chosen then may be a part, with parts of its own
                tried += _fit_parts(baseline, whole, range(max(1, len(whole.names) - 1), len(whole.names)))
        best = choose(baseline, tried, threshold)
        if best is not None:
            tried += fit_siblings(baseline, best)
            best = choose(baseline, tried, threshold)
        if best is not None and _list_idle(baseline, best):
            tried += _fit_without_idle(baseline, select_finalists(best, rank_acceptable(tried, threshold)))
            best = choose(baseline, tried, threshold)
    tried.sort(key=lambda explanation: -explanation.gain)
    return SearchResult(tuple(tried), best, threshold, explainable, null, first)


def _fit_known(baseline: Baseline, known: Explanation) -> list[Explanation]:
    """Fit what is known from where it was, and its parts: another base may have asked for the rest."""
    (whole,) = fit_from(baseline, [(rebuild(baseline, known), known.fit.theta[:N_BASE])], baseline.box)
    return [whole, *_fit_parts(baseline, whole, range(1, len(whole.names)))]


def _select_own(accepted: Sequence[Explanation]) -> list[Explanation]:
    """Select the best explanation without an effect that imitates others, where one with it comes first.

    Pushes in stretches of time that were chosen by what is left take what a law would explain with another effect
    beside it, as a stop that is met now and then.
    """
    own = [e for e in accepted if not any(one.effect.imitates_others for one in e.settled)]
    return [] if own and own[0] is accepted[0] else own[:1]


def _select_partners(tried: Sequence[Explanation], seed: Explanation, threshold: float) -> list[Explanation]:
    """Select the other effects of the best pair, alone. Beside them its partner may have another form, or be another
    effect."""
    pairs = _rank_pairs(tried, threshold)
    others = set(pairs[0].names) - set(seed.names) if pairs else set()
    return [e for e in tried if len(e.names) == 1 and others.issuperset(e.names)]


def _rank_pairs(tried: Sequence[Explanation], threshold: float) -> list[Explanation]:
    return [e for e in rank_acceptable(tried, threshold) if len(e.names) == 2]


def _swap_pairs(baseline: Baseline, tried: Sequence[Explanation], threshold: float) -> list[Explanation]:
    """Fit the best triple's third effect on other pairs, of those that explain nearly as much as its own."""
    pairs, triples = _rank_pairs(tried, threshold), [e for e in rank_acceptable(tried, threshold) if len(e.names) == 3]
    own = [pair for pair in pairs if triples and set(pair.names) < set(triples[0].names)]
    if not own:
        return []
    third = tuple(c for c in triples[0].settled if c.name not in own[0].names)
    others = [
        p
        for p in select_finalists(own[0], pairs)[1:]
        if len({*p.names, *triples[0].names}) == 4 and third[0].name not in p.names
    ]
    return refit(baseline, [((*pair.settled, *third), pair) for pair in others])


def _select_wholes(
    tried: Sequence[Explanation], best: Explanation | None, threshold: float, parted: Sequence[Explanation]
) -> list[Explanation]:
    """Select what was chosen, and the explanation that leaves least where that is far less: an effect that it lacks may
    have led it there. Those that were parted are not selected again."""
    if best is None:
        return []
    top = rank_acceptable(tried, threshold)[0]
    wholes = [best, top] if top.gain > best.gain + SEARCH.clearly_better * threshold else [best]
    return [one for one in wholes if all(one is not whole for whole in parted)]


def _fit_twins(baseline: Baseline, best: Explanation) -> list[Explanation]:
    """Fit the same torque by the effect that comes first where no simulation says inertia and gravity: the search may
    have met its other name alone."""
    twin = find_twin(best.values, baseline.structure.contexts[0].usual_load)
    if twin is None or baseline.rigid is not None:
        return []
    same = Candidate(twin.identity.one, tuple(twin.values.items()))
    candidates = tuple(same if c.name == twin.identity.other else c for c in best.settled)
    theta = best.fit.theta[:N_BASE].copy()
    theta[[BASE_NAMES.index("gravity_cos"), BASE_NAMES.index("gravity_sin")]] *= twin.gravity
    contexts = Structure(best.structure.contexts).move_contexts(theta)
    return fit_from(baseline, [(Structure(contexts, candidates), theta)], baseline.box)


def _fit_parts(baseline: Baseline, best: Explanation, sizes: Sequence[int]) -> list[Explanation]:
    """Fit the parts of an explanation that have these numbers of effects, from where it ended, under the load of its
    joint. Alone, a part may not have got that far."""
    if not sizes or best.coverage < SEARCH.nameable:
        return []
    whole, theta = rebuild(baseline, best), best.fit.theta[:N_BASE]
    kept = [part for size in sizes for part in combinations(whole.candidates, size)]
    return fit_from(baseline, [(replace(whole, candidates=candidates), theta) for candidates in kept], baseline.box)


def _list_idle(baseline: Baseline, one: Explanation) -> tuple[str, ...]:
    """List those of its effects that do nothing, such as a lag of no length. They only led the others to their
    minimum."""
    if len(one.names) == 1:
        return ()
    added = {name: one.structure.compute_added(baseline.problem, one.fit.theta, [name]) for name in one.names}
    return tuple(name for name, torque in added.items() if float(np.max(np.abs(torque))) < SEARCH.idle)


def _fit_without_idle(baseline: Baseline, close: Sequence[Explanation]) -> list[Explanation]:
    """Fit explanations without those of their effects that do nothing, once for each set of effects that is left: from
    the minimum of the best of them, which is theirs as well."""
    wanted: dict[tuple[str, ...], tuple[Structure, FloatArray]] = {}
    for one in close:
        idle = _list_idle(baseline, one)
        kept = tuple(candidate for candidate in one.settled if candidate.name not in idle)
        names = tuple(candidate.name for candidate in kept)
        if idle and kept and names not in wanted:
            wanted[names] = Structure(one.structure.contexts, kept), one.fit.theta[:N_BASE]
    return fit_from(baseline, list(wanted.values()), baseline.box)


def _compute_null_gain(baseline: Baseline, screened: Screen) -> float:
    """Compute the largest BIC gain of any effect on a null, at the quantile that fixes the rate of false alarms.

    No row counts for more than a few, as in what is compared with it.
    """
    rows = np.log(baseline.fit.residual.size)
    gains = [
        max(
            float(np.sum((column.span.T @ vector) ** 2)) - _count_freedom(baseline, column) * float(rows)
            for column in screened.columns
        )
        for vector in (curb(null) for null in baseline.null_residuals)
    ]
    return float(np.quantile(gains, SEARCH.null_quantile))


def _count_freedom(baseline: Baseline, column: Column) -> int:
    return Structure(baseline.structure.contexts, (column.candidate,)).freedom


def _grow(
    baseline: Baseline,
    tried: Sequence[Explanation],
    seeds: Sequence[Explanation],
    threshold: float,
    first: Screen | None = None,
) -> list[Explanation]:
    """Put one more effect on top of each seed, found by screening about the seed's own minimum, and try the pairs that
    `first` scores highest. Where a seed covers about all that a generic basis sees, try only effects that stand out,
    and those at a bound of its base that were not tried."""
    known = {explanation.names for explanation in tried}
    grown: list[Explanation] = []
    wanted: list[tuple[tuple[Candidate, ...], Baseline | Explanation]] = []
    seen: set[tuple[str, ...]] = set()
    for seed in (_renew_starts(baseline, seed) for seed in seeds):
        screened = screen(baseline.problem, seed.structure, seed.fit.theta, seed.fit.residual, seed.fit.jacobian)
        suspected = [g for g in select_suspected(seed, screened) if _join_names(seed, g) not in known | seen]
        grown += fit_with_care(baseline, suspected, seed)
        seen |= {_join_names(seed, group) for group in suspected}
        for columns in rank_groups(screened, SEARCH.partners):
            names = _join_names(seed, columns)
            if names in seen or (seed.coverage > SEARCH.enough and columns[0].energy < SEARCH.stands_out * threshold):
                continue
            seen.add(names)
            alike = [
                c.candidate for c in columns[: SEARCH.hypotheses] if c.energy > SEARCH.alike_start * columns[0].energy
            ]
            wanted += [((*seed.settled, candidate), seed) for candidate in alike]
    unfinished = any(seed.coverage <= SEARCH.enough for seed in seeds)
    for pair in first.select_pairs(baseline.fit.residual, SEARCH.partners) if first is not None and unfinished else ():
        names = tuple(sorted(c.name for c in pair))
        if names not in seen:
            seen.add(names)
            wanted.append((pair, baseline))
    return grown + refit(baseline, wanted)


def _renew_starts(baseline: Baseline, seed: Explanation) -> Explanation:
    """Scan the starts of effects again in what the seed leaves, where it explains most and leaves much.

    Those that stand out of what the base leaves are of the seed then, as with a gap beside a stop.
    """
    if seed.left < SEARCH.much_left or seed.coverage < SEARCH.most_covered:
        return seed
    contexts = scan_again(baseline, seed.structure.contexts, seed.fit)
    return replace(seed, structure=replace(seed.structure, contexts=contexts))


def _join_names(seed: Explanation, group: Sequence[Column]) -> tuple[str, ...]:
    return tuple(sorted((*seed.names, group[0].candidate.name)))

"""Whether an explanation that leaves the given simulation as it is fits as well as one that moves its parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import islice, product

import numpy as np

from ..effects import EFFECTS, Context
from ..effects.structure import N_BASE, Candidate, Structure
from ..inputs.rigid import RigidJoint
from ..search.explanation import Explanation, compute_evidence
from ..search.preparation import Baseline
from ..search.refit import compute_preference, fit_from, polish
from ..search.search import SearchResult
from ..search.settings import SEARCH
from ..search.simulated_body import hold, move_to
from .alias import is_as_good, list_alternatives, list_printed_rivals
from .comparison import AGREES, NAMED, Tolerances
from .settings import AGREEMENT, ALIASES

_BENT = "needs another inertia or gravity than the simulation's"


def prefer_agreeing(
    baseline: Baseline,
    found: SearchResult,
    rigid: RigidJoint | None,
    differs: Callable[[Explanation, Tolerances], bool],
) -> SearchResult:
    """What was found, with a best explanation that agrees with the simulation where one fits as well.

    Friction that differs between driving and braking, for example, looks like friction under load and another gravity;
    a spring that stiffens like a straight one and another gravity. They look so on every motion: beside one that
    agrees, others stay in question only as far as they fit with the simulation's parameters too. But a simulation may
    be wrong as well as incomplete: where the best explanation leaves next to nothing, its form is right, and one that
    agrees with the simulation must fit nearly as well.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        found: What the search found.
        rigid: Inertia and gravity of the simulation; None where none was given.
        differs: Whether an explanation moves parameters of the simulation by more than their error, within tolerances.
    """
    best = found.best
    if best is None:
        return found
    if differs(best, AGREES) or _is_improbable(best):
        most = max(ALIASES.close, AGREEMENT.hides * best.left, found.explainable_null)

        def fits(one: Explanation) -> bool:
            explains = not one.refused and one.gain > AGREEMENT.least * best.gain
            return explains and _measure_lack(baseline, one, best) < most

        options = [one for one in list_alternatives(found) if fits(one)]
        if rigid is not None and rigid.rotary:
            held = _fit_held(baseline, _list_near(found, best), rigid)
            agrees = any(fits(one) and not differs(one, AGREES) for one in held)
            held = _finish(baseline, held, best, 1 if agrees else AGREEMENT.most_near)
            options += [one for one in held if fits(one)]
        kept = _keep_agreeing(best, sorted(options, key=lambda explanation: -explanation.gain), differs)
        if not kept:
            return found
        others = tuple(e for e in found.explanations if e is not kept[0])
        found = replace(found, best=kept[0], explanations=(kept[0], *others))
    return found if rigid is None or not rigid.rotary else _straighten_rivals(baseline, found, rigid, differs)


def _is_improbable(one: Explanation) -> bool:
    """Whether inertia and gravity lie further from the simulation than its stated error allows. Where the recording
    hardly shows them beside the effects, they differ by nothing that it proves."""
    away = (one.fit.theta[:3] - one.box.centre[:3])[:, None]
    return float((away.T @ one.box.precision[:3, :3] @ away).item()) > AGREEMENT.improbable


def _measure_lack(baseline: Baseline, one: Explanation, best: Explanation) -> float:
    """Evidence that the best explanation has over another one; about rest both hang on the law of the bristle."""
    further_numbers = (best.gain + best.fit.cost) - (one.gain + one.fit.cost)  # what they cost in the gain
    return compute_evidence(baseline, {*one.names, *best.names}, one.fit, best.fit) + further_numbers


def _finish(baseline: Baseline, held: Sequence[Explanation], best: Explanation, number: int) -> list[Explanation]:
    """The same, the first of them at its minimum, and others too that come near `best`, up to `number` in all.

    From its parameters to the simulation's gravity a narrow valley of offset, gravity and friction bends, which a fit
    with one Jacobian does not follow to its end.
    """
    order = sorted(held, key=compute_preference, reverse=True)
    far = [one.refused != "" or one.gain <= AGREEMENT.near * best.gain for one in order]
    ends = [one for i, one in enumerate(order[:number]) if i == 0 or not far[i]]
    rest = [one for one in order if all(one is not each for each in ends)]
    return [*polish(baseline, ends, iterations=SEARCH.last_steps), *rest] if ends else rest


def _keep_agreeing(
    best: Explanation, options: Sequence[Explanation], differs: Callable[[Explanation, Tolerances], bool]
) -> list[Explanation]:
    """The options that leave the simulation as it is, or as nearly as a law of another form can, where it can."""
    plain = [one for one in options if not differs(one, AGREES)]
    return plain if plain or not differs(best, NAMED) else [one for one in options if not differs(one, NAMED)]


def _straighten_rivals(
    baseline: Baseline, found: SearchResult, rigid: RigidJoint, differs: Callable[[Explanation, Tolerances], bool]
) -> SearchResult:
    """What was found, each rival that moves the simulation as it fits with the simulation's parameters, or refused."""
    best = found.best
    bent = [rival for rival in list_printed_rivals(found) if differs(rival, AGREES)]
    if best is None or not bent:
        return found
    straight: dict[tuple[str, ...], Explanation] = {}
    for one in _fit_held(baseline, list({rival.names: rival for rival in bent}.values()), rigid):
        if not one.refused and is_as_good(one, best) and not differs(one, AGREES):
            straight[one.names] = max(one, straight.get(one.names, one), key=lambda e: e.gain)
    rest = [replace(e, refused=_BENT) if e in bent else e for e in found.explanations if e is not best]
    rest = sorted([*rest, *straight.values()], key=lambda e: -e.gain)
    return replace(found, explanations=(best, *rest))


def _list_near(found: SearchResult, best: Explanation) -> list[Explanation]:
    """The best explanation and others that come near it, of each set of effects the best one."""
    near = {best.names: best}
    for rival in found.explanations:
        if len(rival.names) == len(best.names) and rival.gain > AGREEMENT.near * best.gain:
            near.setdefault(rival.names, rival)
    return list(near.values())[: AGREEMENT.most_near]


def _fit_held(baseline: Baseline, near: Sequence[Explanation], rigid: RigidJoint) -> list[Explanation]:
    """The effects of each explanation in all their forms, with inertia and gravity held at those of the simulation."""
    box = hold(baseline.box, rigid)
    wanted = []
    for one in near:
        theta = move_to(box.centre[:3], one.fit.theta[:N_BASE], one.structure.contexts)
        contexts = one.structure.move_contexts(np.concatenate([theta, one.fit.theta[N_BASE:]]))
        settled = sorted(one.settled_structure.move_to(contexts).candidates, key=lambda candidate: candidate.name)
        forms = [[candidate, *_list_other_forms(one.structure.contexts, candidate.name)] for candidate in settled]
        starts = islice(_order_choices([len(each) for each in forms]), AGREEMENT.most_starts)
        chosen = (tuple(each[i] for each, i in zip(forms, choice, strict=True)) for choice in starts)
        wanted += [(Structure(contexts, candidates), theta) for candidates in chosen]
    return fit_from(baseline, wanted, box)


def _order_choices(counts: Sequence[int]) -> list[tuple[int, ...]]:
    """One of each, as indices: first those in which few differ from the first one, and first by the first of others."""
    choices = product(*(range(count) for count in counts))
    return sorted(choices, key=lambda choice: (sum(i > 0 for i in choice), max(choice, default=0)))


def _list_other_forms(contexts: Sequence[Context], name: str) -> list[Candidate]:
    starts = EFFECTS[name].propose_other_starts(contexts)
    return [Candidate(name, tuple(start.items())) for start in starts if any(start.values())]

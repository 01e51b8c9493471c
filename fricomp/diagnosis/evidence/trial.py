"""The trial of the best explanation: what it covers, what held-out data say, what each name needs, and if it stays."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from ..effects import EFFECTS
from ..search.choice import choose, rank_acceptable
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.search import SearchResult
from .alias import list_aliases
from .confirmation import Confirmation, confirm
from .foretelling import list_local_ripples
from .gates import covers, is_confirmed, is_trifling
from .needs import find_one_way, list_objections
from .refitted import RefittedJoint
from .repetition import Repetitions, repeat_choice
from .settings import GATES, NEEDS

_UNFIT = "its own numbers speak against one of these effects"


@dataclass(frozen=True)
class Trial:
    """The best explanation on held-out data.

    Attributes:
        repetitions: What was chosen on parts of the rows.
        chosen: It; None where there is none that covers the mismatch and has what a name needs.
        failed: It, where it covers the mismatch and still is not named; else None.
        held: Held-out errors with what was chosen; None where nothing was.
        objections: What speaks against names that are not given, by name.
        unfit: Those of them against which their own numbers speak.
        immaterial: Whether it covers the mismatch, of which the plain held-out error shows nothing that matters.
    """

    repetitions: Repetitions = field(default_factory=lambda: Repetitions(0))
    chosen: Explanation | None = None
    failed: Explanation | None = None
    held: Confirmation | None = None
    objections: Mapping[str, str] = field(default_factory=dict)
    unfit: frozenset[str] = frozenset()
    immaterial: bool = False


def put_to_trial(baseline: Baseline, found: SearchResult, seed: int) -> Trial:
    """Confirm the best explanation, where it covers the mismatch and is what its names say: no one part that ripples
    torque and friction, no other curve over speed.

    Where some of its effects lack what a name needs, the others are tried without them. What only completes the form
    of the friction goes first: beside it, numbers of the others are less well determined. It comes back where what is
    left in the end does not cover the mismatch without it.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        found: Explanations, best first.
        seed: Of the bootstrap.
    """
    repetitions, best = repeat_choice(baseline, found), found.best
    tried, objections, forms, unfit = best, dict[str, str](), dict[str, str](), frozenset[str]()
    while True:
        if tried is None or not covers(tried, found, baseline):
            if not forms:
                break
            tried, forms = _find_rest(found, {*(() if tried is None else tried.names), *forms}), {}
            continue
        if tried.common_order is not None or tried.foreign_curve:
            break
        if more := _find_forms(baseline, found, tried):
            forms |= more
            tried = _find_rest(found, set(tried.names) - set(more))
            continue
        held = confirm(baseline, tried.structure, tried.fit, seed, given=tried.before)
        if not is_confirmed(held, tried, found.threshold, baseline.measure_loudness(tried.fit)):
            return Trial(repetitions, failed=tried, objections=objections | forms, unfit=unfit)
        own = list_objections(RefittedJoint.refit(baseline, tried), _find_shown(found, tried))
        own |= list_local_ripples(baseline, tried)
        against = own | _list_objections(baseline, found, tried, held, repetitions)
        if not against:
            return Trial(repetitions, tried, held=held, objections=objections | forms)
        objections |= against
        if held.plain.explained < NEEDS.trace or is_trifling(held, tried, baseline):
            return Trial(repetitions, failed=tried, objections=objections | forms, immaterial=True)
        unfit |= own.keys()
        tried = _find_rest(found, set(tried.names) - set(against))
    return Trial(repetitions, failed=best if objections or forms else None, objections=objections | forms, unfit=unfit)


def leave_out_unfit(baseline: Baseline, found: SearchResult, trial: Trial) -> SearchResult | None:
    """What was found without effects against which their own numbers speak; None where nothing is chosen then.

    Such an effect, as a stop that may have no stiffness, explains nothing, and another one may stand behind it.
    """
    if trial.chosen is not None or not trial.unfit:
        return None
    rest = [one for one in found.explanations if not trial.unfit & set(one.names)]
    best = choose(baseline, rest, found.threshold)
    out = [replace(one, refused=one.refused or _UNFIT) for one in found.explanations if trial.unfit & set(one.names)]
    return None if best is None else replace(found, explanations=(*rest, *out), best=best)


def _find_shown(found: SearchResult, tried: Explanation) -> frozenset[str]:
    """Effects without which, all others fitted anew, overwhelmingly less is explained."""
    least = GATES.overwhelming * found.threshold
    return frozenset(name for name, gain in _measure_without(found, tried).items() if tried.certain - gain > least)


def _measure_without(found: SearchResult, tried: Explanation) -> dict[str, float]:
    """Largest certain gain of exactly the others, by effect, whatever speaks against them, where they were fitted."""
    gains = {frozenset[str](): 0.0}
    for one in found.explanations:
        names = frozenset(one.names)
        gains[names] = max(one.certain, gains.get(names, -np.inf))
    without = {name: frozenset(tried.names) - {name} for name in tried.names}
    return {name: gains[others] for name, others in without.items() if others in gains}


def _list_objections(
    baseline: Baseline, found: SearchResult, tried: Explanation, held: Confirmation, repetitions: Repetitions
) -> dict[str, str]:
    """Say for each name what speaks against it besides its own numbers; nothing for those that lack nothing."""
    if is_trifling(held, tried, baseline):
        return dict.fromkeys(tried.names, f"it takes away less than {GATES.trifle:.1%} of the Coulomb torque")
    if held.plain.explained < NEEDS.plain:
        part = f"{max(held.plain.explained, 0.0):.0%} of the plain held-out error above the noise"
        return dict.fromkeys(tried.names, f"it takes away {part}, less than {NEEDS.plain:.0%}")
    found_against = find_one_way(tried.names, [one.velocity for one in baseline.structure.contexts])
    for name in tried.names:
        share = repetitions.compute_share_of_any((name, *list_aliases(found, name)))
        if share < NEEDS.share and name not in found_against:
            found_against[name] = f"it comes again in {share:.0%} of the repetitions, less than {NEEDS.share:.0%}"
    return found_against | _find_dwarfed(found, tried)


def _find_dwarfed(found: SearchResult, tried: Explanation) -> dict[str, str]:
    """Effects that add less than the law of the others holds to: a stop of 400 times the noise leaves something of any
    form."""
    least = (1.0 - NEEDS.dwarfed**2) * tried.certain
    said = f"it takes away less than {NEEDS.dwarfed:.0%} of what the others do, as much as their own form may leave"
    return {name: said for name, gain in _measure_without(found, tried).items() if gain > least}


def _find_forms(baseline: Baseline, found: SearchResult, tried: Explanation) -> dict[str, str]:
    """Effects that are the form of the joint's own friction, or cannot be told from that, beside others that cover the
    mismatch without them."""
    alike = {name: (name, *list_aliases(found, name)) for name in tried.names}
    forms = {name for name, ones in alike.items() if any(EFFECTS[one].form_of_friction for one in ones)}
    rest = _find_rest(found, set(tried.names) - forms) if forms else None
    if rest is None or not covers(rest, found, baseline):
        return {}
    said = f"it only completes the form of the friction beside {' and '.join(rest.names)}, which covers the mismatch"
    return dict.fromkeys(forms, said)


def _find_rest(found: SearchResult, names: set[str]) -> Explanation | None:
    """The best explanation with exactly these effects; None where it does not stand out, or nothing is left."""
    same = [one for one in rank_acceptable(found.explanations, found.threshold) if set(one.names) == names]
    return same[0] if same else None

"""Effects of one kind in place of each other, from the joint that one of them has led to."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ..effects import EFFECTS, Context
from ..effects.structure import N_BASE, Candidate, Structure
from ..joint.race import Entry, Race
from ..joint.solver import is_beaten
from .explanation import Explanation
from .preparation import Baseline
from .refit import fit_from, polish, rebuild
from .settings import SEARCH


def fit_siblings(baseline: Baseline, best: Explanation) -> list[Explanation]:
    """Fit each other law of friction under load, and each other ripple at the order that was found, in place of that of
    the best explanation, such a law beside it or in place of its waves of friction, and each other form of its effects,
    with the rest of it and without.

    A base without such friction has another gravity, and with it another load, and one without a strong ripple is bent
    far: from there one law may get no further than to another minimum, however well it would explain the joint that
    another one has led to. So may a form, and another effect then takes what it lacks.
    """
    whole, theta = rebuild(baseline, best), best.fit.theta[:N_BASE]
    wanted, freed = _list_loads(whole) + _list_ripples(whole) + _list_forms(whole), _list_unwaved(whole)
    if not wanted + freed:
        return []
    race = Race(baseline.fit.cost, best.fit.cost)
    starts = [[(replace(whole, candidates=one), theta) for one in part] for part in (wanted, freed)]
    fitted = fit_from(baseline, starts[0], best.box, entry=Entry(race)) + fit_from(baseline, starts[1], best.box)
    near = [one for one in fitted if not is_beaten(one.fit, one.box.join(one.structure.build_box()), race)]
    rest = [one for one in fitted if one not in near]
    return polish(baseline, near, iterations=SEARCH.last_steps, lead=best.fit.cost) + rest


def _list_loads(best: Structure) -> list[tuple[Candidate, ...]]:
    """Other laws of friction under load, in place of the best one's and beside it."""
    rest = tuple(one for one in best.candidates if not one.effect.follows_load)
    if len(rest) == len(best.candidates):
        return []
    others = [name for name, effect in EFFECTS.items() if effect.follows_load and name not in best.names]
    return [(*kept, _start(name, best.contexts)) for name in others for kept in (rest, best.candidates)]


def _list_unwaved(best: Structure) -> list[tuple[Candidate, ...]]:
    """Laws of friction under load in place of friction that waves.

    Under one load both follow the angle. The wave bends offset and gravity until no column shows the load, and a fit of
    its law has so long a way from there that it seems lost at first.
    """
    rest = tuple(one for one in best.candidates if one.effect.wave != "friction")
    laws = [name for name, effect in EFFECTS.items() if effect.follows_load and name not in best.names]
    return [(*rest, _start(name, best.contexts)) for name in laws] if len(rest) < len(best.candidates) else []


def _list_ripples(best: Structure) -> list[tuple[Candidate, ...]]:
    """Other ripples in place of each of the best one's, at its order."""
    kind = {name for name, effect in EFFECTS.items() if effect.ripple and not effect.misreads_position}
    others = [name for name in EFFECTS if name in kind and name not in best.names]
    wanted = []
    for own in (one for one in best.candidates if one.name in kind):
        rest, order = tuple(one for one in best.candidates if one.name != own.name), dict(own.values)["order"]
        wanted += [(*rest, _start(name, best.contexts).at_order(order)) for name in others]
    return wanted


def _list_forms(best: Structure) -> list[tuple[Candidate, ...]]:
    """Each effect in its other forms, by what its starts hold fixed, from its values: beside the rest, and alone."""
    wanted = []
    for own in best.candidates:
        fixed = [one.name for one in own.list_parameters(best.contexts) if one.scale == 0.0]
        values, rest = dict(own.values), tuple(one for one in best.candidates if one.name != own.name)
        starts = own.effect.propose_starts(best.contexts) if fixed else []
        forms = {tuple(start[name] for name in fixed) for start in starts if all(name in start for name in fixed)}
        for form in sorted(forms - {tuple(values[name] for name in fixed)}):
            other = Candidate(own.name, tuple((values | dict(zip(fixed, form, strict=True))).items()))
            wanted += [(*kept, other) for kept in sorted({rest, ()}, key=len)]
    return wanted


def _start(name: str, contexts: Sequence[Context]) -> Candidate:
    """An effect at the first of its usual starts, or where it has none, with its usual values."""
    return Candidate(name, tuple(next(iter(EFFECTS[name].propose_starts(contexts)), {}).items()))

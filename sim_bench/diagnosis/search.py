"""The search: single effects and pairs screened at once, the best refitted jointly, a third on top of the best pair."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .effects import EFFECTS
from .preparation import Prepared
from .screening import Column, Screen, orthonormal, project_out, screen
from .solver import Box, Descent, Fit
from .structure import N_BASE, Candidate, Structure, fit_all
from .track import FloatArray

__all__ = ["Explanation", "Found", "fit_from", "search"]

_SINGLES = 8  # effects refitted on their own
_FAINT = 0.03  # of the strongest effect's energy: weaker ones are not refitted
_CAREFUL = 3  # of them refined with fresh Jacobians
_MORE_CAREFUL = 6  # of them where none of those explains enough
_PARTNERS = 4  # partners tried for each explanation that is grown
_ALIKE = 0.9  # of the energy of a partner's best hypothesis, from which its next one is tried as well
_ENOUGH = 0.98  # coverage at which nothing more is looked for
# Residual over noise, and coverage, from and to which effects that screened badly are refitted as well.
_BENT, _MOST = 1.2, 0.85
_QUANTILE = 0.98
_LEAST_GAIN = 30.0
_ANOTHER = 0.08  # of the gain, that one more effect must add: less is the form of the first one not quite met
_MUCH, _REMNANT = 3.0, 0.3  # thresholds of gain, and part of what is left, of effects that complete an explanation
_OVERWHELMING = 10.0  # thresholds from which they count wherever they show; a bristle has been seen to bring 7
# What of its gain an explanation counts for that would fill in for others: pushes in windows of time for anything that
# comes and goes, a friction wave of any order for friction under a load that follows the position.
_FILLS_IN = {"external_disturbance": 0.8, "position_coulomb": 0.98}
_LAST_STEPS = 12  # of the explanation that was chosen and of rivals close to it
_NEAR, _FINALISTS = 0.1, 2  # of its gain that a rival may lack, and how many of them there are
_MOST_OF_A_ROW = 9.0  # gain that one row may add to what counts against the threshold
_FAIR = 0.5  # of what an effect of sliding would explain in the rows that slide, were it spread evenly, that it must
_LOUD_ABOUT_REST = 0.6  # gain per row there; the form of the bristle has been seen to leave 0.3 of nothing missing
_BRISTLE = 0.3  # such energy per row there, that is not held against an explanation
# Gain per row of all, and coverage, of an explanation that counts wherever it shows: nulls reach 0.04 and 0.7.
_PLAIN, _PLAINLY_COVERED = 0.08, 0.85
_MATERIAL = 0.01  # gain per row: below it the base model's own small errors could be named


@dataclass(frozen=True, eq=False)
class Explanation:
    """A structure fitted jointly.

    Attributes:
        structure: Base and effects.
        fit: The minimum.
        gain: Fall of the cost from the base, less the BIC penalty.
        certain: The same from rows that can show the effects, none counting for more than a few: rows about rest hang
            on a bristle that no model has quite right, and a handful of rows decides nothing.
        coverage: Part of the explainable energy that it covers.
        left: Energy that a generic basis explains of what it leaves, beyond chance.
        refused: Why it is not physical; empty where it is.
    """

    structure: Structure
    fit: Fit
    gain: float
    certain: float
    coverage: float
    left: float = 0.0
    refused: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its effects, sorted."""
        return self.structure.names

    @property
    def settled(self) -> tuple[Candidate, ...]:
        """Its effects, starting where their fit ended."""
        values = self.structure.values(self.fit.theta[N_BASE:])
        return tuple(Candidate(c.name, tuple(values[c.name].items())) for c in self.structure.candidates)


@dataclass(frozen=True)
class Found:
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


def search(prepared: Prepared) -> Found:
    """Find the effects that explain the residual of the base model."""
    fit = prepared.fit
    first = screen(prepared.problem, prepared.structure, fit.theta, fit.residual, fit.jacobian)
    threshold = max(_LEAST_GAIN, _MATERIAL * fit.residual.size, _null_gain(prepared, first))
    span = orthonormal(project_out(prepared.generic, prepared.basis), 1e-4)
    explainable = _spread_excess(span, fit.residual)
    null = float(np.quantile([_spread_excess(span, v) for v in prepared.null_residuals], _QUANTILE))
    tried = _singles(prepared, first)
    accepted = _acceptable(tried, threshold)
    if accepted and accepted[0].coverage < _ENOUGH:
        tried += _grow(prepared, accepted[:1], first)
        tried += _grow(prepared, _partners(tried, accepted[0], threshold))
        pairs = [e for e in _acceptable(tried, threshold) if len(e.names) == 2]
        if pairs and pairs[0].coverage < _ENOUGH:
            tried += _grow(prepared, pairs[:1])
    best = _choose(prepared, tried, threshold)
    if best is not None:
        close = _close_to(best, _acceptable(tried, threshold))
        finished = _polish(prepared, close, iterations=_LAST_STEPS, refresh=2)
        tried = finished + [explanation for explanation in tried if explanation not in close]
        best = _choose(prepared, tried, threshold)
    tried.sort(key=lambda explanation: -explanation.gain)
    return Found(tuple(tried), best, threshold, explainable, null, first)


def _acceptable(tried: Sequence[Explanation], threshold: float) -> list[Explanation]:
    passing = [e for e in tried if not e.refused and e.certain > threshold]
    return sorted(passing, key=lambda explanation: -_weighed(explanation))


def _partners(tried: Sequence[Explanation], seed: Explanation, threshold: float) -> list[Explanation]:
    """The other effects of the best pair, alone: beside them its partner may be of another form, or another effect."""
    pairs = [e for e in _acceptable(tried, threshold) if len(e.names) == 2]
    others = set(pairs[0].names) - set(seed.names) if pairs else set()
    return [e for e in tried if len(e.names) == 1 and others.issuperset(e.names)]


def _close_to(best: Explanation, accepted: Sequence[Explanation]) -> list[Explanation]:
    """The chosen explanation and the rivals that the last steps could still bring before it."""
    near = [e for e in accepted if e is not best and e.gain > (1.0 - _NEAR) * best.gain]
    return [best, *sorted(near, key=lambda rival: -rival.gain)[:_FINALISTS]]


def _weighed(explanation: Explanation) -> float:
    """Gain, less a share for effects that fill in for others."""
    return explanation.gain * min(_FILLS_IN.get(name, 1.0) for name in explanation.names)


def _choose(prepared: Prepared, tried: Sequence[Explanation], threshold: float) -> Explanation | None:
    """The smallest explanation that no larger one beats by a material gain and coverage."""
    best: Explanation | None = None
    for size in (1, 2, 3):
        options = _acceptable([e for e in tried if len(e.names) == size], threshold)
        if not options:
            continue
        top = options[0]
        if (best is None or _better(prepared, top, best, threshold)) and not _idle(top, tried, threshold):
            best = top
    return best


def _idle(larger: Explanation, tried: Sequence[Explanation], threshold: float) -> bool:
    """Whether some of its effects explain about all alone, be they refused: the others would only carry them."""
    return any(
        set(part.names) < set(larger.names)
        and _weighed(larger) < _weighed(part) + _worth(part, threshold)
        and not _completes(larger, part, threshold)
        for part in tried
    )


def _better(prepared: Prepared, larger: Explanation, best: Explanation, threshold: float) -> bool:
    """Whether the further effects of a larger explanation add enough, and where they can be seen."""
    further = set(larger.names) - set(best.names)
    counted = _counted(prepared, further, best.fit, larger.fit)
    if _completes(larger, best, threshold):
        return counted > threshold or _weighed(larger) > _weighed(best) + _OVERWHELMING * threshold
    return (
        _weighed(larger) > _weighed(best) + _worth(best, threshold)
        and counted > max(threshold, _ANOTHER * best.certain)
        and larger.coverage > best.coverage + 0.015
    )


def _worth(part: Explanation, threshold: float) -> float:
    """Gain that further effects must add: less is the form of the first ones not quite met."""
    return max(threshold, _ANOTHER * part.gain)


def _completes(larger: Explanation, part: Explanation, threshold: float) -> bool:
    """Whether its further effects take away nearly all that is left, as none does of a form that is not quite met."""
    clear = _weighed(larger) > _weighed(part) + _MUCH * threshold
    if _FILLS_IN.keys() & set(larger.names) - set(part.names):
        return False
    return clear and larger.coverage > _ENOUGH and larger.left < _REMNANT * part.left


def _counted(prepared: Prepared, names: Collection[str], before: Fit, after: Fit) -> float:
    """Fall of the cost in rows that can show the effects `names`, none counting for more than a few; nothing where
    too little of it lies where the joint slides: effects of sliding reach rest only by bending the bristle. A fall
    about rest that no error of the bristle's form reaches counts for any of them.
    """
    fall, rows = _falls(before, after), prepared.sliding
    about_rest = float(np.mean(fall[~rows])) if not np.all(rows) else 0.0
    if about_rest > _LOUD_ABOUT_REST or any(EFFECTS[name].shown_at_rest for name in names):
        return float(np.sum(fall))
    sliding, fair = float(np.sum(fall[rows])), float(np.sum(fall)) * float(np.mean(rows))
    return sliding if sliding > _FAIR * fair else min(sliding, 0.0)


def _falls(before: Fit, after: Fit) -> FloatArray:
    """Fall of the cost in each row, none counting for more than a few. Shape (m,)."""
    return np.clip(before.residual**2 - after.residual**2, -_MOST_OF_A_ROW, _MOST_OF_A_ROW)


def _null_gain(prepared: Prepared, screened: Screen) -> float:
    """Largest BIC gain of any effect on a null, at the quantile that fixes the rate of false alarms."""
    rows = np.log(prepared.fit.residual.size)
    gains = [
        max(
            float(np.sum((column.span.T @ vector) ** 2)) - _freedom(prepared, column) * float(rows)
            for column in screened.columns
        )
        for vector in prepared.null_residuals
    ]
    return float(np.quantile(gains, _QUANTILE))


def _freedom(prepared: Prepared, column: Column) -> int:
    return Structure(prepared.structure.contexts, (column.candidate,)).freedom


def _excess(span: FloatArray, residual: FloatArray) -> float:
    """Energy explained by `span`, orthonormal or some rows of it, beyond what noise gives."""
    return float(np.sum((span.T @ residual) ** 2) - np.sum(span**2))


def _spread_excess(span: FloatArray, residual: FloatArray) -> float:
    """The same where no row counts for more than a few: one bad moment is no physics."""
    limit = float(np.sqrt(_MOST_OF_A_ROW))
    return _excess(span, np.clip(residual, -limit, limit))


def _singles(prepared: Prepared, first: Screen) -> list[Explanation]:
    """Each strong effect on its own: a quick refit of its best hypotheses, and a careful one of the best effects; all
    other effects where none of those explains most, as a base that is bent far screens badly.
    """
    groups, contexts = _ranked(first, _SINGLES), prepared.structure.contexts
    others = [group for group in _grouped(first) if group not in groups]
    suspected = [group for group in others if group[0].candidate.effect.suspected(contexts)]
    tried = _refitted(prepared, [*groups, *suspected])
    if prepared.noise_ratio > _BENT and all(explanation.coverage < _MOST for explanation in tried):
        tried += _refitted(prepared, [group for group in others if group not in suspected])
        tried += _from_afar(prepared)
    return sorted(tried, key=_preference, reverse=True)


def _from_afar(prepared: Prepared) -> list[Explanation]:
    """Effects with many minima, from starts far from each other."""
    contexts, theta = prepared.structure.contexts, prepared.fit.theta
    starts = [(name, start) for name, effect in EFFECTS.items() for start in effect.far_starts(contexts)]
    return fit_from(prepared, [((Candidate(name, tuple(s.items())),), theta) for name, s in starts], prepared.box)


def _refitted(prepared: Prepared, groups: Sequence[Sequence[Column]]) -> list[Explanation]:
    """The best hypothesis of each effect refitted; the best effects with care."""
    rows = np.log(prepared.fit.residual.size)
    contexts = prepared.structure.contexts
    options = [
        [
            column
            for column in group
            if column.energy > max(0.3 * group[0].energy, rows) or column.candidate.effect.suspected(contexts)
        ][:2]
        for group in groups
    ]
    trials = iter(_explain(prepared, [((c.candidate,), prepared.fit) for part in options for c in part]))
    quick = [max((next(trials) for _ in part), key=_preference) for part in options if part]
    quick.sort(key=_preference, reverse=True)
    careful = _polish(prepared, quick[:_CAREFUL])
    if all(explanation.coverage < _ENOUGH for explanation in careful):
        careful += _polish(prepared, quick[_CAREFUL:_MORE_CAREFUL])
    return careful + quick[len(careful) :]


def _preference(explanation: Explanation) -> float:
    """Gain, with explanations that are not physical behind all others."""
    return explanation.gain - 1e9 * bool(explanation.refused)


def _ranked(screened: Screen, count: int) -> list[list[Column]]:
    """Candidates grouped by effect, strongest effect first, the faintest left out."""
    strongest = screened.columns[0].energy if screened.columns else 0.0
    return [group for group in _grouped(screened) if group[0].energy > _FAINT * strongest][:count]


def _grouped(screened: Screen) -> list[list[Column]]:
    """Candidates grouped by effect, strongest effect first."""
    groups: dict[str, list[Column]] = {}
    for column in screened.columns:
        groups.setdefault(column.candidate.name, []).append(column)
    return list(groups.values())


def _grow(prepared: Prepared, seeds: Sequence[Explanation], first: Screen | None = None) -> list[Explanation]:
    """One more effect on top of each seed, found by screening about the seed's own minimum; the pairs that `first`
    scores highest besides.
    """
    wanted: list[tuple[tuple[Candidate, ...], Fit]] = []
    seen: set[tuple[str, ...]] = set()
    for seed in seeds:
        screened = screen(prepared.problem, seed.structure, seed.fit.theta, seed.fit.residual, seed.fit.jacobian)
        for columns in _ranked(screened, _PARTNERS):
            names = tuple(sorted((*seed.names, columns[0].candidate.name)))
            if names in seen:
                continue
            seen.add(names)
            alike = [c.candidate for c in columns[:2] if c.energy > _ALIKE * columns[0].energy]
            wanted += [((*seed.settled, candidate), seed.fit) for candidate in alike]
    for pair in first.pairs(prepared.fit.residual, _PARTNERS) if first is not None else ():
        names = tuple(sorted(c.name for c in pair))
        if names not in seen:
            seen.add(names)
            wanted.append((pair, prepared.fit))
    return _explain(prepared, wanted)


def _polish(
    prepared: Prepared, explanations: Sequence[Explanation], *, iterations: int = 4, refresh: int = 2
) -> list[Explanation]:
    """The same explanations at the minima of fresh Jacobians, their effects computed for the joint that was found."""
    descents = []
    for explanation in explanations:
        plant = explanation.structure.plant(explanation.fit.theta)
        contexts = tuple(replace(context, plant=plant) for context in prepared.structure.contexts)
        structure = Structure(contexts, explanation.settled)
        descent = structure.descent(explanation.fit.theta, prepared.box, iterations=iterations, refresh=refresh)
        descents.append((structure, descent))
    return [max(pair, key=_preference) for pair in zip(explanations, _fitted(prepared, descents), strict=True)]


def _explain(prepared: Prepared, wanted: Sequence[tuple[tuple[Candidate, ...], Fit]]) -> list[Explanation]:
    """Fit base and candidates jointly in the simulator, each set from a fit without them, and judge what they leave."""
    descents = []
    for candidates, fit in wanted:
        structure = Structure(prepared.structure.contexts, candidates)
        start = np.concatenate([fit.theta[:N_BASE], structure.start()])
        descent = structure.descent(start, prepared.box, jacobian=fit.jacobian, iterations=5, refresh=99)
        descents.append((structure, descent))
    return _fitted(prepared, descents)


def fit_from(
    prepared: Prepared, wanted: Sequence[tuple[Sequence[Candidate], FloatArray]], box: Box
) -> list[Explanation]:
    """Fit base and candidates jointly and with care, maybe in another domain than the usual one.

    Args:
        prepared: Base model and recordings.
        wanted: For each explanation its effects with their starting values, and the start of the base, shape (N_BASE,).
        box: Domain and priors of the base.
    """
    descents = []
    for candidates, theta in wanted:
        structure = Structure(prepared.structure.contexts, tuple(candidates))
        start = np.concatenate([theta, structure.start()])
        descents.append((structure, structure.descent(start, box, iterations=_LAST_STEPS, refresh=2)))
    return _fitted(prepared, descents)


def _fitted(prepared: Prepared, descents: Sequence[tuple[Structure, Descent]]) -> list[Explanation]:
    """Run fits side by side, and judge what they leave."""
    fits = fit_all(prepared.problem, descents)
    return [_judged(prepared, structure, fit) for (structure, _), fit in zip(descents, fits, strict=True)]


def _judged(prepared: Prepared, structure: Structure, fit: Fit) -> Explanation:
    fall = prepared.fit.cost - fit.cost
    penalty = structure.freedom * float(np.log(fit.residual.size))
    left = _left(prepared, fit)
    coverage = fall / (fall + left) if fall > 0.0 else 0.0
    counted = _counted(prepared, structure.names, prepared.fit, fit)
    if fall > _PLAIN * fit.residual.size and coverage > _PLAINLY_COVERED:
        counted = float(np.sum(_falls(prepared.fit, fit)))
    refused = _refusal(structure, fit)
    return Explanation(structure, fit, fall - penalty, counted - penalty, float(coverage), left, refused)


def _left(prepared: Prepared, fit: Fit) -> float:
    """Energy that the generic basis explains of what a fit leaves, beyond chance and the form of the bristle."""
    span, about_rest = orthonormal(project_out(prepared.generic, orthonormal(fit.jacobian)), 1e-4), ~prepared.sliding
    bristle = _excess(span * about_rest[:, None], fit.residual)
    of_its_form = float(np.clip(bristle, 0.0, _BRISTLE * np.sum(about_rest)))
    return max(_excess(span, fit.residual) - of_its_form, 0.0)


def _refusal(structure: Structure, fit: Fit) -> str:
    values = structure.values(fit.theta[N_BASE:])
    reasons = [c.effect.refuse(values[c.name], structure.contexts) for c in structure.candidates]
    return "; ".join(reason for reason in reasons if reason)

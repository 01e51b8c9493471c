"""Fits of base and effects, side by side, each judged by what it leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..effects import Context
from ..effects.context import move_context
from ..effects.structure import N_BASE, Candidate, Structure, fit_all
from ..inputs.track import FloatArray
from ..joint.base import even_directions
from ..joint.race import Entry, Race
from ..joint.solver import Box, Descent
from .explanation import Explanation, judge
from .preparation import Baseline
from .settings import SEARCH


def refit(
    baseline: Baseline,
    wanted: Sequence[tuple[tuple[Candidate, ...], Baseline | Explanation]],
    lead: float = np.inf,
) -> list[Explanation]:
    """Fit base and candidates jointly in the simulator, each set from what was fitted without some of them, and judge
    what they leave. One that cannot come near the best of them, or the cost `lead`, ends early."""
    descents, entry = [], Entry(Race(baseline.fit.cost, lead))
    for candidates, before in wanted:
        structure, fit = Structure(before.structure.contexts, candidates), before.fit
        start = np.concatenate([fit.theta[:N_BASE], structure.build_start()])
        descent = structure.start_descent(
            start, baseline.box, jacobian=fit.jacobian, iterations=5, refresh=99, entry=entry
        )
        descents.append((structure, descent))
    return _fit_and_judge(baseline, descents, [baseline.box] * len(descents))


def polish(
    baseline: Baseline,
    explanations: Sequence[Explanation],
    *,
    iterations: int = 4,
    refresh: int = 2,
    lead: float = np.inf,
) -> list[Explanation]:
    """The same explanations at the minima of fresh Jacobians, their effects computed for the joint that was found, as
    long as they may come near the best of them, or the cost `lead`.

    Each starts where it was, and with both directions evened, and stays as it was where neither leaves less.
    """
    descents, owners = [], []
    best = min([lead, *(one.fit.cost for one in explanations if not one.refused)])
    entry = Entry(Race(baseline.fit.cost, best, at_once=True))
    for i, one in enumerate(explanations):
        structure = rebuild(baseline, one)
        for start in (one.fit.theta, even_directions(one.fit.theta)):
            if start is None:
                continue
            theta = np.concatenate([start[:N_BASE], structure.build_start()])
            descent = structure.start_descent(theta, one.box, iterations=iterations, refresh=refresh, entry=entry)
            descents.append((structure, descent))
            owners.append(i)
    result = list(explanations)
    fitted = _fit_and_judge(baseline, descents, [explanations[i].box for i in owners])
    for i, one in zip(owners, fitted, strict=True):
        result[i] = max(result[i], one, key=compute_preference)
    return result


def rebuild(baseline: Baseline, explanation: Explanation) -> Structure:
    """The effects of an explanation where their fit ended, on the joint that was found."""
    return explanation.settled_structure.move_to(rebuild_contexts(baseline, explanation))


def rebuild_contexts(baseline: Baseline, explanation: Explanation) -> tuple[Context, ...]:
    """Rebuild each recording's context with load and position of the joint that was found.

    One that runs away in simulation shows no position: that of the joint before it stays.
    """
    structure, theta = explanation.structure, explanation.fit.theta
    seen = structure.observe(baseline.problem, theta)
    contexts = structure.move_contexts(theta)
    if not all(np.isfinite(one.position).all() for one in seen):
        return contexts
    return tuple(move_context(*each) for each in zip(contexts, baseline.problem.tracks, seen, strict=True))


def fit_from(
    baseline: Baseline,
    wanted: Sequence[tuple[Structure, FloatArray]],
    box: Box | Sequence[Box],
    *,
    entry: Entry | None = None,
) -> list[Explanation]:
    """Fit base and candidates jointly and with care, maybe in another domain than the usual one.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        wanted: For each explanation its structure, whose contexts are of the joint that it starts from, and the start
            of the base, shape (N_BASE,). A base fitted without friction under load has another gravity and load.
        box: Domain and priors of the base: of all of them, or of each.
        entry: The race that they run in; None where each runs to its end.
    """
    boxes = [box] * len(wanted) if isinstance(box, Box) else list(box)
    descents = []
    for (structure, theta), own in zip(wanted, boxes, strict=True):
        start = np.concatenate([theta, structure.build_start()])
        descent = structure.start_descent(start, own, iterations=SEARCH.last_steps, refresh=2, entry=entry)
        descents.append((structure, descent))
    return _fit_and_judge(baseline, descents, boxes)


def _fit_and_judge(
    baseline: Baseline, descents: Sequence[tuple[Structure, Descent]], boxes: Sequence[Box]
) -> list[Explanation]:
    """Run fits side by side, each with the domain of its base, and judge what they leave."""
    fits = fit_all(baseline.problem, descents)
    return [judge(baseline, s, fit, box) for (s, _), fit, box in zip(descents, fits, boxes, strict=True)]


def compute_preference(explanation: Explanation) -> float:
    """Gain, with explanations that are not physical behind all others."""
    return explanation.gain - 1e9 * bool(explanation.refused)

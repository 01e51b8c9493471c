"""Fits of base and effects, side by side, each judged by what it leaves."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .explanation import Explanation, judged
from .preparation import Prepared
from .solver import Box, Descent
from .structure import N_BASE, Candidate, Structure, fit_all
from .track import FloatArray

__all__ = ["LAST_STEPS", "fit_from", "polish", "preference", "refit"]

LAST_STEPS = 12  # of an explanation that was chosen and of rivals close to it


def refit(
    prepared: Prepared, wanted: Sequence[tuple[tuple[Candidate, ...], Prepared | Explanation]]
) -> list[Explanation]:
    """Fit base and candidates jointly in the simulator, each set from what was fitted without some of them, and judge
    what they leave.
    """
    descents = []
    for candidates, before in wanted:
        structure, fit = Structure(before.structure.contexts, candidates), before.fit
        start = np.concatenate([fit.theta[:N_BASE], structure.start()])
        descent = structure.descent(start, prepared.box, jacobian=fit.jacobian, iterations=5, refresh=99)
        descents.append((structure, descent))
    return _fitted(prepared, descents)


def polish(
    prepared: Prepared, explanations: Sequence[Explanation], *, iterations: int = 4, refresh: int = 2
) -> list[Explanation]:
    """The same explanations at the minima of fresh Jacobians, their effects computed for the joint that was found."""
    descents = []
    for explanation in explanations:
        structure = Structure(explanation.structure.contexts_at(explanation.fit.theta), explanation.settled)
        descent = structure.descent(explanation.fit.theta, prepared.box, iterations=iterations, refresh=refresh)
        descents.append((structure, descent))
    return [max(pair, key=preference) for pair in zip(explanations, _fitted(prepared, descents), strict=True)]


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
        descents.append((structure, structure.descent(start, box, iterations=LAST_STEPS, refresh=2)))
    return _fitted(prepared, descents)


def _fitted(prepared: Prepared, descents: Sequence[tuple[Structure, Descent]]) -> list[Explanation]:
    """Run fits side by side, and judge what they leave."""
    fits = fit_all(prepared.problem, descents)
    return [judged(prepared, structure, fit) for (structure, _), fit in zip(descents, fits, strict=True)]


def preference(explanation: Explanation) -> float:
    """Gain, with explanations that are not physical behind all others."""
    return explanation.gain - 1e9 * bool(explanation.refused)

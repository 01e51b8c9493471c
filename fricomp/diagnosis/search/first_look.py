"""What the first weighted fit of the base leaves, in a sentence, long before the search has looked for its name."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from ..inputs.track import FloatArray
from ..joint.base_fit import is_loud
from ..joint.problem import Problem
from ..joint.solver import Fit
from .settings import SEARCH


class _Part(NamedTuple):
    """A part of the rows: the share of the excess in it, and where it is."""

    share: float
    words: str


def describe_first_look(problem: Problem, fit: Fit) -> str:
    """Say whether something is missing, by how much, and where most of it shows.

    Args:
        problem: Recordings and weights.
        fit: Fit of the base with these weights.
    """
    if not is_loud(fit):
        return "first look: the base leaves about as much as noise; looking closer"
    ratio = float(np.sqrt(fit.residual @ fit.residual / fit.residual.size))
    part = _find_part(problem, np.maximum(fit.residual**2 - 1.0, 0.0))
    where = f", {part.share:.0%} of it {part.words}" if part.share > SEARCH.first_share else ""
    return f"first look: something is missing, {ratio:.2g} times the noise is left{where}"


def _find_part(problem: Problem, excess: FloatArray) -> _Part:
    """The rows about rest, or the neighbouring bins of one quantity that hold the largest share of the excess."""
    unit = "rad" if problem.tracks[0].rotary else "m"
    slow = 2.0 * problem.observer.rest_speed
    quantities = {
        f"at positions from {{:.3g}} to {{:.3g}} {unit}": _collect(problem, "position"),
        f"at speeds from {{:.3g}} to {{:.3g}} {unit}/s": np.abs(_collect(problem, "velocity")),
    }
    speeds = np.abs(_collect(problem, "velocity"))
    total = max(float(np.sum(excess)), 1e-300)
    rest = _Part(float(np.sum(excess[speeds < slow])) / total, "about rests and reversals")
    if rest.share > SEARCH.first_share and np.mean(speeds < slow) < SEARCH.first_width:
        return rest  # slow speeds hold it as well
    parts = []
    for words, values in quantities.items():
        edges = np.quantile(values, np.linspace(0.0, 1.0, SEARCH.first_bins + 1))
        held = np.histogram(values, edges, weights=excess)[0] if np.all(np.diff(edges) > 0.0) else np.zeros(1)
        width = max(1, round(SEARCH.first_width * SEARCH.first_bins))
        if held.size > width:
            sums = np.convolve(held, np.ones(width), mode="valid")
            at = int(np.argmax(sums))
            parts.append(_Part(float(sums[at]) / total, words.format(edges[at], edges[at + width])))
    return max(parts, key=lambda part: part.share, default=_Part(0.0, ""))


def _collect(problem: Problem, channel: str) -> FloatArray:
    """A channel at the centres of all rows. Shape (m,)."""
    parts = [getattr(track, channel)[grid.centres] for track, grid in zip(problem.tracks, problem.grids, strict=True)]
    return np.concatenate(parts)

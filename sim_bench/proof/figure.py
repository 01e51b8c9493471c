"""One figure of a proof: a value with its interval, its target, and the cases behind it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from .score import Score
from .statistics import ShareEstimate, compute_clustered_share, compute_mean, compute_median, compute_share

__all__ = ["WEAK", "Figure", "at_least", "at_most", "count_share", "coverage", "mean", "median", "where"]

WEAK = 0.95
"""Share of a wanted strength that still counts as that strength."""


class Figure(NamedTuple):
    """One figure of the proof.

    Attributes:
        name: What is measured.
        target: What is wanted.
        value: As measured, with interval and number of cases.
        reached: Whether the target is, by the value; None where there is no case, or no target.
        cases: What it was measured on.
        brief: The value on some of them, in a few words; None where it has no parts.
        settled: Whether the whole interval lies on that side of the target.
    """

    name: str
    target: str
    value: str
    reached: bool | None
    cases: tuple[Score, ...] = ()
    brief: Callable[[Sequence[Score]], str] | None = None
    settled: bool = True

    @property
    def standing(self) -> str:
        """Whether the target is reached, and `open` where the interval reaches beyond it."""
        if self.reached is None:
            return "–"
        return ("yes" if self.reached else "no") + ("" if self.settled else ", open")


def where(scores: Sequence[Score], wanted: Callable[[Score], bool]) -> list[Score]:
    """The scores that are wanted."""
    return [score for score in scores if wanted(score)]


def count_share(scores: Sequence[Score], hit: Callable[[Score], bool]) -> ShareEstimate:
    """How many of the scores hit."""
    return compute_share(sum(map(hit, scores)), len(scores))


def at_least(name: str, wanted: float, scores: Sequence[Score], hit: Callable[[Score], bool]) -> Figure:
    """A share that should be large."""
    found = count_share(scores, hit)
    reached = found.share >= wanted if found.total else None
    settled = found.low >= wanted or found.high < wanted
    return Figure(name, f"≥ {wanted:.0%}", str(found), reached, tuple(scores), _brief(hit), settled)


def at_most(
    name: str, wanted: float, scores: Sequence[Score], hit: Callable[[Score], bool], bound: float = 1.0
) -> Figure:
    """A share that should be small, and the upper end of its interval too where a bound is given: that settles it."""
    found = count_share(scores, hit)
    target = f"≤ {wanted:.0%}" + (f", upper bound ≤ {bound:.0%}" if bound < 1.0 else "")
    reached = found.share <= wanted and found.high <= bound if found.total else None
    settled = found.low > wanted or found.high <= max(wanted, bound if bound < 1.0 else 0.0)
    return Figure(name, target, str(found), reached, tuple(scores), _brief(hit), settled)


def _brief(hit: Callable[[Score], bool]) -> Callable[[Sequence[Score]], str]:
    return lambda scores: f"{sum(map(hit, scores))} of {len(scores)}"


def median(
    name: str,
    target: str,
    scores: Sequence[Score],
    value: Callable[[Score], float],
    reached: Callable[[float], bool | None],
) -> Figure:
    """The median of what is finite."""
    known = where(scores, lambda s: bool(np.isfinite(value(s))))
    found = compute_median([value(score) for score in known])
    met = reached(found.median) if known else None
    settled = reached(found.low) == reached(found.high) == met
    return Figure(
        name, target, str(found), met, tuple(known), lambda some: f"{np.median([value(s) for s in some]):.3g}", settled
    )


def mean(name: str, most: float, scores: Sequence[Score], value: Callable[[Score], float]) -> Figure:
    """A mean that should be small, its interval by drawing cases again."""
    values = [value(score) for score in scores]
    if not values:
        return Figure(name, f"≤ {most:g}", "– (no case)", None)
    middle, low, high = compute_mean(values)
    text = f"mean {middle:.2f} ({low:.2f} to {high:.2f}; {len(values)} cases)"
    return Figure(name, f"≤ {most:g}", text, middle <= most, tuple(scores), settled=low > most or high <= most)


def coverage(name: str, scores: Sequence[Score], least: float, most: float) -> Figure:
    """Share of parameters whose interval holds the truth, those of one case taken as a cluster."""
    compared = where(scores, lambda s: s.parameters > 0)
    target = f"{100.0 * least:.0f}–{100.0 * most:.0f} %" if most else "–"
    if not compared:
        return Figure(name, target, "– (no case)", None)
    found = compute_clustered_share([s.covered for s in compared], [s.parameters for s in compared])
    text = f"{found.share:.1%} ({found.hits} of {found.total} in {len(compared)} cases; "
    text += f"{found.low:.1%} to {found.high:.1%})"
    reached = least <= found.share <= most if most else None
    settled = found.high < least or found.low > most or least <= found.low <= found.high <= most
    return Figure(name, target, text, reached, tuple(compared), _covered, settled)


def _covered(scores: Sequence[Score]) -> str:
    return f"{sum(s.covered for s in scores)} of {sum(s.parameters for s in scores)}"

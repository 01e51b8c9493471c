"""One figure of a study: a value with its interval, its target, and the cases behind it."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import numpy as np

from .interval import KnownInterval
from .statistics import ShareEstimate, compute_clustered_share, compute_mean, compute_median, compute_share

Score = TypeVar("Score")
"""A scored case of whichever study."""

WEAK = 0.95
"""Share of a wanted strength that still counts as that strength."""


@dataclass(frozen=True)
class Figure(Generic[Score]):
    """One figure of a study.

    Attributes:
        name: What is measured.
        target: What is wanted.
        value: As measured, with interval and number of cases.
        reached: Whether the target is, by the value; None where there is no case, or no target.
        cases: What it was measured on.
        brief: Gives the value on some of them in a few words; None where it has no parts.
        settled: Whether the whole interval lies on that side of the target.
        topic: What it is about, with others.
    """

    name: str
    target: str
    value: str
    reached: bool | None
    cases: tuple[Score, ...] = ()
    brief: Callable[[Sequence[Score]], str] | None = None
    settled: bool = True
    topic: str = ""

    @property
    def standing(self) -> str:
        """Whether the target is reached, and `open` where the interval reaches beyond it."""
        if self.reached is None:
            return "–"
        return ("yes" if self.reached else "no") + ("" if self.settled else ", open")


def select(scores: Sequence[Score], wanted: Callable[[Score], bool]) -> list[Score]:
    """The scores that are wanted."""
    return [score for score in scores if wanted(score)]


def count_share(
    scores: Sequence[Score], hit: Callable[[Score], bool], cluster: Callable[[Score], Any] | None = None
) -> ShareEstimate:
    """How many of the scores hit; those of one cluster, such as of one recording, are alike."""
    if cluster is None:
        return compute_share(sum(map(hit, scores)), len(scores))
    return compute_clustered_share(*_count_by(scores, lambda s: (int(hit(s)), 1), cluster))


def _count_by(
    scores: Sequence[Score], counts: Callable[[Score], tuple[int, int]], cluster: Callable[[Score], Any]
) -> tuple[list[int], list[int]]:
    """Hits and totals of each cluster."""
    sums: dict[Any, tuple[int, int]] = {}
    for score in scores:
        (hits, totals), (more_hits, more) = sums.get(cluster(score), (0, 0)), counts(score)
        sums[cluster(score)] = hits + more_hits, totals + more
    return [hits for hits, _ in sums.values()], [totals for _, totals in sums.values()]


def group_by(scores: Sequence[Score], key: Callable[[Score], str]) -> list[tuple[str, list[Score]]]:
    """The scores of each value of a key, by that value."""
    return [(value, [score for score in scores if key(score) == value]) for value in sorted(set(map(key, scores)))]


def measure_share(
    name: str,
    scores: Sequence[Score],
    hit: Callable[[Score], bool],
    cluster: Callable[[Score], Any] | None = None,
) -> Figure[Score]:
    """A share of which nothing is wanted."""
    return Figure(name, "–", str(count_share(scores, hit, cluster)), None, tuple(scores), _brief(hit))


def require_at_least(
    name: str,
    wanted: float,
    scores: Sequence[Score],
    hit: Callable[[Score], bool],
    cluster: Callable[[Score], Any] | None = None,
) -> Figure[Score]:
    """A share that should be large."""
    found = count_share(scores, hit, cluster)
    reached = found.share >= wanted if found.total else None
    settled = found.low >= wanted or found.high < wanted
    return Figure(name, f"≥ {wanted:.0%}", str(found), reached, tuple(scores), _brief(hit), settled)


def require_at_most(
    name: str,
    wanted: float,
    scores: Sequence[Score],
    hit: Callable[[Score], bool],
    bound: float = 1.0,
    cluster: Callable[[Score], Any] | None = None,
) -> Figure[Score]:
    """A share that should be small, and the upper end of its interval too where a bound is given: that settles it."""
    found = count_share(scores, hit, cluster)
    target = f"≤ {wanted:.0%}" + (f", upper bound ≤ {bound:.0%}" if bound < 1.0 else "")
    reached = found.share <= wanted and found.high <= bound if found.total else None
    settled = found.low > wanted or found.high <= max(wanted, bound if bound < 1.0 else 0.0)
    return Figure(name, target, str(found), reached, tuple(scores), _brief(hit), settled)


def _brief(hit: Callable[[Score], bool]) -> Callable[[Sequence[Score]], str]:
    return lambda scores: f"{sum(map(hit, scores))} of {len(scores)}"


def measure_median(
    name: str,
    target: str,
    scores: Sequence[Score],
    value: Callable[[Score], float],
    reached: Callable[[float], bool | None],
) -> Figure[Score]:
    """The median of what is finite."""
    known = select(scores, lambda s: bool(np.isfinite(value(s))))
    found = compute_median([value(score) for score in known])
    met = reached(found.median) if known else None
    settled = reached(found.low) == reached(found.high) == met
    return Figure(
        name, target, str(found), met, tuple(known), lambda some: f"{np.median([value(s) for s in some]):.3g}", settled
    )


def measure_mean(name: str, most: float, scores: Sequence[Score], value: Callable[[Score], float]) -> Figure[Score]:
    """A mean that should be small, its interval by drawing cases again."""
    values = [value(score) for score in scores]
    if not values:
        return Figure(name, f"≤ {most:g}", "– (no case)", None)
    middle, low, high = compute_mean(values)
    text = f"mean {middle:.2f} ({low:.2f} to {high:.2f}; {len(values)} cases)"
    return Figure(name, f"≤ {most:g}", text, middle <= most, tuple(scores), settled=low > most or high <= most)


def measure_coverage(
    name: str,
    scores: Sequence[Score],
    intervals: Callable[[Score], Sequence[KnownInterval]],
    least: float = 0.0,
    most: float = 0.0,
    cluster: Callable[[Score], Any] = id,
) -> Figure[Score]:
    """Share of known intervals that hold the truth.

    Args:
        name: What is measured.
        scores: The cases.
        intervals: Of a case, those that count.
        least: Smallest share that is wanted.
        most: Largest share that is wanted; 0 where there is no target.
        cluster: What intervals that are alike have in common; by default each case is a cluster of its own.
    """

    def counts(score: Score) -> tuple[int, int]:
        return sum(each.covers for each in intervals(score)), len(intervals(score))

    def brief(some: Sequence[Score]) -> str:
        hits, totals = zip(*map(counts, some), strict=True)
        return f"{sum(hits)} of {sum(totals)}"

    compared = select(scores, lambda s: counts(s)[1] > 0)
    target = f"{100.0 * least:.0f}–{100.0 * most:.0f} %" if most else "–"
    if not compared:
        return Figure(name, target, "– (no case)", None)
    found = compute_clustered_share(*_count_by(compared, counts, cluster))
    text = f"{found.share:.1%} ({found.hits} of {found.total} in {len(compared)} cases; "
    text += f"{found.low:.1%} to {found.high:.1%})"
    reached = least <= found.share <= most if most else None
    settled = found.high < least or found.low > most or least <= found.low <= found.high <= most
    return Figure(name, target, text, reached, tuple(compared), brief, settled)

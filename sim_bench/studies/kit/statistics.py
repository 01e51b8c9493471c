"""Shares, medians and means with their 95 % intervals."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

_DRAWS, _SEED = 4000, 7
"""Of the bootstrap of a mean: with 4000 draws the ends of its interval vary by some hundredths of its width."""


class ShareEstimate(NamedTuple):
    """A share with its exact 95 % interval [clopper1934].

    Attributes:
        hits: How often it happened.
        total: Out of how many.
        low: Lower end; 0 for no case.
        high: Upper end; 1 for no case.
    """

    hits: int
    total: int
    low: float
    high: float

    @property
    def share(self) -> float:
        """hits / total; NaN for no case."""
        return self.hits / self.total if self.total else float("nan")

    def __str__(self) -> str:
        if not self.total:
            return "– (no case)"
        return f"{self.share:.1%} ({self.hits} of {self.total}; {self.low:.1%} to {self.high:.1%})"


def compute_share(hits: int, count: int) -> ShareEstimate:
    """Clopper-Pearson interval of a binomial share, at 95 %."""
    return ShareEstimate(hits, count, *_compute_exact_interval(hits, count))


def _compute_exact_interval(hits: float, count: float) -> tuple[float, float]:
    from scipy.stats import beta

    low = float(beta.ppf(0.025, hits, count - hits + 1.0)) if hits > 0.0 else 0.0
    high = float(beta.ppf(0.975, hits + 1.0, count - hits)) if hits < count else 1.0
    return low, high


class MedianEstimate(NamedTuple):
    """A median with a 95 % interval from order statistics; the whole range below six values.

    Attributes:
        median: NaN for no value.
        low: Lower end.
        high: Upper end.
        total: How many values.
    """

    median: float
    low: float
    high: float
    total: int

    def __str__(self) -> str:
        if not self.total:
            return "– (no case)"
        interval = f"{self.low:.3g} to {self.high:.3g}"
        return f"median {self.median:.3g} ({interval}{', all' if self.total < 6 else ''}; {self.total} cases)"


def compute_median(values: Sequence[float]) -> MedianEstimate:
    """Median of the values that are finite; as many lie outside each end as a fair coin allows in 2.5 % of cases."""
    from scipy.stats import binom

    known = np.sort([value for value in values if np.isfinite(value)])
    if not known.size:
        return MedianEstimate(float("nan"), float("nan"), float("nan"), 0)
    place = max(int(binom.ppf(0.025, known.size, 0.5)), 1)
    return MedianEstimate(float(np.median(known)), float(known[place - 1]), float(known[-place]), int(known.size))


def compute_clustered_share(hits: Sequence[int], totals: Sequence[int]) -> ShareEstimate:
    """The share sum(hits) / sum(totals) of what comes in clusters, with its 95 % interval [korn1998].

    That is the exact interval of as many independent trials as tell as much: their number is divided by how much more
    the share varies between clusters than it would if they were independent, and by how much less is known of that
    from few clusters. Where every cluster hits fully, or none does, it cannot be seen, and each cluster counts as one
    trial.
    """
    from scipy.stats import t

    of, out_of = np.asarray(hits, dtype=np.float64), np.asarray(totals, dtype=np.float64)
    known = out_of > 0.0
    of, out_of = of[known], out_of[known]
    if not of.size:
        return compute_share(0, 0)
    total, share = float(out_of.sum()), float(of.sum() / out_of.sum())
    effective = float(of.size)
    if 0.0 < share < 1.0 and of.size > 1:
        between = of.size / (of.size - 1) * float(np.sum((of - share * out_of) ** 2)) / total**2
        few = float((t.ppf(0.975, total - 1.0) / t.ppf(0.975, of.size - 1.0)) ** 2)
        effective = min(share * (1.0 - share) / max(between, 1e-30), total) * few
    low, high = _compute_exact_interval(share * effective, effective)
    return ShareEstimate(int(of.sum()), int(total), low, high)


def compute_mean(values: Sequence[float]) -> tuple[float, float, float]:
    """Mean and its 95 % interval by drawing values again; seeded. One value alone is its own interval."""
    from scipy.stats import bootstrap

    middle = float(np.mean(values))
    if len(set(values)) < 2:
        return middle, middle, middle
    rng = np.random.default_rng(_SEED)
    found = bootstrap((np.asarray(values),), np.mean, n_resamples=_DRAWS, method="percentile", rng=rng)
    return middle, float(found.confidence_interval.low), float(found.confidence_interval.high)


def format_quartiles(values: Sequence[float]) -> str:
    """Median, quartiles and number of the values that are finite, for a cell of a table."""
    known = [value for value in values if np.isfinite(value)]
    if not known:
        return "–"
    low, middle, high = np.quantile(known, [0.25, 0.5, 0.75])
    return f"{middle:.2f} ({low:.2f} to {high:.2f}; {len(known)} cases)"

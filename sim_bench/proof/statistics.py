"""Intervals of shares, and what the best possible detector would see at the same strength."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

__all__ = ["ShareEstimate", "compute_share", "format_quartiles", "oracle_power"]


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


def compute_share(hits: int, count: int, confidence: float = 0.95) -> ShareEstimate:
    """Clopper-Pearson interval of a binomial share."""
    from scipy.stats import beta

    tail = 0.5 * (1.0 - confidence)
    low = float(beta.ppf(tail, hits, count - hits + 1)) if hits > 0 else 0.0
    high = float(beta.ppf(1.0 - tail, hits + 1, count - hits)) if hits < count else 1.0
    return ShareEstimate(hits, count, low, high)


def oracle_power(enr: float, rows: int, freedom: int = 2, rivals: int = 32, false_alarms: float = 0.02) -> float:
    """Power of the likelihood-ratio test that knows every effect's shape.

    The energy of an effect of strength `enr` over n independent rows is n enr²; its test statistic is chi-squared with
    that non-centrality. The threshold keeps the false alarms over all rivals together at the wanted rate.

    Args:
        enr: Effect-to-noise ratio after the refit of the base.
        rows: Rows of the recording; half of them count, because neighbouring windows overlap by half.
        freedom: Parameters of an effect.
        rivals: Effects that are tested.
        false_alarms: Wanted rate on recordings with nothing missing.
    """
    from scipy.stats import chi2, ncx2

    threshold = float(chi2.isf(false_alarms / rivals, freedom))
    energy = 0.5 * rows * enr**2
    if energy == 0.0:
        return float(chi2.sf(threshold, freedom))
    if energy > 1e4:
        return 1.0
    return float(np.clip(ncx2.sf(threshold, freedom, energy), 0.0, 1.0))


def format_quartiles(values: Sequence[float]) -> str:
    """Median, quartiles and number of the values that are finite, for a cell of a table."""
    known = [value for value in values if np.isfinite(value)]
    if not known:
        return "–"
    low, middle, high = np.quantile(known, [0.25, 0.5, 0.75])
    return f"{middle:.2f} ({low:.2f} to {high:.2f}; {len(known)} cases)"

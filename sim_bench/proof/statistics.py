"""Intervals of shares, and what the best possible detector would see at the same strength."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

__all__ = [
    "MedianEstimate",
    "ShareEstimate",
    "bootstrap_ratio",
    "compute_median",
    "compute_share",
    "format_quartiles",
    "oracle_power",
]

_DRAWS, _SEED = 4000, 7  # of a bootstrap
_INDEPENDENT = 0.75  # of the rows


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


def bootstrap_ratio(hits: Sequence[float], totals: Sequence[float]) -> tuple[float, float]:
    """95 % interval of sum(hits) / sum(totals) over cases drawn again, so that what shares a case stays together.

    With 1 for each total it is that of a mean. Where every case hits fully, or none does, drawing again shows nothing:
    then it is the exact interval of a share of cases. The draws are seeded.
    """
    of, out_of = np.asarray(hits, dtype=np.float64), np.asarray(totals, dtype=np.float64)
    if of.sum() in (0.0, out_of.sum()):
        share = compute_share(of.size if of.sum() else 0, of.size)
        return share.low, share.high
    drawn = np.random.default_rng(_SEED).integers(0, of.size, (_DRAWS, of.size))
    low, high = np.quantile(of[drawn].sum(axis=1) / out_of[drawn].sum(axis=1), [0.025, 0.975])
    return float(low), float(high)


def oracle_power(enr: float, rows: int, freedom: int = 2, rivals: int = 32, false_alarms: float = 0.02) -> float:
    """Power of the likelihood-ratio test that knows every effect's shape.

    The energy of an effect of strength `enr` over n independent rows is n enr²; its test statistic is chi-squared with
    that non-centrality. The threshold keeps the false alarms over all rivals together at the wanted rate.

    Args:
        enr: Effect-to-noise ratio after the refit of the base.
        rows: Rows of the recording; three quarters of them count. Hann windows that overlap by half share 1/6 of white
            torque noise, so that what changes slowly from row to row meets 1 + 2/6 of its variance; what changes
            quickly, and rows whose noise is the encoder's, meet less. Coloured torque noise is correlated for longer.
        freedom: Parameters of an effect.
        rivals: Effects that are tested.
        false_alarms: Wanted rate on recordings with nothing missing.
    """
    from scipy.stats import chi2, ncx2

    threshold = float(chi2.isf(false_alarms / rivals, freedom))
    energy = _INDEPENDENT * rows * enr**2
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

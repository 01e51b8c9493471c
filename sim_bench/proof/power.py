"""Power against strength beside the best possible detector's, and which answer came first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .figure import WEAK, count_share, where
from .judging import answer_of, right_first
from .plan import NULLS
from .score import Score
from .splits import band_of
from .statistics import ShareEstimate, oracle_power

__all__ = ["PowerPoint", "compute_confusion", "compute_power"]


_WEAKEST = 0.5  # ENR from which the confusion matrix counts


class PowerPoint(NamedTuple):
    """Single effects of about one strength.

    Attributes:
        band: Which strengths.
        enr: Median of them.
        detected: Not called consistent.
        named: Strongest name right.
        oracle: Mean power of the likelihood-ratio test on the same cases.
    """

    band: str
    enr: float
    detected: ShareEstimate
    named: ShareEstimate
    oracle: float


def compute_power(scores: Sequence[Score]) -> list[PowerPoint]:
    """Power against the strength that was reached over the single effects, weakest first.

    Parameters are no detection and stay out. Not every effect can have the strength that was wanted: a bristle that is
    soft enough to be called presliding may show at once.
    """
    single = where(scores, lambda s: s.group == "single" and s.expected != "parameters")
    points = []
    for band in {band_of(score): None for score in sorted(single, key=lambda s: s.enr)}:
        cases = where(single, lambda s, wanted=band: band_of(s) == wanted)  # type: ignore[misc]
        points.append(
            PowerPoint(
                band,
                float(np.median([s.enr for s in cases])),
                count_share(cases, lambda s: s.verdict not in ("consistent", "parameters", "failed")),
                count_share(cases, right_first),
                float(np.mean([oracle_power(s.enr, s.rows) for s in cases])),
            )
        )
    return points


def compute_confusion(scores: Sequence[Score]) -> dict[str, Counter[str]]:
    """For each single effect of ENR 0.5 or more, how often each answer came first.

    Answers without a name count as their verdict.
    """
    table: dict[str, Counter[str]] = {}
    for score in scores:
        if score.group in ("single", "outside", "injected", *NULLS) and (
            score.enr >= _WEAKEST * WEAK or not score.truth
        ):
            table.setdefault(score.truth or "(nothing)", Counter())[answer_of(score)] += 1
    return dict(sorted(table.items()))

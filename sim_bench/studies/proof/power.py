"""Power against strength beside the best possible detector's, and which answer came first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from .figure import WEAK, count_share, where
from .judging import answer_of, nameable
from .plan import NULLS
from .score import Score
from .splits import band_of
from .statistics import ShareEstimate, oracle_power

__all__ = ["PowerPoint", "compute_confusion", "compute_power"]


_WEAKEST = 0.5  # ENR from which the confusion matrix counts
_NOTHING = dict(zip(NULLS, ("(nothing)", "(nothing, load wrong)"), strict=True))
_CONFUSED = {"single": 0, "injected": 0, "outside": 1, "null": 2, "hard_null": 3}  # groups in their order


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
    """Power against the strength that was reached over the single effects that can be named, weakest first.

    Parameters are no detection and stay out. Not every effect can have the strength that was wanted: a bristle that is
    soft enough to be called presliding may show at once.
    """
    single = where(nameable(scores), lambda s: s.expected != "parameters")
    points = []
    for band in {band_of(score): None for score in sorted(single, key=lambda s: s.enr)}:
        cases = where(single, lambda s, wanted=band: band_of(s) == wanted)  # type: ignore[misc]
        points.append(
            PowerPoint(
                band,
                float(np.median([s.enr for s in cases])),
                count_share(cases, lambda s: s.verdict not in ("consistent", "parameters", "failed")),
                count_share(cases, lambda s: s.top_right),
                float(np.mean([oracle_power(s.enr, s.rows) for s in cases])),
            )
        )
    return points


def compute_confusion(scores: Sequence[Score]) -> dict[str, Counter[str]]:
    """For each single effect of ENR 0.5 or more, how often each answer came first: effects of the catalogue first, then
    those outside it, then joints with nothing missing.

    Answers without a name count as their verdict.
    """
    table: dict[str, Counter[str]] = {}
    for score in sorted(scores, key=lambda s: (_CONFUSED.get(s.group, 0), s.truth)):
        if score.group in _CONFUSED and (score.enr >= _WEAKEST * WEAK or not score.truth):
            table.setdefault(score.truth or _NOTHING[score.group], Counter())[answer_of(score)] += 1
    return table

"""Power against strength beside the best possible detector's, and which answer came first."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..kit.figure import WEAK, count_share, select
from ..kit.statistics import ShareEstimate
from .judging import find_first_answer, select_nameable
from .plan import NULLS
from .score import Score

_BANDS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)
"""Lower ends of the bands of strengths, as effect-to-noise ratios."""

_INDEPENDENT = 0.75
"""Share of the rows that count as independent: Hann windows that overlap by half share a sixth of white noise."""

_FREEDOM, _RIVALS, _FALSE_ALARMS = 2, 32, 0.02
"""Degrees of freedom of most effects, effects of the catalogue, and false alarms over all of them together."""
_WEAKEST = 0.5
"""Effect-to-noise ratio from which the confusion matrix counts."""

_NOTHING = dict(zip(NULLS, ("(nothing)", "(nothing, load wrong)"), strict=True))
_CONFUSED = {"single": 0, "injected": 0, "outside": 1, "null": 2, "hard_null": 3}
"""Groups of the confusion matrix, with their order."""


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
    single = select(select_nameable(scores), lambda s: s.expected != "parameters")
    points = []
    for band in {name_band(score): None for score in sorted(single, key=lambda s: s.enr)}:
        cases = select(single, lambda s, wanted=band: name_band(s) == wanted)  # type: ignore[misc]
        points.append(
            PowerPoint(
                band,
                float(np.median([s.enr for s in cases])),
                count_share(cases, lambda s: s.verdict not in ("consistent", "parameters", "failed")),
                count_share(cases, lambda s: s.top_right),
                float(np.mean([compute_oracle_power(s.enr, s.rows) for s in cases])),
            )
        )
    return points


def compute_confusion(scores: Sequence[Score]) -> dict[str, Counter[str]]:
    """For each single effect of ENR 0.5 or more, how often each answer came first.

    Effects of the catalogue stand first, then those outside it, then joints with nothing missing. Answers without a
    name count as their verdict.
    """
    table: dict[str, Counter[str]] = {}
    for score in sorted(scores, key=lambda s: (_CONFUSED.get(s.group, 0), s.truth)):
        if score.group in _CONFUSED and (score.enr >= _WEAKEST * WEAK or not score.truth):
            table.setdefault(score.truth or _NOTHING[score.group], Counter())[find_first_answer(score)] += 1
    return table


def name_band(score: Score) -> str:
    """The band of strengths that a score lies in; a band begins at 0.95 of its lower end."""
    lower = [end for end in _BANDS if score.enr >= WEAK * end]
    if not score.truth:
        return "nothing concealed"
    return f"ENR {lower[-1]:g} or more" if lower[-1:] == [_BANDS[-1]] else _name_between(len(lower))


def _name_between(place: int) -> str:
    return f"ENR {_BANDS[place - 1]:g} to {_BANDS[place]:g}" if place else f"ENR below {_BANDS[0]:g}"


def compute_oracle_power(enr: float, rows: int) -> float:
    """Power of the likelihood-ratio test that knows every effect's shape.

    The energy of an effect of strength `enr` over n independent rows is n enr²; its test statistic is chi-squared with
    that non-centrality, and two degrees of freedom as most effects have. The threshold keeps the false alarms over all
    32 effects of the catalogue together at 2 %.

    Args:
        enr: Effect-to-noise ratio after the refit of the base.
        rows: Rows of the recording; three quarters of them count. Hann windows that overlap by half share 1/6 of white
            torque noise, so that what changes slowly from row to row meets 1 + 2/6 of its variance; what changes
            quickly, and rows whose noise is the encoder's, meet less. Coloured torque noise is correlated for longer.
    """
    from scipy.stats import chi2, ncx2

    threshold = float(chi2.isf(_FALSE_ALARMS / _RIVALS, _FREEDOM))
    energy = _INDEPENDENT * rows * enr**2
    if energy == 0.0:
        return float(chi2.sf(threshold, _FREEDOM))
    if energy > 1e4:
        return 1.0
    return float(np.clip(ncx2.sf(threshold, _FREEDOM, energy), 0.0, 1.0))

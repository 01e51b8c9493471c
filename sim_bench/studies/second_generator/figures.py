"""Figures over all scores, each a share with its exact interval."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ..kit.belief import describe_beliefs
from ..kit.figure import count_share
from ..kit.statistics import ShareEstimate, compute_clustered_share
from .motion import MOTIONS
from .score import Score

_FILTER = "velocity_filter_lag"


class Figure(NamedTuple):
    """One line of the results.

    Attributes:
        name: What is counted.
        value: As counted, with its interval.
    """

    name: str
    value: str


def compute_figures(scores: Sequence[Score]) -> list[Figure]:
    """The figures, but for those without a case."""
    nothing = [s for s in scores if s.group == "nothing"]
    effects = [s for s in scores if s.hidden]
    outside = [s for s in scores if s.group == "outside"]
    shares = [
        ("something named, or another verdict, where nothing is missing", count_share(nothing, lambda s: s.wrong)),
        *(
            (f"right name or set first, {m} motion", _count_right([s for s in effects if s.case.motion == m]))
            for m in MOTIONS
        ),
        ("right name or set first, without a velocity", _count_right([s for s in effects if not s.case.velocity])),
        ("right name or set first, all of the catalogue", _count_right(effects)),
        ("a wrong name, where an effect of the catalogue is missing", count_share(effects, _misleads)),
        ("the same, parameters aside", count_share(effects, _misleads_beyond_parameters)),
        ("right verdict, where an effect of the catalogue is missing", count_share(effects, lambda s: s.verdict_right)),
        ("outside the catalogue called unknown", count_share(outside, lambda s: s.verdict_right)),
        ("a wrong name, outside the catalogue", count_share(outside, _misleads)),
        ("the same there, parameters aside", count_share(outside, _misleads_beyond_parameters)),
        ("95 % interval of a parameter holds the truth", _count_covered(scores)),
        ("filter of the recorded velocity named", count_share([s for s in scores if s.case.velocity], _names_filter)),
        ("no answer at all", count_share(scores, lambda s: s.verdict == "failed")),
    ]
    figures = [Figure(name, str(share)) for name, share in shares if share.total]
    beliefs = [each for score in scores for each in score.beliefs]
    figures += [Figure(*one) for one in describe_beliefs(beliefs, named=False)]
    seconds = np.quantile([s.seconds for s in scores], [0.25, 0.5, 0.75]) if scores else np.full(3, np.nan)
    time = f"median {seconds[1]:.0f} (quartiles {seconds[0]:.0f} to {seconds[2]:.0f}; {len(scores)} cases)"
    return [*figures, Figure("seconds of a diagnosis", time)]


def _count_right(scores: Sequence[Score]) -> ShareEstimate:
    return count_share(scores, lambda s: s.first_right)


def _misleads(score: Score) -> bool:
    return bool(score.false_names)


def _misleads_beyond_parameters(score: Score) -> bool:
    return bool(score.false_beyond_parameters)


def _names_filter(score: Score) -> bool:
    return score.filter_named


def _count_covered(scores: Sequence[Score]) -> ShareEstimate:
    """Of the parameters of what is missing, those of one case as a cluster; that of the filter is the same in all."""
    cases = [[value.covers for value in score.values if value.effect != _FILTER] for score in scores]
    return compute_clustered_share([sum(case) for case in cases], [len(case) for case in cases])

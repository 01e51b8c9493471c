"""Figures over all scores, each a share with its exact interval."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ..proof.statistics import ShareEstimate, compute_clustered_share, compute_share
from .motion import MOTIONS
from .score import Score

__all__ = ["Figure", "compute_figures"]

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
        ("something named, or another verdict, where nothing is missing", _share(nothing, lambda s: s.wrong)),
        *(
            (f"right name or set first, {m} motion", _right([s for s in effects if s.case.motion == m]))
            for m in MOTIONS
        ),
        ("right name or set first, without a velocity", _right([s for s in effects if not s.case.velocity])),
        ("right name or set first, all of the catalogue", _right(effects)),
        ("a wrong name, where an effect of the catalogue is missing", _share(effects, _misled)),
        ("the same, parameters aside", _share(effects, _misled_beyond_parameters)),
        ("right verdict, where an effect of the catalogue is missing", _share(effects, lambda s: s.verdict_right)),
        ("outside the catalogue called unknown", _share(outside, lambda s: s.verdict_right)),
        ("a wrong name, outside the catalogue", _share(outside, _misled)),
        ("the same there, parameters aside", _share(outside, _misled_beyond_parameters)),
        ("95 % interval of a parameter holds the truth", _coverage(scores)),
        ("filter of the recorded velocity named", _share([s for s in scores if s.case.velocity], _filtered)),
        ("no answer at all", _share(scores, lambda s: s.verdict == "failed")),
    ]
    figures = [Figure(name, str(share)) for name, share in shares if share.total]
    seconds = np.quantile([s.seconds for s in scores], [0.25, 0.5, 0.75]) if scores else np.full(3, np.nan)
    time = f"median {seconds[1]:.0f} (quartiles {seconds[0]:.0f} to {seconds[2]:.0f}; {len(scores)} cases)"
    return [*figures, Figure("seconds of a diagnosis", time)]


def _share(scores: Sequence[Score], hit: Callable[[Score], bool]) -> ShareEstimate:
    return compute_share(sum(map(hit, scores)), len(scores))


def _right(scores: Sequence[Score]) -> ShareEstimate:
    return _share(scores, lambda s: s.first_right)


def _misled(score: Score) -> bool:
    return bool(score.false_names)


def _misled_beyond_parameters(score: Score) -> bool:
    return bool(score.false_beyond_parameters)


def _filtered(score: Score) -> bool:
    return score.filter_named


def _coverage(scores: Sequence[Score]) -> ShareEstimate:
    """Of the parameters of what is missing, those of one case as a cluster; that of the filter is the same in all."""
    cases = [[value.covered for value in score.values if value.effect != _FILTER] for score in scores]
    return compute_clustered_share([sum(case) for case in cases], [len(case) for case in cases])

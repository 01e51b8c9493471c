"""All scores as figures: each with its target, its interval and its number of cases."""

from __future__ import annotations

from collections.abc import Sequence

from .figure import WEAK, Figure, at_least, at_most, count_share, coverage, mean, median, where
from .judging import count_for_names, count_for_pairs, holds, names_another, right_first
from .plan import NULLS
from .score import Score
from .splits import everywhere

__all__ = ["compute_figures"]

_ACCEPTED = ("consistent", "parameters")
_FLOOR = (0.95, 1.06)  # residual over noise where nothing is missing


def compute_figures(scores: Sequence[Score]) -> list[Figure]:
    """The figures of the proof, in the order of its targets; those of real noise where effects were injected."""
    injected = where(scores, lambda s: s.group == "injected")
    if injected or any(score.group == "injected_null" for score in scores):
        return _figures_of_injected(injected)
    single = where(scores, lambda s: s.group == "single")
    rich, fourier = count_for_names(scores, "rich", 0.2), count_for_names(scores, "fourier", 0.5)
    return [
        *_figures_of_nothing(where(scores, lambda s: s.group in NULLS)),
        at_least("right name, rich motion, ENR ≥ 0.2", 0.95, rich, right_first),
        at_least("right name, 60 s Fourier motion, ENR ≥ 0.5", 0.90, fourier, right_first),
        *_figures_of_sets(rich + fourier),
        at_least(
            "two effects, separable, ENR ≥ 0.3, both and nothing else",
            0.90,
            count_for_pairs(scores),
            lambda s: s.exact,
        ),
        *_figures_of_outside(where(scores, lambda s: s.group == "outside")),
        _without_target(
            at_least(
                "load or temperature not logged: right name or unknown, and no false name",
                0.0,
                where(scores, lambda s: s.group == "hidden"),
                lambda s: holds(s) and not s.false_names,
            )
        ),
        *_figures_of_place(single),
        *_figures_of_doubt(scores),
        *_figures_of_answers(scores, single),
    ]


def _without_target(figure: Figure) -> Figure:
    return figure._replace(target="–", reached=None)


def _figures_of_nothing(scores: Sequence[Score]) -> list[Figure]:
    low, high = _FLOOR
    target = f"{low}–{high}"
    named = at_most("named where nothing is missing", 0.02, scores, lambda s: s.false_names > 0, 0.04)
    apart = count_share(scores, lambda s: s.false_names > s.false_parameters)
    if scores and apart.hits != count_share(scores, lambda s: s.false_names > 0).hits:
        named = named._replace(value=f"{named.value}; without names of parameters {apart}")
    return [
        median(
            "residual over noise where nothing is missing",
            target,
            scores,
            lambda s: s.noise_ratio,
            lambda m: low <= m <= high,
        ),
        everywhere("the same, on every motion and with every friction core", scores, low, high),
        named,
        at_most(
            "something called missing, mismeasured or unknown where nothing is",
            0.02,
            scores,
            lambda s: s.verdict not in _ACCEPTED,
        ),
    ]


def _figures_of_injected(scores: Sequence[Score]) -> list[Figure]:
    """Effects in real recordings, apart for those that the diagnosis finds complete as they are."""
    figures = []
    for what, wanted in (("complete without it", True), ("with more missing already", False)):
        some = where(scores, lambda s, wanted=wanted: s.noise.endswith(_ACCEPTED) is wanted)  # type: ignore[misc]
        strong = where(some, lambda s: s.enr >= WEAK)
        figures += [
            at_least(f"right name, recording {what}, ENR ≥ 1", 0.95, strong, lambda s: s.top_right),
            at_least(f"printed set holds it, recording {what}, ENR ≥ 1", 0.97, strong, lambda s: s.in_set),
            at_most(f"a name that is wrong, recording {what}", 0.05, some, lambda s: s.false_names > 0),
        ]
    return [
        *figures,
        coverage("95 % interval of a parameter holds what was injected", scores, 0.0, 0.0),
        *_figures_of_cost(scores),
    ]


def _figures_of_sets(scores: Sequence[Score]) -> list[Figure]:
    return [
        at_least("printed set holds the truth, cases of the two rows above", 0.97, scores, holds),
        mean("names in a printed set", 1.5, where(scores, lambda s: s.set_size > 0.0), lambda s: s.set_size),
        at_most(
            "a wrong name that has the truth nowhere in its set, same cases",
            0.05,
            scores,
            lambda s: s.false_names > 0,
        ),
        _without_target(at_most("another name first, be the truth in its set or not", 1.0, scores, names_another)),
    ]


def _figures_of_outside(scores: Sequence[Score]) -> list[Figure]:
    seen = where(scores, lambda s: s.enr >= 1.0 * WEAK)
    return [
        at_least("outside the catalogue called unknown, ENR ≥ 1", 0.90, seen, lambda s: s.verdict_right),
        at_most("outside the catalogue given a false name", 0.05, scores, lambda s: s.false_names > 0),
    ]


def _figures_of_place(single: Sequence[Score]) -> list[Figure]:
    seen = where(single, lambda s: s.enr >= 0.5 * WEAK)
    name = "one effect: located time, overlap with the truth, 0 where no time is named"
    return [
        median(name, "≥ 0.7", single, lambda s: s.overlap, lambda m: m >= 0.7),
        median("the same, ENR ≥ 0.5", "–", seen, lambda s: s.overlap, lambda _: None),
    ]


def _figures_of_doubt(scores: Sequence[Score]) -> list[Figure]:
    """What "cannot tell" is worth: answers with a set of two names or more, and the motions that should settle it."""
    unsure, asked = where(scores, lambda s: s.printed > 0), where(scores, lambda s: s.proposed)
    unmade = sum(not score.recorded for score in asked)
    settled = at_least("proposed motion tells the set apart", 0.9, asked, lambda s: s.resolved)
    if unmade:
        settled = settled._replace(value=f"{settled.value}; {unmade} of them could not be recorded and count as no")
    return [
        at_least("cannot tell: every set of two or more holds a truth", 0.97, unsure, _sets_hold),
        _without_target(at_least("cannot tell: with a proposed motion", 0.0, unsure, lambda s: s.proposed)),
        settled,
    ]


def _sets_hold(score: Score) -> bool:
    return score.printed_right == score.printed


def _figures_of_answers(scores: Sequence[Score], single: Sequence[Score]) -> list[Figure]:
    right, faults = where(single, lambda s: s.top_right), where(scores, lambda s: s.group == "fault")
    return [
        median(  # the floor is never above the error that the answer leaves, so the value is near 1 whatever that is
            "held-out error above the diagnosis' own estimate of the noise, removed by the right name",
            "–",
            right,
            lambda s: s.gap_closed,
            lambda _: None,
        ),
        coverage("95 % interval of a parameter holds the truth", scores, 0.93, 0.97),
        at_least("faulty signal called bad data", 1.0, faults, lambda s: s.verdict == "bad_data"),
        *_figures_of_cost(scores),
    ]


def _figures_of_cost(scores: Sequence[Score]) -> list[Figure]:
    return [
        median("time of a case [s]", "≤ 30", scores, lambda s: s.seconds, lambda m: m <= 30.0),
        _without_target(at_most("cases that took longer", 1.0, scores, lambda s: s.seconds > 30.0)),
        at_most("no answer at all", 0.0, scores, lambda s: s.verdict == "failed"),
    ]

"""All scores as figures: each with its target, its interval and its number of cases."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from .figure import WEAK, Figure, at_least, at_most, count_share, coverage, mean, median, where
from .intervals import SIMULATION, KnownInterval
from .judging import count_for_names, count_for_pairs, holds, names_another, rightly_named, unnameable
from .plan import NULLS
from .score import Score
from .splits import everywhere
from .statistics import compute_clustered_share

__all__ = ["compute_figures"]

_ACCEPTED = ("consistent", "parameters")
_FAR = 2.0  # half widths of an interval
_FLOOR = (0.95, 1.06)  # residual over noise where nothing is missing


def compute_figures(scores: Sequence[Score]) -> list[Figure]:
    """The figures of the proof, in the order of its targets; those of real noise where effects were injected."""
    injected = where(scores, lambda s: s.group == "injected")
    if injected or any(score.group == "injected_null" for score in scores):
        return _figures_of_injected(injected)
    single = where(scores, lambda s: s.group == "single")
    rich, fourier = count_for_names(scores, "rich", 0.2), count_for_names(scores, "fourier", 0.5)
    topics = {
        "nothing missing": _figures_of_nothing(where(scores, lambda s: s.group in NULLS)),
        "names": [
            at_least("right name, rich motion, ENR ≥ 0.2", 0.95, rich, lambda s: s.top_right),
            at_least("right name, 60 s Fourier motion, ENR ≥ 0.5", 0.90, fourier, lambda s: s.top_right),
            *_figures_of_sets(rich + fourier),
            _figure_of_pairs(count_for_pairs(scores)),
        ],
        "what cannot be named": [
            *_figures_of_outside(where(scores, lambda s: s.group == "outside")),
            *_figures_of_unlogged(scores),
        ],
        "places": _figures_of_place(single),
        "what it cannot tell": _figures_of_doubt(scores),
        "parameters": _figures_of_intervals(scores),
        "answers": _figures_of_answers(scores),
    }
    return [figure._replace(topic=topic) for topic, figures in topics.items() for figure in figures]


def _figure_of_pairs(pairs: Sequence[Score]) -> Figure:
    found = at_least("two effects, separable, ENR ≥ 0.3, both and nothing else", 0.90, pairs, lambda s: s.exact)
    if not pairs:
        return found
    weaker = float(np.median([s.weakest_enr for s in pairs]))
    return found._replace(value=f"{found.value}; median ENR of the weaker {weaker:.1f}")


def _figures_of_unlogged(scores: Sequence[Score]) -> list[Figure]:
    """What can hardly be named, as a channel is missing for it."""
    hidden = where(scores, lambda s: s.group == "hidden")
    neighbours = where(unnameable(scores), lambda s: s.enr >= 0.5 * WEAK)
    what = {
        "load or temperature not logged: right name or unknown, and no false name": hidden,
        "motion of a neighbour not logged, ENR ≥ 0.5: called unknown or external, and no false name": neighbours,
    }
    figures = (at_least(name, 0.0, some, lambda s: holds(s) and not s.false_names) for name, some in what.items())
    return [_without_target(figure) for figure in figures]


def _without_target(figure: Figure) -> Figure:
    return figure._replace(target="–", reached=None)


def _figures_of_nothing(scores: Sequence[Score]) -> list[Figure]:
    low, high = _FLOOR
    target = f"{low}–{high}"
    named = at_most("false name where nothing is missing", 0.02, scores, lambda s: s.false_names > 0, 0.04)
    apart = count_share(scores, lambda s: s.false_names > s.false_parameters)
    if scores and apart.hits != count_share(scores, lambda s: s.false_names > 0).hits:
        named = named._replace(value=f"{named.value}; without names of parameters {apart}")
    return [
        median(
            "residual over the diagnosis' own noise where nothing is missing",
            target,
            scores,
            lambda s: s.noise_ratio,
            lambda m: low <= m <= high,
        ),
        everywhere("the same, median on every motion and with every friction core", scores, low, high),
        _without_target(
            at_most("the same, cases outside that range", 1.0, scores, lambda s: not low <= s.noise_ratio <= high)
        ),
        named,
        at_most(
            "something called missing, mismeasured or unknown where nothing is",
            0.02,
            scores,
            lambda s: s.verdict not in _ACCEPTED,
        ),
    ]


def _figures_of_injected(scores: Sequence[Score]) -> list[Figure]:
    """Effects in real recordings, apart for those that the diagnosis finds complete as they are; the cases of one
    recording are alike."""

    def recording(score: Score) -> str:
        return score.excitation

    figures = []
    for what, wanted in (("complete without it", True), ("with more missing already", False)):
        some = where(scores, lambda s, wanted=wanted: s.noise.endswith(_ACCEPTED) is wanted)  # type: ignore[misc]
        strong = where(some, lambda s: s.enr >= WEAK)
        figures += [
            at_least(f"right name, recording {what}, ENR ≥ 1", 0.95, strong, lambda s: s.top_right, recording),
            at_least(f"printed set holds it, recording {what}, ENR ≥ 1", 0.97, strong, lambda s: s.in_set, recording),
            at_most(
                f"a name that is wrong, recording {what}", 0.05, some, lambda s: s.false_names > 0, cluster=recording
            ),
        ]
    return [
        *figures,
        coverage("95 % interval of a parameter holds what was injected", scores, lambda each: True, cluster=recording),
        *_figures_of_cost(scores, recording),
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


def _figures_of_answers(scores: Sequence[Score]) -> list[Figure]:
    faults = where(scores, lambda s: s.group == "fault")
    return [
        at_least("faulty signal called bad data", 1.0, faults, lambda s: s.verdict == "bad_data"),
        *_figures_of_cost(scores),
    ]


def _figures_of_intervals(scores: Sequence[Score]) -> list[Figure]:
    """Parameters of effects that were named, and inertia and gravity that were found to be off."""
    named = where(scores, lambda s: bool(rightly_named(s)))
    far = compute_clustered_share(
        [sum(each.error > _FAR for each in s.intervals) for s in scores], [len(s.intervals) for s in scores]
    )
    name = f"intervals that miss the truth by more than {_FAR:g} half widths"
    return [
        coverage("95 % interval of an effect's parameter holds the truth", scores, _of_an_effect, 0.93, 0.97),
        coverage("the same, inertia and gravity of the simulation", scores, lambda each: not _of_an_effect(each)),
        Figure(name, "–", str(far), None, tuple(s for s in scores if s.intervals)),
        _without_target(
            at_least("answers with a right name of which a parameter is compared", 0.0, named, _compares_an_effect)
        ),
    ]


def _of_an_effect(each: KnownInterval) -> bool:
    return each.effect != SIMULATION


def _compares_an_effect(score: Score) -> bool:
    return any(map(_of_an_effect, score.intervals))


def _figures_of_cost(scores: Sequence[Score], cluster: Callable[[Score], str] | None = None) -> list[Figure]:
    long = at_most("cases that took longer than 30 s", 1.0, scores, lambda s: s.seconds > 30.0, cluster=cluster)
    return [
        _figure_of_time(scores),
        _without_target(long),
        at_most("no answer at all", 0.0, scores, lambda s: s.verdict == "failed", cluster=cluster),
    ]


def _figure_of_time(scores: Sequence[Score]) -> Figure:
    found = median("time of a case [s], median", "≤ 30", scores, lambda s: s.seconds, lambda m: m <= 30.0)
    if not scores:
        return found
    late, last = np.quantile([s.seconds for s in scores], [0.95, 1.0])
    return found._replace(value=f"{found.value}; 95 % of them within {late:.0f}, all within {last:.0f}")

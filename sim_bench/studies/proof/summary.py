"""All scores as figures: each with its target, its interval and its number of cases."""

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from ...cases import CHOICES
from ..kit.belief import describe_beliefs
from ..kit.figure import (
    WEAK,
    Figure,
    count_share,
    measure_coverage,
    measure_mean,
    measure_median,
    measure_share,
    require_at_least,
    require_at_most,
    select,
)
from ..kit.interval import KnownInterval
from ..kit.statistics import compute_clustered_share
from .judging import (
    count_for_names,
    count_for_pairs,
    find_right_names,
    holds_truth,
    names_another,
    select_unnameable,
)
from .plan import NULLS
from .score import SIMULATION, Score

_ACCEPTED = ("consistent", "parameters")
"""Verdicts that are right where nothing is missing."""

_FAR = 2.0
"""Half widths of an interval beyond which a truth lies far outside: 1 of 10,000 normal errors would."""

_FLOOR = (0.95, 1.06)
"""Wanted residual over the noise where nothing is missing: nothing smooth is left, and no noise is fitted."""


def compute_figures(scores: Sequence[Score]) -> list[Figure[Score]]:
    """The figures of the proof, in the order of its targets; those of real noise where effects were injected."""
    injected = select(scores, lambda s: s.group == "injected")
    if injected or any(score.group == "injected_null" for score in scores):
        return _measure_injected(injected)
    single = select(scores, lambda s: s.group == "single")
    rich, fourier = count_for_names(scores, "rich", 0.2), count_for_names(scores, "fourier", 0.5)
    topics = {
        "nothing missing": _measure_nothing(select(scores, lambda s: s.group in NULLS)),
        "names": [
            require_at_least("right name, rich motion, ENR ≥ 0.2", 0.95, rich, lambda s: s.top_right),
            require_at_least("right name, 60 s Fourier motion, ENR ≥ 0.5", 0.90, fourier, lambda s: s.top_right),
            *_measure_sets(rich + fourier),
            _measure_pairs(count_for_pairs(scores)),
        ],
        "what cannot be named": [
            *_measure_outside(select(scores, lambda s: s.group == "outside")),
            *_measure_unlogged(scores),
        ],
        "places": _measure_place(single),
        "what it cannot tell": _measure_doubt(scores),
        "parameters": _measure_intervals(scores),
        "probabilities": _measure_beliefs(scores),
        "answers": _measure_answers(scores),
    }
    return [replace(figure, topic=topic) for topic, figures in topics.items() for figure in figures]


def _measure_pairs(pairs: Sequence[Score]) -> Figure[Score]:
    found = require_at_least("two effects, separable, ENR ≥ 0.3, both and nothing else", 0.90, pairs, lambda s: s.exact)
    if not pairs:
        return found
    weaker = float(np.median([s.weakest_enr for s in pairs]))
    return replace(found, value=f"{found.value}; median ENR of the weaker {weaker:.1f}")


def _measure_unlogged(scores: Sequence[Score]) -> list[Figure[Score]]:
    """What can hardly be named, as a channel is missing for it."""
    hidden = select(scores, lambda s: s.group == "hidden")
    neighbours = select(select_unnameable(scores), lambda s: s.enr >= 0.5 * WEAK)
    what = {
        "load or temperature not logged: right name or unknown, and no false name": hidden,
        "motion of a neighbour not logged, ENR ≥ 0.5: called unknown or external, and no false name": neighbours,
    }
    return [measure_share(name, some, lambda s: holds_truth(s) and not s.false_names) for name, some in what.items()]


def _measure_nothing(scores: Sequence[Score]) -> list[Figure[Score]]:
    low, high = _FLOOR
    target = f"{low}–{high}"
    named = require_at_most("false name where nothing is missing", 0.02, scores, lambda s: s.false_names > 0, 0.04)
    apart = count_share(scores, lambda s: s.false_names > s.false_parameters)
    if scores and apart.hits != count_share(scores, lambda s: s.false_names > 0).hits:
        named = replace(named, value=f"{named.value}; without names of parameters {apart}")
    return [
        measure_median(
            "residual over the diagnosis' own noise where nothing is missing",
            target,
            scores,
            lambda s: s.noise_ratio,
            lambda m: low <= m <= high,
        ),
        _measure_everywhere(scores, low, high),
        measure_share("the same, cases outside that range", scores, lambda s: not low <= s.noise_ratio <= high),
        named,
        require_at_most(
            "something called missing, mismeasured or unknown where nothing is",
            0.02,
            scores,
            lambda s: s.verdict not in _ACCEPTED,
        ),
    ]


def _measure_injected(scores: Sequence[Score]) -> list[Figure[Score]]:
    """Effects in real recordings, apart for those that the diagnosis finds complete as they are; the cases of one
    recording are alike."""

    def recording(score: Score) -> str:
        return score.excitation

    figures = []
    for what, wanted in (("complete without it", True), ("with more missing already", False)):
        some = select(scores, lambda s, wanted=wanted: s.noise.endswith(_ACCEPTED) is wanted)  # type: ignore[misc]
        strong = select(some, lambda s: s.enr >= WEAK)
        figures += [
            require_at_least(f"right name, recording {what}, ENR ≥ 1", 0.95, strong, lambda s: s.top_right, recording),
            require_at_least(
                f"printed set holds it, recording {what}, ENR ≥ 1", 0.97, strong, lambda s: s.in_set, recording
            ),
            require_at_most(
                f"a name that is wrong, recording {what}", 0.05, some, lambda s: s.false_names > 0, cluster=recording
            ),
        ]
    return [
        *figures,
        measure_coverage(
            "95 % interval of a parameter holds what was injected", scores, lambda s: s.intervals, cluster=recording
        ),
        *_measure_cost(scores, recording),
    ]


def _measure_sets(scores: Sequence[Score]) -> list[Figure[Score]]:
    return [
        require_at_least("printed set holds the truth, cases of the two rows above", 0.97, scores, holds_truth),
        measure_mean("names in a printed set", 1.5, select(scores, lambda s: s.set_size > 0.0), lambda s: s.set_size),
        require_at_most(
            "a wrong name that has the truth nowhere in its set, same cases",
            0.05,
            scores,
            lambda s: s.false_names > 0,
        ),
        measure_share("another name first, be the truth in its set or not", scores, names_another),
    ]


def _measure_outside(scores: Sequence[Score]) -> list[Figure[Score]]:
    seen = select(scores, lambda s: s.enr >= 1.0 * WEAK)
    return [
        require_at_least("outside the catalogue called unknown, ENR ≥ 1", 0.90, seen, lambda s: s.verdict_right),
        require_at_most("outside the catalogue given a false name", 0.05, scores, lambda s: s.false_names > 0),
    ]


def _measure_place(single: Sequence[Score]) -> list[Figure[Score]]:
    seen = select(single, lambda s: s.enr >= 0.5 * WEAK)
    name = "one effect: located time, overlap with the truth, 0 where no time is named"
    return [
        measure_median(name, "≥ 0.7", single, lambda s: s.overlap, lambda m: m >= 0.7),
        measure_median("the same, ENR ≥ 0.5", "–", seen, lambda s: s.overlap, lambda _: None),
    ]


def _measure_doubt(scores: Sequence[Score]) -> list[Figure[Score]]:
    """What "cannot tell" is worth: answers with a set of two names or more, and the motions that should settle it."""
    unsure, asked = select(scores, lambda s: s.printed > 0), select(scores, lambda s: s.proposed)
    unmade = sum(not score.recorded for score in asked)
    settled = require_at_least("proposed motion tells the set apart", 0.9, asked, lambda s: s.resolved)
    if unmade:
        settled = replace(settled, value=f"{settled.value}; {unmade} of them could not be recorded and count as no")
    return [
        require_at_least("cannot tell: every set of two or more holds a truth", 0.97, unsure, _sets_hold),
        measure_share("cannot tell: with a proposed motion", unsure, lambda s: s.proposed),
        settled,
    ]


def _sets_hold(score: Score) -> bool:
    return score.printed_right == score.printed


def _measure_answers(scores: Sequence[Score]) -> list[Figure[Score]]:
    faults = select(scores, lambda s: s.group == "fault")
    return [
        require_at_least("faulty signal called bad data", 1.0, faults, lambda s: s.verdict == "bad_data"),
        *_measure_cost(scores),
    ]


def _measure_intervals(scores: Sequence[Score]) -> list[Figure[Score]]:
    """Parameters of effects that were named, and inertia and gravity that were found to be off."""
    named = select(scores, lambda s: bool(find_right_names(s)))
    far = compute_clustered_share(
        [sum(each.error > _FAR for each in s.intervals) for s in scores], [len(s.intervals) for s in scores]
    )
    name = f"intervals that miss the truth by more than {_FAR:g} half widths"
    return [
        measure_coverage(
            "95 % interval of an effect's parameter holds the truth", scores, _list_of_effects, 0.93, 0.97
        ),
        measure_coverage("the same, inertia and gravity of the simulation", scores, _list_of_simulation),
        Figure(name, "–", str(far), None, tuple(s for s in scores if s.intervals)),
        measure_share(
            "answers with a right name of which a parameter is compared", named, lambda s: bool(_list_of_effects(s))
        ),
    ]


def _measure_beliefs(scores: Sequence[Score]) -> list[Figure[Score]]:
    """Whether the probabilities hold: their Brier score, and how often each tenth of them was right."""
    some = select(scores, lambda s: bool(s.beliefs))
    beliefs = [each for score in some for each in score.beliefs]
    rows = describe_beliefs(beliefs, named=True)
    return [Figure(name, "–", value, None, tuple(some)) for name, value in rows]


def _list_of_effects(score: Score) -> list[KnownInterval]:
    return [each for each in score.intervals if each.effect != SIMULATION]


def _list_of_simulation(score: Score) -> list[KnownInterval]:
    return [each for each in score.intervals if each.effect == SIMULATION]


def _measure_cost(scores: Sequence[Score], cluster: Callable[[Score], str] | None = None) -> list[Figure[Score]]:
    return [
        _measure_time(scores),
        measure_share("cases that took longer than 30 s", scores, lambda s: s.seconds > 30.0, cluster),
        require_at_most("no answer at all", 0.0, scores, lambda s: s.verdict == "failed", cluster=cluster),
    ]


def _measure_time(scores: Sequence[Score]) -> Figure[Score]:
    found = measure_median("time of a case [s], median", "≤ 30", scores, lambda s: s.seconds, lambda m: m <= 30.0)
    if not scores:
        return found
    late, last = np.quantile([s.seconds for s in scores], [0.95, 1.0])
    return replace(found, value=f"{found.value}; 95 % of them within {late:.0f}, all within {last:.0f}")


def _measure_everywhere(scores: Sequence[Score], low: float, high: float) -> Figure[Score]:
    """Whether the median residual over noise lies in its range on each motion and with each core, none left out."""
    known = select(scores, lambda s: bool(np.isfinite(s.noise_ratio)))
    name, target = "the same, median on every motion and with every friction core", f"{low}–{high} each"
    if not known:
        return Figure(name, target, "– (no case)", None)
    medians, counts, missing = {}, [], []
    for field in ("excitation", "core"):
        for choice in CHOICES[field]:
            some = [s.noise_ratio for s in known if getattr(s, field) == choice]
            if some:
                medians[choice] = float(np.median(some))
                counts.append(len(some))
            else:
                missing.append(choice)
    if not medians:
        return Figure(name, target, "– (no case)", None)
    least, most = min(medians, key=lambda key: medians[key]), max(medians, key=lambda key: medians[key])
    value = f"{medians[least]:.3g} ({least}) to {medians[most]:.3g} ({most}); {min(counts)} cases or more for each"
    value += f"; none with {', '.join(missing)}" if missing else ""
    reached = not missing and low <= medians[least] and medians[most] <= high
    return Figure(name, target, value, reached, tuple(known), _format_middle)


def _format_middle(scores: Sequence[Score]) -> str:
    return f"{np.median([s.noise_ratio for s in scores]):.3g}"

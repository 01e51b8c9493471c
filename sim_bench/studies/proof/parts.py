"""Scores in parts: by group, friction core, motion, noise, strength, effect and recording, as rows of tables."""

from collections import Counter
from collections.abc import Callable, Iterable, Sequence

import numpy as np

from ..kit.figure import WEAK, count_share, group_by, select
from ..kit.statistics import compute_clustered_share
from .judging import count_for_names, count_for_pairs, find_right_names, is_wrong, names_another, select_nameable
from .plan import NULLS
from .power import name_band
from .score import Score

Rows = list[list[str]]

_WEAKEST = 0.5
"""Effect-to-noise ratio from which single effects are in the tables: weaker ones are hardly seen by anybody."""

_AXES: dict[str, Callable[[Score], str]] = {
    "friction core": lambda s: s.core,
    "motion": lambda s: s.excitation,
    "noise": lambda s: s.noise,
}


def list_groups(scores: Sequence[Score]) -> Rows:
    """Cases and wrong answers of each group, the largest first."""
    wrong = Counter(score.group for score in scores if is_wrong(score))
    groups = Counter(score.group for score in scores)
    return [[group, str(count), str(wrong[group])] for group, count in groups.most_common()]


def list_nothing(scores: Sequence[Score]) -> Rows:
    """Residual over noise and names of joints with nothing missing, by core, motion and noise."""
    rows = []
    for axis, value, some in _split(select(scores, lambda s: s.group in NULLS)):
        known = [s.noise_ratio for s in some if np.isfinite(s.noise_ratio)]
        middle, span = (f"{np.median(known):.3f}", f"{min(known):.2f} to {max(known):.2f}") if known else ("–", "–")
        rows.append([axis, value, str(len(some)), middle, span, str(sum(s.false_names > 0 for s in some))])
    return rows


def list_single(scores: Sequence[Score]) -> Rows:
    """Right names of single effects, by core, motion, noise and strength."""
    single = select(select_nameable(scores), lambda s: s.enr >= WEAK * _WEAKEST)
    parts = [*_split(single), *(("strength", band, some) for band, some in group_by(single, name_band))]
    return [[axis, value, str(count_share(some, lambda s: s.top_right))] for axis, value, some in parts]


def _split(scores: Sequence[Score]) -> list[tuple[str, str, list[Score]]]:
    return [(axis, value, some) for axis, key in _AXES.items() for value, some in group_by(scores, key)]


def list_recordings(scores: Sequence[Score]) -> Rows:
    """Right names in each recording and of each injected effect, from ENR 1."""
    strong = select(scores, lambda s: s.group == "injected" and s.enr >= WEAK)
    keys: dict[str, Callable[[Score], str]] = {"recording": lambda s: s.excitation, "effect": lambda s: s.truth}
    rows = []
    for what, key in keys.items():
        for value, some in group_by(strong, key):
            hits = (sum(s.top_right for s in some), sum(s.in_set for s in some))
            rows.append([what, value, *(f"{hit} of {len(some)}" for hit in hits)])
    return rows


def list_coverage(scores: Sequence[Score]) -> Rows:
    """Intervals of named parameters by effect, the least covered first.

    Effects that were named and of which nothing can be compared stand at the end.
    """
    effects = {each.effect for score in scores for each in score.intervals}
    if not effects:
        return []
    rows = sorted((_cover(name, scores) for name in effects), key=lambda row: (float(row[2].partition("%")[0]), row[0]))
    named = set().union(*map(find_right_names, scores)) - effects
    return [*rows, *([name, "0", "none", "–", "–", "–"] for name in sorted(named))]


def _cover(name: str, scores: Sequence[Score]) -> list[str]:
    cases = [some for score in scores if (some := [each for each in score.intervals if each.effect == name])]
    found = compute_clustered_share([sum(each.covers for each in some) for some in cases], [len(c) for c in cases])
    known = [each for some in cases for each in some if each.truth]
    widths = [0.5 * (each.high - each.low) / abs(each.truth) for each in known]
    return [
        name,
        str(len(cases)),
        f"{found.share:.0%} ({found.hits} of {found.total})",
        f"{found.low:.0%} to {found.high:.0%}",
        f"{np.median([each.relative_error for each in known]):.1%}" if known else "–",
        f"{np.median(widths):.1%}" if known else "–",
    ]


def list_places(scores: Sequence[Score]) -> Rows:
    """Overlap of the located time with the true one, by effect."""
    placed = select(scores, lambda s: s.group == "single" and bool(np.isfinite(s.overlap)))
    rows = []
    for name, some in group_by(placed, lambda s: s.truth):
        seen = [s for s in some if s.enr >= _WEAKEST * WEAK]
        rows.append([name, str(len(some)), _format_overlap(some), str(len(seen)), _format_overlap(seen)])
    return rows


def _format_overlap(scores: Sequence[Score]) -> str:
    values = [score.overlap for score in scores]
    return f"{np.median(values):.2f} ({min(values):.2f} to {max(values):.2f})" if values else "–"


def list_wrong(scores: Sequence[Score]) -> Rows:
    """Every wrong answer with the command that makes its case."""
    return _list_answers(select(scores, is_wrong))


def list_misses(scores: Sequence[Score]) -> Rows:
    """What a figure of names counts as not right though it is no wrong answer.

    These are weak effects without a name, right names that do not come first, on any motion, and pairs with one name
    too few.
    """
    named = [*count_for_names(scores, "rich", 0.2), *count_for_names(scores, "fourier", 0.5)]
    missed = [s for s in named if not s.top_right] + [s for s in count_for_pairs(scores) if not s.exact]
    missed += [s for s in select_nameable(scores) if names_another(s) and s not in missed]
    return _list_answers(score for score in missed if not is_wrong(score))


def _list_answers(scores: Iterable[Score]) -> Rows:
    return [
        [
            s.truth or "nothing",
            f"{s.enr:.2f}",
            s.named or s.verdict,
            s.sets.strip("+").replace("|", ", ") or "–",
            s.excitation,
            s.core,
            f"`{s.command}`",
        ]
        for s in scores
    ]

"""All scores as figures: each with its target, its interval and its number of cases."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from .plan import NULLS
from .score import Score
from .statistics import ShareEstimate, compute_share, oracle_power

__all__ = ["Figure", "PowerPoint", "compute_confusion", "compute_figures", "compute_power", "is_wrong"]

_ACCEPTED = ("consistent", "parameters")
_WEAK = 0.95  # of a wanted strength still counts as that strength


class Figure(NamedTuple):
    """One figure of the proof.

    Attributes:
        name: What is measured.
        target: What is wanted.
        value: As measured, with interval and number of cases.
        reached: Whether the target is; None where there is no case, or no target.
    """

    name: str
    target: str
    value: str
    reached: bool | None


class PowerPoint(NamedTuple):
    """Single effects of one wanted strength.

    Attributes:
        strength: Key of the strengths.
        enr: Median of the strengths reached.
        detected: Not called consistent.
        named: Strongest name right.
        oracle: Mean power of the likelihood-ratio test on the same cases.
    """

    strength: str
    enr: float
    detected: ShareEstimate
    named: ShareEstimate
    oracle: float


def _where(scores: Sequence[Score], wanted: Callable[[Score], bool]) -> list[Score]:
    return [score for score in scores if wanted(score)]


def _share(scores: Sequence[Score], hit: Callable[[Score], bool]) -> ShareEstimate:
    return compute_share(sum(map(hit, scores)), len(scores))


def _at_least(name: str, wanted: float, found: ShareEstimate) -> Figure:
    return Figure(name, f"≥ {wanted:.0%}", str(found), found.share >= wanted if found.total else None)


def _at_most(name: str, wanted: float, found: ShareEstimate, bound: float = 1.0) -> Figure:
    target = f"≤ {wanted:.0%}" + (f", upper bound ≤ {bound:.0%}" if bound < 1.0 else "")
    reached = found.share <= wanted and found.high <= bound if found.total else None
    return Figure(name, target, str(found), reached)


def _median(name: str, target: str, values: Sequence[float], reached: Callable[[float], bool]) -> Figure:
    known = [value for value in values if np.isfinite(value)]
    if not known:
        return Figure(name, target, "– (no case)", None)
    low, middle, high = np.quantile(known, [0.25, 0.5, 0.75])
    value = f"median {middle:.3g} (quartiles {low:.3g} to {high:.3g}; {len(known)} cases)"
    return Figure(name, target, value, reached(float(middle)))


def compute_figures(scores: Sequence[Score]) -> list[Figure]:
    """The figures of the proof, in the order of its targets; those of real noise where effects were injected."""
    injected = _where(scores, lambda s: s.group == "injected")
    if injected or any(score.group == "injected_null" for score in scores):
        return _figures_of_injected(injected)
    nothing = _where(scores, lambda s: s.group in NULLS)
    single = _where(scores, lambda s: s.group == "single")
    rich = _where(single, lambda s: s.excitation == "rich" and s.enr >= 0.2 * _WEAK)
    fourier = _where(single, lambda s: s.excitation == "fourier" and s.enr >= 0.5 * _WEAK)
    pairs = _where(scores, lambda s: s.group == "pair" and s.weakest_enr >= 0.3)
    return [
        *_figures_of_nothing(nothing),
        _at_least("right name, rich motion, ENR ≥ 0.2", 0.95, _share(rich, _right_first)),
        _at_least("right name, 60 s Fourier motion, ENR ≥ 0.5", 0.90, _share(fourier, _right_first)),
        *_figures_of_sets(rich + fourier),
        _at_least("two effects, separable, ENR ≥ 0.3, both and nothing else", 0.90, _share(pairs, lambda s: s.exact)),
        *_figures_of_outside(_where(scores, lambda s: s.group == "outside")),
        *_figures_of_answers(scores, single),
    ]


def _figures_of_nothing(scores: Sequence[Score]) -> list[Figure]:
    ratios = [score.noise_ratio for score in scores]
    return [
        _median("residual over noise where nothing is missing", "0.95–1.06", ratios, lambda m: 0.95 <= m <= 1.06),
        _at_most("named where nothing is missing", 0.02, _share(scores, lambda s: s.false_names > 0), 0.04),
        _at_most(
            "any verdict but consistent or parameters there",
            0.02,
            _share(scores, lambda s: s.verdict not in ("consistent", "parameters")),
        ),
    ]


def _figures_of_injected(scores: Sequence[Score]) -> list[Figure]:
    """Effects in real recordings, apart for those that the diagnosis finds complete as they are."""
    figures = []
    for what, wanted in (("complete without it", True), ("with more missing already", False)):
        some = _where(scores, lambda s, wanted=wanted: s.noise.endswith(_ACCEPTED) is wanted)  # type: ignore[misc]
        strong = _where(some, lambda s: s.enr >= _WEAK)
        figures += [
            _at_least(f"right name, recording {what}, ENR ≥ 1", 0.95, _share(strong, lambda s: s.top_right)),
            _at_least(f"printed set holds it, recording {what}, ENR ≥ 1", 0.97, _share(strong, lambda s: s.in_set)),
            _at_most(f"a name that is wrong, recording {what}", 0.05, _share(some, lambda s: s.false_names > 0)),
        ]
    coverage = compute_share(sum(s.covered for s in scores), sum(s.parameters for s in scores))
    seconds = [score.seconds for score in scores]
    return [
        *figures,
        Figure("95 % interval of a parameter holds what was injected", "–", str(coverage), None),
        _median("time of a case [s]", "≤ 30", seconds, lambda m: m <= 30.0),
        _at_most("no answer at all", 0.0, _share(scores, lambda s: s.verdict == "failed")),
    ]


def _figures_of_sets(scores: Sequence[Score]) -> list[Figure]:
    sizes = [score.set_size for score in scores if score.set_size > 0.0]
    mean = f"mean {np.mean(sizes):.2f} ({len(sizes)} cases)" if sizes else "– (no case)"
    return [
        _at_least("printed set holds the truth, these cases", 0.97, _share(scores, _holds)),
        Figure("names in a printed set", "≤ 1.5", mean, bool(np.mean(sizes) <= 1.5) if sizes else None),
        _at_most("a name that is wrong, these cases", 0.05, _share(scores, lambda s: s.false_names > 0)),
    ]


def _figures_of_outside(scores: Sequence[Score]) -> list[Figure]:
    seen = _where(scores, lambda s: s.enr >= 1.0 * _WEAK)
    return [
        _at_least("outside the catalogue called unknown, ENR ≥ 1", 0.90, _share(seen, lambda s: s.verdict_right)),
        _at_most("outside the catalogue given a false name", 0.05, _share(scores, lambda s: s.false_names > 0)),
    ]


def _figures_of_answers(scores: Sequence[Score], single: Sequence[Score]) -> list[Figure]:
    covered, compared = sum(s.covered for s in scores), sum(s.parameters for s in scores)
    coverage = compute_share(covered, compared)
    right = _where(single, lambda s: s.top_right)
    faults = _where(scores, lambda s: s.group == "fault")
    asked = _where(scores, lambda s: s.proposed)
    seconds = [score.seconds for score in scores]
    where = [score.overlap for score in single]
    seen = [score.overlap for score in single if score.enr >= 0.5 * _WEAK]
    return [
        _median("located time, overlap with the truth, 0 where no time is named", "≥ 0.7", where, lambda m: m >= 0.7),
        _median("the same, ENR ≥ 0.5", "–", seen, lambda _: True)._replace(reached=None),
        _above_own_noise(right),
        Figure(
            "95 % interval of a parameter holds the truth",
            "93–97 %",
            str(coverage),
            0.93 <= coverage.share <= 0.97 if compared else None,
        ),
        _at_least("proposed motion tells the set apart", 0.9, _share(asked, lambda s: s.resolved)),
        _at_least("faulty signal called bad data", 1.0, _share(faults, lambda s: s.verdict == "bad_data")),
        _median("time of a case [s]", "≤ 30", seconds, lambda m: m <= 30.0),
        _at_most("no answer at all", 0.0, _share(scores, lambda s: s.verdict == "failed")),
    ]


def _above_own_noise(right: Sequence[Score]) -> Figure:
    """No target: the floor is never above the error that the answer leaves, so the value is near 1 whatever that is."""
    name = "held-out error above the diagnosis' own estimate of the noise, removed by the right name"
    found = _median(name, "–", [score.gap_closed for score in right], lambda _: True)
    return found._replace(reached=None)


def compute_power(scores: Sequence[Score]) -> list[PowerPoint]:
    """Power against strength over the single effects, weakest first; parameters are no detection and stay out."""
    single = _where(scores, lambda s: s.group == "single" and s.expected != "parameters")
    points = []
    for strength in sorted(
        {s.strength for s in single}, key=lambda name: float("inf") if name == "clear" else float(name)
    ):
        cases = _where(single, lambda s, wanted=strength: s.strength == wanted)  # type: ignore[misc]
        points.append(
            PowerPoint(
                strength,
                float(np.median([s.enr for s in cases])),
                _share(cases, lambda s: s.verdict not in ("consistent", "parameters", "failed")),
                _share(cases, _right_first),
                float(np.mean([oracle_power(s.enr, s.rows) for s in cases])),
            )
        )
    return points


def compute_confusion(scores: Sequence[Score], weakest: float = 0.5) -> dict[str, Counter[str]]:
    """For each single effect of at least this strength, how often each answer came first.

    Answers without a name count as their verdict.
    """
    table: dict[str, Counter[str]] = {}
    for score in scores:
        if score.group in ("single", "outside", "injected", *NULLS) and (
            score.enr >= weakest * _WEAK or not score.truth
        ):
            answer = score.named.split("+")[0] or f"({score.verdict})"
            table.setdefault(score.truth or "(nothing)", Counter())[answer] += 1
    return dict(sorted(table.items()))


def is_wrong(score: Score) -> bool:
    """Whether the answer belongs in the list of wrong ones: a false name, a miss at ENR 0.5 or more, or none."""
    if score.group == "injected_null":  # nobody knows what is in it
        return score.verdict == "failed"
    if score.verdict == "failed" or score.false_names:
        return True
    if score.group in NULLS:
        return score.verdict not in ("consistent", "parameters")
    if score.group == "fault":
        return score.verdict != "bad_data"
    if score.group == "outside":
        return score.enr >= _WEAK and not score.verdict_right
    return score.weakest_enr >= 0.5 * _WEAK and not _holds(score)


def _right_first(score: Score) -> bool:
    """Whether the right answer came first: the name, or what is accepted for it where it cannot be known."""
    return score.top_right or _unnamed_but_right(score)


def _holds(score: Score) -> bool:
    """Whether the truth is in the printed set, or what is accepted for it was said."""
    return score.in_set or _unnamed_but_right(score)


def _unnamed_but_right(score: Score) -> bool:
    """Such as unknown where the motion of the neighbour is not logged."""
    return score.verdict_right and not score.named

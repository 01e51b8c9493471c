"""Scores by friction core, motion, noise and strength: what holds in the middle may fail on one of them."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from fricomp.report import format_markdown_table

from ...cases import CHOICES
from .figure import WEAK, Figure, count_share, where
from .judging import nameable
from .plan import NULLS
from .score import Score

__all__ = ["band_of", "everywhere", "format_splits"]

_BANDS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0)  # lower ends, in ENR
_WEAKEST = 0.5  # ENR from which single effects are in the table
_AXES: dict[str, Callable[[Score], str]] = {
    "friction core": lambda s: s.core,
    "motion": lambda s: s.excitation,
    "noise": lambda s: s.noise,
}


def band_of(score: Score) -> str:
    """The band of strengths that a score lies in; a band begins at 0.95 of its lower end."""
    lower = [end for end in _BANDS if score.enr >= WEAK * end]
    if not score.truth:
        return "nothing concealed"
    return f"ENR {lower[-1]:g} or more" if lower[-1:] == [_BANDS[-1]] else _between(len(lower))


def _between(place: int) -> str:
    return f"ENR {_BANDS[place - 1]:g} to {_BANDS[place]:g}" if place else f"ENR below {_BANDS[0]:g}"


def everywhere(name: str, scores: Sequence[Score], low: float, high: float) -> Figure:
    """Whether the median residual over noise lies in its range on each motion and with each core, none left out."""
    known = where(scores, lambda s: bool(np.isfinite(s.noise_ratio)))
    target = f"{low}–{high} each"
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
    return Figure(name, target, value, reached, tuple(known), _middle)


def _middle(scores: Sequence[Score]) -> str:
    return f"{np.median([s.noise_ratio for s in scores]):.3g}"


def format_splits(scores: Sequence[Score]) -> str:
    """A section of the page; empty where neither joints with nothing missing nor single effects are there."""
    nothing = where(scores, lambda s: s.group in NULLS)
    single = where(nameable(scores), lambda s: s.enr >= WEAK * _WEAKEST)
    if not nothing and not single:
        return ""
    parts = ["## By friction core, motion, noise and strength"]
    if nothing:
        rows = [_row_of_nothing(axis, value, some) for axis, value, some in _parts(nothing)]
        head = ["nothing missing", "", "cases", "residual over noise, median", "range", "named"]
        parts.append(format_markdown_table(head, rows))
    if single:
        banded = [("strength", band, some) for band, some in _group(single, band_of)]
        rows = [
            [axis, value, str(count_share(some, lambda s: s.top_right))]
            for axis, value, some in (*_parts(single), *banded)
        ]
        head = [f"one effect, ENR ≥ {_WEAKEST:g}", "", "right name first (95 % interval)"]
        parts.append(format_markdown_table(head, rows))
    return "\n\n".join(parts)


def _parts(scores: Sequence[Score]) -> list[tuple[str, str, list[Score]]]:
    return [(axis, value, some) for axis, key in _AXES.items() for value, some in _group(scores, key)]


def _group(scores: Sequence[Score], key: Callable[[Score], str]) -> list[tuple[str, list[Score]]]:
    return [(value, [s for s in scores if key(s) == value]) for value in sorted(set(map(key, scores)))]


def _row_of_nothing(axis: str, value: str, scores: Sequence[Score]) -> list[str]:
    known = [s.noise_ratio for s in scores if np.isfinite(s.noise_ratio)]
    middle, span = (f"{np.median(known):.3f}", f"{min(known):.2f} to {max(known):.2f}") if known else ("–", "–")
    return [axis, value, str(len(scores)), middle, span, str(sum(s.false_names > 0 for s in scores))]

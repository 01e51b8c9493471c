"""Scores by effect: whose intervals hold the truth, and which localised effects are found in time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.report import format_markdown_table

from .figure import WEAK, where
from .judging import rightly_named
from .score import Score
from .statistics import compute_clustered_share

__all__ = ["format_coverage", "format_places"]


def format_coverage(scores: Sequence[Score]) -> str:
    """A section of the page: intervals of named parameters by effect, the least covered first; empty for none.

    Effects that were named and of which nothing can be compared stand at the end.
    """
    known = [each for score in scores for each in score.intervals]
    effects = {each.effect for each in known}
    rows = [_coverage_row(name, scores) for name in effects]
    named = set().union(*map(rightly_named, scores)) - effects
    if not rows:
        return ""
    bare = [[name, "0", "none", "–", "–", "–"] for name in sorted(named)]
    head = ["effect", "cases", "intervals that hold the truth", "95 % interval", "relative error", "half width"]
    table = format_markdown_table(head, [*sorted(rows, key=_least_covered), *bare])
    return f"## Parameters by effect\n\nError and half width of the interval are medians, over the truth.\n\n{table}"


def _least_covered(row: Sequence[str]) -> tuple[float, str]:
    return float(row[2].partition("%")[0]), row[0]


def _coverage_row(name: str, scores: Sequence[Score]) -> list[str]:
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


def format_places(scores: Sequence[Score]) -> str:
    """A section of the page: overlap of the located time with the true one, by effect; empty for none."""
    placed = where(scores, lambda s: s.group == "single" and bool(np.isfinite(s.overlap)))
    if not placed:
        return ""
    rows = []
    for name in sorted({score.truth for score in placed}):
        some = [score.overlap for score in placed if score.truth == name]
        seen = [score.overlap for score in placed if score.truth == name and score.enr >= 0.5 * WEAK]
        rows.append([name, str(len(some)), _span(some), str(len(seen)), _span(seen)])
    head = ["localised effect", "cases", "overlap: median (range)", "ENR ≥ 0.5", "overlap: median (range)"]
    return f"## Where localised effects are found\n\n{format_markdown_table(head, rows)}"


def _span(values: Sequence[float]) -> str:
    return f"{np.median(values):.2f} ({min(values):.2f} to {max(values):.2f})" if values else "–"

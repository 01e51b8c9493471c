"""Scores by effect: whose intervals hold the truth, and which localised effects are found in time."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence

import numpy as np

from fricomp.report import format_markdown_table

from .figure import WEAK, where
from .score import Score
from .statistics import compute_clustered_share

__all__ = ["format_coverage", "format_places"]


def format_coverage(scores: Sequence[Score]) -> str:
    """A section of the page: intervals of named parameters by effect, the least covered first; empty for none."""
    found: dict[str, list[tuple[int, int]]] = defaultdict(list)
    for score in scores:
        for part in filter(None, score.coverage.split("+")):
            name, _, counts = part.partition(" ")
            covered, _, total = counts.partition("/")
            found[name].append((int(covered), int(total)))
    if not found:
        return ""
    rows = [_coverage_row(name, counts) for name, counts in sorted(found.items(), key=lambda each: _share(each[1]))]
    head = ["effect", "cases", "intervals that hold the truth", "95 % interval by cases"]
    return f"## Coverage by effect\n\n{format_markdown_table(head, rows)}"


def _share(counts: Sequence[tuple[int, int]]) -> float:
    return sum(covered for covered, _ in counts) / sum(total for _, total in counts)


def _coverage_row(name: str, counts: Sequence[tuple[int, int]]) -> list[str]:
    covered, total = zip(*counts, strict=True)
    found = compute_clustered_share(covered, total)
    value = f"{found.share:.0%} ({found.hits} of {found.total})"
    return [name, str(len(counts)), value, f"{found.low:.0%} to {found.high:.0%}"]


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

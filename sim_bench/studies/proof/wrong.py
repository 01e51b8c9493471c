"""Tables of the page: answers that are wrong, and misses that count in a figure without being wrong answers."""

from __future__ import annotations

from collections.abc import Sequence

from fricomp.report import format_markdown_table

from .figure import where
from .judging import count_for_names, count_for_pairs, is_wrong, nameable, names_another
from .score import Score

__all__ = ["format_misses", "format_wrong"]


def format_wrong(scores: Sequence[Score]) -> str:
    """A section of the page: every wrong answer with the design that makes its case."""
    wrong = where(scores, is_wrong)
    if not wrong:
        return "## Wrong answers\n\nNone."
    head = f"{len(wrong)} of {len(scores)} answers: a false name, a miss at ENR 0.5 or more, or no answer."
    return f"## Wrong answers\n\n{head}\n\n{_table(wrong)}"


def format_misses(scores: Sequence[Score]) -> str:
    """A section of the page: what a figure of names counts as not right though it is no wrong answer; empty for none.

    These are weak effects without a name, right names that do not come first, on any motion, and pairs with one name
    too few.
    """
    named = [*count_for_names(scores, "rich", 0.2), *count_for_names(scores, "fourier", 0.5)]
    missed = [s for s in named if not s.top_right] + [s for s in count_for_pairs(scores) if not s.exact]
    missed += [s for s in nameable(scores) if names_another(s) and s not in missed]
    others = [score for score in missed if not is_wrong(score)]
    if not others:
        return ""
    head = f"{len(others)} answers that are not wrong by the table above, and not right in a figure of names: weak "
    head += "effects without a name, a truth in a set but not first, pairs of which a weak part is not named."
    return f"## Other misses that count\n\n{head}\n\n{_table(others)}"


def _table(scores: Sequence[Score]) -> str:
    rows = [
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
    head = ["concealed", "ENR", "answer", "cannot be told from", "motion", "core", "makes the case"]
    return format_markdown_table(head, rows)

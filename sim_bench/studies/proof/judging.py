"""Which answers are right, which are wrong, and which cases a figure of names counts."""

from collections.abc import Sequence

from ..kit.figure import WEAK, select
from .plan import NULLS
from .score import Score

_UNLOGGED = "neighbour_coupling"
"""Nobody can name it: the motion of the neighbour is not logged."""


def select_nameable(scores: Sequence[Score]) -> list[Score]:
    """Single effects that can be named."""
    return select(scores, lambda s: s.group == "single" and s.truth != _UNLOGGED)


def select_unnameable(scores: Sequence[Score]) -> list[Score]:
    """Single effects that nobody can name."""
    return select(scores, lambda s: s.group == "single" and s.truth == _UNLOGGED)


def find_right_names(score: Score) -> set[str]:
    """The concealed effects that were named."""
    return set(score.truth.split("+")) & set(score.named.split("+")) - {""}


def find_first_answer(score: Score) -> str:
    """The name that came first, or the verdict in brackets.

    Where the right name came first, names of inertia and gravity that are off as well do not count.
    """
    names = score.named.split("+") if score.named else []
    if score.top_right:
        names = [name for name in names if name in score.truth.split("+")] or names
    return names[0] if names else f"({score.verdict})"


def names_another(score: Score) -> bool:
    """Whether another name than the right one came first, be the right one in its set or not."""
    return bool(score.named) and not score.top_right


def holds_truth(score: Score) -> bool:
    """Whether the truth is in the printed set, or unknown was said where a channel is missing to name it."""
    hidden = score.group == "hidden" or score.truth == _UNLOGGED
    return score.in_set or (hidden and score.verdict_right and not score.named)


def count_for_names(scores: Sequence[Score], motion: str, weakest: float) -> list[Score]:
    """Single effects that can be named, on this motion and of at least this strength."""
    return select(select_nameable(scores), lambda s: s.excitation == motion and s.enr >= WEAK * weakest)


def count_for_pairs(scores: Sequence[Score]) -> list[Score]:
    """Pairs of which either effect can be seen beside the other."""
    return select(scores, lambda s: s.group == "pair" and s.weakest_enr >= 0.3 * WEAK)


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
        return score.enr >= WEAK and not score.verdict_right
    return score.weakest_enr >= 0.5 * WEAK and not holds_truth(score)

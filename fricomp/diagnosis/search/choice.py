"""The choice among explanations: the smallest one that no larger one beats where its further effects can be seen."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from .explanation import Explanation, compute_evidence
from .preparation import Baseline

__all__ = ["ENOUGH", "choose", "rank_acceptable", "select_finalists"]

ENOUGH = 0.98  # coverage at which a generic basis sees nothing more
_ANOTHER = 0.08  # of the gain, that one more effect must add: less is the form of the first one not quite met
# Thresholds of gain, part of it, and part of what is left, of effects that complete an explanation.
_MUCH, _MATERIAL, _REMNANT = 3.0, 0.01, 0.3
_LOUD, _SILENCED = 0.2, 0.4  # part of the noise that is left beyond it, and part of that that may remain
# Coverage that it must add while a generic basis sees something, or part of what was not covered.
_WIDER, _OF_THE_REST = 0.015, 0.1
_UNTOUCHED, _APART = 0.3, 2.0  # noise of a row, and thresholds of evidence in rows that the first effects hardly reach
# Thresholds from which they count wherever they show, a bristle has been seen to bring 7; and part of the gain, where
# nothing says that they complete it.
_OVERWHELMING, _MOST = 10.0, 0.3
# What of its gain an explanation counts for that would fill in for others: pushes in windows of time for anything that
# comes and goes, a friction wave of any order for friction under a load that follows the position.
_FILLS_IN = {"external_disturbance": 0.8, "position_coulomb": 0.98}
_MORE_FORMS = {"load_quadratic": 0.998}  # the same for an effect that has a form nearly that of a simpler one
_NEAR, _FINALISTS = 0.1, 2  # of its gain that a rival may lack, and how many of them there are


def rank_acceptable(tried: Sequence[Explanation], threshold: float) -> list[Explanation]:
    """Explanations that are physical and stand out, best first."""
    passing = [e for e in tried if not e.refused and e.certain > threshold]
    return sorted(passing, key=lambda explanation: -_weigh(explanation))


def choose(prepared: Baseline, tried: Sequence[Explanation], threshold: float) -> Explanation | None:
    """The smallest explanation that no larger one beats by a material gain and coverage."""
    best: Explanation | None = None
    for size in (1, 2, 3):
        options = rank_acceptable([e for e in tried if len(e.names) == size], threshold)
        if not options:
            continue
        top = options[0]
        if (best is None or _is_better(prepared, top, best, threshold)) and not _is_idle(
            prepared, top, tried, threshold
        ):
            best = top
    return best


def _is_idle(prepared: Baseline, larger: Explanation, tried: Sequence[Explanation], threshold: float) -> bool:
    """Whether some of its effects explain about all alone, be they refused: the others would only carry them."""
    return any(
        set(part.names) < set(larger.names)
        and _weigh(larger) < _weigh(part) + _compute_worth(part, threshold)
        and not _can_complete(prepared, larger, part, threshold)
        and not _is_apart(prepared, larger, part, threshold)
        for part in tried
    )


def _is_better(prepared: Baseline, larger: Explanation, best: Explanation, threshold: float) -> bool:
    """Whether the further effects of a larger explanation add enough, and where they can be seen."""
    shown = compute_evidence(prepared, set(larger.names) - set(best.names), best.fit, larger.fit)
    more = _weigh(larger) - _weigh(best)
    if _can_complete(prepared, larger, best, threshold):
        return shown > threshold or more > max(_OVERWHELMING * threshold, _ANOTHER * best.gain)
    wider = best.coverage + min(_WIDER, _OF_THE_REST * (1.0 - best.coverage))
    visible = shown > max(threshold, _ANOTHER * best.certain)
    return (
        more > _compute_worth(best, threshold)
        and (visible or more > max(_OVERWHELMING * threshold, _MOST * best.gain))
        and larger.coverage > min(wider, ENOUGH)
    ) or _is_apart(prepared, larger, best, threshold)


def _is_apart(prepared: Baseline, larger: Explanation, part: Explanation, threshold: float) -> bool:
    """Whether its further effects show in rows that the first ones do not reach, so that no form of those makes them.

    A stop explains so much about the end of the range that little of all is left for friction elsewhere.
    """
    further = set(larger.names) - set(part.names)
    # What both leave unexplained is taken for noise: as much of it as they leave can be fitted by anything.
    needed = _APART * threshold * max(1.0, larger.fit.cost / larger.fit.residual.size)
    if _can_fill_in(further) or _weigh(larger) < _weigh(part) + needed:
        return False
    untouched = np.abs(part.compute_reach(prepared)) < _UNTOUCHED
    shown = compute_evidence(prepared, further, part.fit, larger.fit, at=untouched) if np.any(untouched) else 0.0
    return shown > needed


def _compute_worth(part: Explanation, threshold: float) -> float:
    """Gain that further effects must add: less is the form of the first ones not quite met."""
    return max(threshold, _ANOTHER * part.gain)


def _can_complete(prepared: Baseline, larger: Explanation, part: Explanation, threshold: float) -> bool:
    """Whether its further effects take away nearly all that is left, as none does of a form that is not quite met."""
    clear = _weigh(larger) > _weigh(part) + max(_MUCH * threshold, _MATERIAL * part.gain)
    takes_all = larger.left < _REMNANT * part.left or _can_silence(prepared, larger, part)
    fills_in = _can_fill_in(set(larger.names) - set(part.names))
    return clear and larger.coverage > ENOUGH and takes_all and not fills_in


def _can_silence(prepared: Baseline, larger: Explanation, part: Explanation) -> bool:
    """Whether most of what a part leaves beyond the noise goes, about reversals too, where no generic basis sees it."""
    noise = float(np.mean([null @ null for null in prepared.null_residuals]))
    before, after = (float(one.fit.residual @ one.fit.residual) - noise for one in (part, larger))
    return before > _LOUD * noise and after < _SILENCED * before


def _can_fill_in(names: Collection[str]) -> bool:
    """Whether any of these effects fills in for others."""
    return not _FILLS_IN.keys().isdisjoint(names)


def _weigh(explanation: Explanation) -> float:
    """Gain, less a share for effects that fill in for others, or have more forms than those."""
    shares = _FILLS_IN | _MORE_FORMS
    return explanation.gain * min(shares.get(name, 1.0) for name in explanation.names)


def select_finalists(best: Explanation, accepted: Sequence[Explanation]) -> list[Explanation]:
    """The chosen explanation and the rivals that the last steps could still bring before it."""
    near = [e for e in accepted if e is not best and e.gain > (1.0 - _NEAR) * best.gain]
    return [best, *sorted(near, key=lambda rival: -rival.gain)[:_FINALISTS]]

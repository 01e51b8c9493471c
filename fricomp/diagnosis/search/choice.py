"""The choice among explanations: the smallest one that no larger one beats where its further effects can be seen."""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from ..effects import EFFECTS
from .explanation import Explanation, compute_evidence
from .preparation import Baseline
from .settings import SEARCH


def rank_acceptable(tried: Sequence[Explanation], threshold: float) -> list[Explanation]:
    """Rank the explanations that are physical and stand out, best first."""
    passing = [e for e in tried if not e.refused and e.certain > threshold]
    return sorted(passing, key=lambda explanation: -_weigh(explanation))


def choose(baseline: Baseline, tried: Sequence[Explanation], threshold: float) -> Explanation | None:
    """Choose the smallest explanation that no larger one beats by a material gain and coverage."""
    best: Explanation | None = None
    for size in (1, 2, 3):
        options = rank_acceptable([e for e in tried if len(e.names) == size], threshold)
        if not options:
            continue
        for top in (e for e in options if e.names == options[0].names):  # any of the minima of these effects will do
            if (best is None or _is_better(baseline, top, best, threshold)) and not _is_idle(
                baseline, top, tried, threshold
            ):
                best = top
                break
    return best


def _is_idle(baseline: Baseline, larger: Explanation, tried: Sequence[Explanation], threshold: float) -> bool:
    """Tell whether some effects of an explanation explain nearly all alone, even if they were refused alone. The others
    would only carry them."""
    return any(
        set(part.names) < set(larger.names)
        and _weigh(larger) < _weigh(part) + _compute_worth(part, threshold)
        and not _can_complete(baseline, larger, part, threshold)
        and not _is_apart(baseline, larger, part, threshold)
        for part in tried
    )


def _is_better(baseline: Baseline, larger: Explanation, best: Explanation, threshold: float) -> bool:
    """Tell whether the further effects of a larger explanation add enough, where they can be seen.

    What takes less than half of what is left over is no nearer to it than something unknown would be.
    """
    shown = compute_evidence(baseline, set(larger.names) - set(best.names), best.fit, larger.fit)
    more = _weigh(larger) - _weigh(best)
    if _can_complete(baseline, larger, best, threshold):
        return shown > threshold or more > max(SEARCH.overwhelming * threshold, SEARCH.another_effect * best.gain)
    wider = best.coverage + min(SEARCH.wider_coverage, SEARCH.wider_share * (1.0 - best.coverage))
    visible = shown > max(threshold, SEARCH.another_effect * best.certain)
    return (
        more > _compute_worth(best, threshold)
        and (visible or more > max(SEARCH.overwhelming * threshold, SEARCH.overwhelming_share * best.gain))
        and larger.coverage > min(wider, SEARCH.enough)
        and larger.left < max(threshold, SEARCH.further_left * best.left)
    ) or _is_apart(baseline, larger, best, threshold)


def _is_apart(baseline: Baseline, larger: Explanation, part: Explanation, threshold: float) -> bool:
    """Tell whether its further effects show in rows that the first ones do not reach, so that no other form of those
    explains them.

    A stop explains so much about the end of the range that little of all is left for friction elsewhere.
    """
    further = set(larger.names) - set(part.names)
    # What both leave unexplained is taken for noise: as much of it as they leave can be fitted by anything.
    needed = SEARCH.apart * threshold * max(1.0, larger.fit.cost / larger.fit.residual.size)
    needed = max(needed, _compute_lacking(further, part))
    if _can_imitate(further) or _weigh(larger) < _weigh(part) + needed:
        return False
    untouched = np.abs(part.compute_reach(baseline)) < SEARCH.untouched
    shown = compute_evidence(baseline, further, part.fit, larger.fit, at=untouched) if np.any(untouched) else 0.0
    return shown > needed


def _compute_worth(part: Explanation, threshold: float) -> float:
    """Compute the gain that further effects must add. A smaller one may only correct the form of the first ones."""
    return max(threshold, SEARCH.another_effect * part.gain)


def _can_complete(baseline: Baseline, larger: Explanation, part: Explanation, threshold: float) -> bool:
    """Tell whether its further effects take away nearly all that is left. An effect that only corrects the form of
    another does not."""
    further = set(larger.names) - set(part.names)
    least = max(SEARCH.completing_gain * threshold, SEARCH.completing_share * part.certain)
    least = max(least, _compute_lacking(further, part))
    clear = _weigh(larger) > _weigh(part) + least
    takes_all = larger.left < SEARCH.completing_left * part.left or _can_silence(baseline, larger, part)
    return clear and larger.coverage > SEARCH.enough and takes_all and not _can_imitate(further)


def _compute_lacking(further: Collection[str], part: Explanation) -> float:
    """Compute the gain that the first ones' own law may lack, where the further effects are laws of the same kind, of
    friction under load; nothing else of what they add is seen."""
    own = any(EFFECTS[name].follows_load for name in part.names)
    alike = own and all(EFFECTS[name].follows_load for name in further)
    return SEARCH.law_lacks * part.gain if alike else 0.0


def _can_silence(baseline: Baseline, larger: Explanation, part: Explanation) -> bool:
    """Tell whether most of what a part leaves beyond the noise goes, also about reversals, where no generic basis sees
    it."""
    noise = float(np.mean([null @ null for null in baseline.null_residuals]))
    before, after = (float(one.fit.residual @ one.fit.residual) - noise for one in (part, larger))
    return before > SEARCH.loud_part * noise and after < SEARCH.silenced_part * before


def _can_imitate(names: Collection[str]) -> bool:
    """Whether any of these effects can imitate others."""
    return any(EFFECTS[name].imitates_others for name in names)


def _weigh(explanation: Explanation) -> float:
    """Gain, less a share for effects that can imitate others, or have more forms than those."""
    return explanation.gain * min(EFFECTS[name].gain_share for name in explanation.names)


def select_finalists(best: Explanation, accepted: Sequence[Explanation]) -> list[Explanation]:
    """Select the chosen explanation and the rivals that the last steps could still bring before it: those that gain
    nearly as much, and those that leave less with no more effects, whose fit did not come to its end."""
    others = [e for e in accepted if e is not best]
    near = [e for e in others if e.gain > (1.0 - SEARCH.rival_share) * best.gain or _leaves_less(e, best)]
    return [best, *sorted(near, key=lambda rival: -rival.gain)[: SEARCH.finalists]]


def _leaves_less(rival: Explanation, best: Explanation) -> bool:
    return len(rival.names) <= len(best.names) and rival.left < best.left

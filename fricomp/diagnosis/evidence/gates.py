"""Gates before a verdict: does an explanation cover the mismatch, do held-out data bear it out, is anything left?"""

from __future__ import annotations

from typing import NamedTuple

from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.search import SearchResult
from ..search.tone import Tone, find_tone
from .confirmation import Confirmation, confirm
from .settings import GATES

__all__ = ["Trial", "covers", "find_vibration", "is_confirmed", "put_to_trial", "stands_out"]


class Trial(NamedTuple):
    """The best explanation on held-out data.

    Attributes:
        chosen: It; None where there is none that covers the mismatch, or the held-out error does not fall for sure.
        failed: It, where the held-out error does not fall for sure; else None.
        held: Held-out errors with what was chosen; None where nothing was.
    """

    chosen: Explanation | None = None
    failed: Explanation | None = None
    held: Confirmation | None = None


def put_to_trial(baseline: Baseline, found: SearchResult, seed: int) -> Trial:
    """Confirm the best explanation, where it covers the mismatch and is what its names say: no one part that ripples
    torque and friction, no other curve over speed.

    Args:
        baseline: The base fitted to the recordings, with its nulls.
        found: Explanations, best first.
        seed: Of the bootstrap.
    """
    best = found.best
    if best is None or not covers(best, found, baseline) or best.common_order is not None or best.foreign_curve:
        return Trial()
    held = confirm(baseline, best.structure, best.fit, seed, given=best.before)
    sure = is_confirmed(held, best, found.threshold, baseline.measure_loudness(best.fit))
    return Trial(chosen=best, held=held) if sure else Trial(failed=best)


def covers(best: Explanation, found: SearchResult, baseline: Baseline) -> bool:
    """Whether little is left beside `best`: of what it explains, or of what would stand out by itself."""
    faint = max(GATES.faint_nulls * found.explainable_null, GATES.faint * baseline.fit.residual.size)
    clear = best.certain > GATES.clear * found.threshold
    if best.left < found.explainable_null:
        return best.coverage >= GATES.faintly_covered
    return best.coverage >= GATES.covered or (clear and best.coverage >= GATES.mostly_covered and best.left < faint)


def is_confirmed(held: Confirmation, chosen: Explanation, threshold: float, loudness: float) -> bool:
    """Whether the fall of the held-out error is sure, over blocks or, where few blocks show it, by its size, and
    what is left there is not both loud and much of what was to be explained.

    What leaves no more than noise where all blocks help to fit it has the right form, however loud one of them is that
    alone shows most of it.

    Args:
        held: Held-out errors.
        chosen: The explanation.
        threshold: Gain that an effect must exceed.
        loudness: What the explanation leaves of all rows, over the noise.
    """
    loud = held.rmse_after**2 > GATES.still_loud * held.noise_floor**2 and loudness > GATES.audible
    if loud and held.explained < GATES.explained:
        return False
    least = GATES.half if chosen.certain > GATES.overwhelming * threshold else GATES.explained
    rare = held.explained > least and chosen.certain > GATES.rare * threshold
    return held.ci95_reduction[0] > 0.0 or (rare and held.rmse_after < held.rmse_before)


def find_vibration(baseline: Baseline) -> Tone | None:
    """The strongest line in the spectrum of what the base leaves; None where nulls have such lines."""
    tone = find_tone(baseline)
    return tone if tone.energy > GATES.tone * tone.energy_null and tone.share > GATES.alone else None


def stands_out(found: SearchResult, baseline: Baseline) -> bool:
    """Whether something is missing that no accepted effect covers: it is smooth, or swings as no noise does."""
    rows, ratio = baseline.fit.residual.size, baseline.noise_ratio
    if baseline.structured and ratio > GATES.swinging:
        return True
    if ratio < GATES.audible or ratio > GATES.loudest:
        return ratio > GATES.loudest
    if found.explainable > max(GATES.smooth_nulls * found.explainable_null, GATES.smooth * rows, GATES.least_smooth):
        return True
    best = found.best
    return (
        ratio > GATES.loud
        and best is not None
        and best.gain > max(GATES.unknown_thresholds * found.threshold, GATES.unknown * rows)
    )

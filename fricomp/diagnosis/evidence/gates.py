"""Gates before a verdict: does an explanation cover the mismatch, do held-out data bear it out, is anything left?"""

from __future__ import annotations

from typing import NamedTuple

from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.search import SearchResult
from ..search.tone import Tone, find_tone
from .confirmation import Confirmation, confirm

__all__ = ["Trial", "covers", "find_vibration", "is_confirmed", "put_to_trial", "stands_out"]

_COVERED, _MOSTLY_COVERED = 0.88, 0.7
_FAINTLY_COVERED = 0.5  # where no more is left than nulls leave
_CLEAR = 1.5  # thresholds of gain that an explanation must reach which covers less
# Energy per row, and in that of the loudest nulls, that may be left where most is covered.
_FAINT, _FAINT_NULLS = 0.03, 3.0
# Energy that something unnamed must reach to be reported, in units of the noise: what a generic basis explains, per row
# and in all, and per row what an explanation does that is not named. Joints with nothing missing reach 0.06 of the
# first on few rows, and 70 in all.
_SMOOTH, _LEAST_SMOOTH, _UNKNOWN = 0.05, 110.0, 0.15
# Residual over noise that these must reach; beyond the last something is missing anyway. 98 of 100 joints with nothing
# missing stay below 1.07, those with noise of a long memory now and then reach 1.09.
_AUDIBLE, _LOUD, _LOUDEST = 1.09, 1.15, 1.25
_SWINGING = 1.04  # the same of what has lines or peaks over time that no null has
# Times the strongest line that a null shows, and share of what is beyond the noise, from which a line is a vibration.
_TONE, _ALONE = 2.5, 0.2
_EXPLAINED = 0.7  # on held-out data, of what shows in a few blocks only or leaves more than the next
_STILL_LOUD = 1.5  # energy over that of the noise
_MUCH = 3.0  # thresholds of gain of what shows in a few blocks only
_SURE, _HALF = 10.0, 0.5  # thresholds from which half of what was to be explained there is enough


class Trial(NamedTuple):
    """The best explanation on data that took no part.

    Attributes:
        chosen: It; None where there is none that covers the mismatch, or the held-out error does not fall for sure.
        failed: It, where the held-out error does not fall for sure; else None.
        held: Held-out errors with what was chosen; None where nothing was.
    """

    chosen: Explanation | None = None
    failed: Explanation | None = None
    held: Confirmation | None = None


def put_to_trial(prepared: Baseline, found: SearchResult, seed: int) -> Trial:
    """Confirm the best explanation, where it covers the mismatch and is what its names say: no one part that ripples
    torque and friction, no other curve over speed.

    Args:
        prepared: Base model and recordings.
        found: Explanations, best first.
        seed: Of the bootstrap.
    """
    best = found.best
    if best is None or not covers(best, found, prepared) or best.common_order is not None or best.foreign_curve:
        return Trial()
    held = confirm(prepared, best.structure, best.fit, seed, given=best.before)
    sure = is_confirmed(held, best, found.threshold, prepared.measure_loudness(best.fit))
    return Trial(chosen=best, held=held) if sure else Trial(failed=best)


def covers(best: Explanation, found: SearchResult, prepared: Baseline) -> bool:
    """Whether little is left beside `best`: of what it explains, or of what would stand out by itself."""
    faint = max(_FAINT_NULLS * found.explainable_null, _FAINT * prepared.fit.residual.size)
    clear = best.certain > _CLEAR * found.threshold
    if best.left < found.explainable_null:
        return best.coverage >= _FAINTLY_COVERED
    return best.coverage >= _COVERED or (clear and best.coverage >= _MOSTLY_COVERED and best.left < faint)


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
    loud = held.rmse_after**2 > _STILL_LOUD * held.noise_floor**2 and loudness > _AUDIBLE
    if loud and held.explained < _EXPLAINED:
        return False
    least = _HALF if chosen.certain > _SURE * threshold else _EXPLAINED
    rare = held.explained > least and chosen.certain > _MUCH * threshold
    return held.ci95_reduction[0] > 0.0 or (rare and held.rmse_after < held.rmse_before)


def find_vibration(prepared: Baseline) -> Tone | None:
    """The strongest line in the spectrum of what the base leaves; None where nulls have such lines."""
    tone = find_tone(prepared)
    return tone if tone.energy > _TONE * tone.energy_null and tone.share > _ALONE else None


def stands_out(found: SearchResult, prepared: Baseline) -> bool:
    """Whether something is missing that no accepted effect covers: it is smooth, or swings as no noise does."""
    rows, ratio = prepared.fit.residual.size, prepared.noise_ratio
    if prepared.structured and ratio > _SWINGING:
        return True
    if ratio < _AUDIBLE or ratio > _LOUDEST:
        return ratio > _LOUDEST
    if found.explainable > max(3.0 * found.explainable_null, _SMOOTH * rows, _LEAST_SMOOTH):
        return True
    best = found.best
    return ratio > _LOUD and best is not None and best.gain > max(4.0 * found.threshold, _UNKNOWN * rows)

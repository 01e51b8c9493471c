"""Gates before a verdict: does an explanation cover the mismatch, do held-out data bear it out, is anything left?"""

from __future__ import annotations

import numpy as np

from ..joint.base import BASE_NAMES, straighten_curves, unpack
from ..search.explanation import Explanation
from ..search.preparation import Baseline
from ..search.search import SearchResult
from ..search.settings import SEARCH
from ..search.tone import Tone, find_tone
from .confirmation import Confirmation
from .settings import GATES


def covers(best: Explanation, found: SearchResult, baseline: Baseline, slack: float = 0.0) -> bool:
    """Whether little is left beside `best`: of what it explains, or of what would stand out by itself; and no fewer
    effects explain clearly more with numbers that they cannot have. What is there is near to those then, as a ripple of
    one wave over the range is, and the others together only imitate it.

    Args:
        best: The explanation.
        found: What the search found.
        baseline: The base fitted to the recordings, with its nulls.
        slack: Coverage that it may lack.
    """
    if any(
        one.refused
        and len(one.names) < len(best.names)
        and one.gain > best.gain + SEARCH.clearly_better * found.threshold
        for one in found.explanations
    ):
        return False
    faint = max(GATES.faint_nulls * found.explainable_null, GATES.faint * baseline.fit.residual.size)
    clear = best.certain > GATES.clear * found.threshold
    if best.left < found.explainable_null:
        return best.coverage >= GATES.faintly_covered - slack
    covered = best.coverage + slack
    return covered >= GATES.covered or (clear and covered >= GATES.mostly_covered and best.left < faint)


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


def is_trifling(held: Confirmation, chosen: Explanation, baseline: Baseline) -> bool:
    """Whether no more goes from the plain held-out error, nor changes where the effects act, as a late torque does at
    reversals alone, than what a user would care about: the form of a friction that is not ours, a simulator's own
    arithmetic, or what happens between two samples, is as much."""
    plain, level = held.plain, _find_level(baseline)
    may_be_form = any(candidate.effect.like_friction for candidate in chosen.structure.candidates)
    part = level if baseline.nulls.quiet or may_be_form else GATES.heard * level
    return plain.size < GATES.trifle * part and plain.acting < GATES.material * part


def find_vibration(baseline: Baseline) -> Tone | None:
    """The strongest line in the spectrum of what the base leaves; None where nulls have such lines."""
    tone = find_tone(baseline)
    return tone if tone.energy > GATES.tone * tone.energy_null and tone.share > GATES.alone else None


def stands_out(found: SearchResult, baseline: Baseline, *, covered: bool = False) -> bool:
    """Whether something is missing that matters and that no accepted effect covers: it is smooth, or swings as no
    noise does.

    Args:
        found: What the search found.
        baseline: The base fitted to the recordings, with its nulls.
        covered: Whether effects of the catalogue cover it that lack something else for their names. What they cover is
            physics, however small, and no trace of an encoder.
    """
    rows, ratio = baseline.fit.residual.size, baseline.noise_ratio
    if not covered and not matters(baseline):
        return False
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


def measure_left(baseline: Baseline) -> tuple[float, float]:
    """Measure what the base leaves beyond the noise in a typical row: in [N·m] or [N], and in the Coulomb torque; all
    of it where the joint shows none."""
    left = float(np.sqrt(max(baseline.noise_ratio**2 - 1.0, 0.0))) * _measure_spread(baseline)
    level = _find_level(baseline)
    return left, left / level if level > 0.0 else np.inf


def matters(baseline: Baseline) -> bool:
    """Whether what the base leaves is more than the recordings can be trusted for: without noise a part of the friction
    that a user would care about, else more than the encoder's steps make, which are known but for their phase."""
    left, share = measure_left(baseline)
    if baseline.nulls.quiet:
        return share > GATES.material
    by_steps = float(np.sqrt(1.0 - baseline.nulls.of_torque)) * _measure_spread(baseline)
    return share > GATES.heard * GATES.material and left > GATES.phase * by_steps


def _find_level(baseline: Baseline) -> float:
    """Coulomb torque of the base [N·m] or [N]: of straight curves where friction that falls over all of the motion has
    taken its place."""
    theta = baseline.fit.theta[: len(BASE_NAMES)]
    straight = straighten_curves(theta, baseline.problem.usual_speed)
    return unpack(theta if straight is None else straight).level


def _measure_spread(baseline: Baseline) -> float:
    """Noise of a typical row [N·m] or [N]."""
    return float(np.median(np.concatenate(baseline.nulls.weights.spread)))

"""In which band a gear shows that gives way, or has a gap.

Noise of encoders grows with the square of the frequency, and looks like a load that follows its motor: such a gear is
gone in half of the band. A gap opens for moments, which a narrow band smears over into a gear that gives way.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ..arm_recording import ArmRecording
from ..equations import ArmEquations
from ..fit import ArmFit, fit_arm
from ..friction import GEARS, TERMS, JointForm
from ..prior import ArmPrior
from ..robust_fit import fit_robustly
from ..rows import ArmRows, build_rows
from ..search.gear import GAP, YIELDING_GEAR, GearSearch
from ..search.gear_motion import GearMotion
from ..search.judge import JointJudges
from .bandwidth import CUTOFFS, MOST_OF_RATE, begin_search, carry_over, is_long_enough, look_again

_OTHER, _SURELY = 1.5, 2.0
"""Ratio by which a gear that gives way must be surely stiffer or softer in half of the band, and standard deviations of
that. Of what noise makes look like one at 20 Hz a tenth is left at 10 Hz; gears that are there come as before."""

_EVIDENCE = 6.0
"""By how much a gap must be more probable in a wider band than where the gear was found, as all that is taken in."""

_NEARLY = 0.5
"""Part of the most that is seen in any band, from which one that is narrower, with less noise in it, does as well."""

_ROUNDS = 2
"""Of finding gaps, and what else the joints have beside them."""


def choose_lower(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, recording: ArmRecording, prior: ArmPrior
) -> tuple[ArmRows, ArmEquations] | None:
    """Rows in half of the band, where a gear that gives way is surely another one there, or none.

    Args:
        rows: At the cutoff at which it was found.
        equations: Of these rows.
        fit: What was found.
        recording: Of the joints.
        prior: How far the simulation is trusted.
    """
    cutoff = rows.cutoff / 2.0
    if cutoff < CUTOFFS[0] or not any(YIELDING_GEAR in form.names for form in fit.model.forms):
        return None
    fresh = build_rows(fit.arm, recording, cutoff, rows.late)
    if not is_long_enough(fresh, recording):
        return None
    look = look_again(fresh, equations, fit, prior)
    if not any(_is_other(look.fit, j) for j in range(len(fit.arm.joints))):
        return None
    prompt = fresh.with_delay(0.0)
    return begin_search(fit.arm, look._replace(rows=prompt))


class BandFit(NamedTuple):
    """What is seen at another cutoff of things that a narrow band hides.

    Attributes:
        gain: How much more probable they make the recording.
        rows: At this cutoff.
        equations: With them.
        fit: Of these equations.
    """

    gain: float
    rows: ArmRows
    equations: ArmEquations
    fit: ArmFit


def find_gaps(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, recording: ArmRecording, prior: ArmPrior
) -> BandFit | None:
    """Gaps in place of gears that give way, and in place of narrower ones, in the wider band that asks most for them.

    Nothing else is sought there: noise of encoders, of which a wider band has more, would be taken for something.

    Args:
        rows: At the cutoff at which gears were found.
        equations: Of these rows.
        fit: What was found.
        recording: Of the joints.
        prior: How far the simulation is trusted.
    """
    if not fit.model.geared:
        return None
    seen = [
        _fit_gaps(build_rows(fit.arm, recording, one, rows.late), equations, fit, prior)
        for one in CUTOFFS
        if rows.cutoff <= one <= MOST_OF_RATE / recording.period
    ]
    return choose_gain(seen[1:], seen[0].gain) if seen else None


def choose_gain(seen: Sequence[BandFit], known: float) -> BandFit | None:
    """The narrowest band that shows things nearly as well as any; None where none does better than what is known.

    Args:
        seen: In wider bands, narrowest first.
        known: How much more probable they make the recording in the band that was chosen.
    """
    best = max((one.gain for one in seen), default=0.0)
    if best < known + _EVIDENCE:
        return None
    return next(one for one in seen if one.gain >= max(_NEARLY * best, known + _EVIDENCE))


def _fit_gaps(rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> BandFit:
    """Gaps at other rows, in joints whose gear is known not to be rigid."""
    forms = fit.model.forms
    rigid = tuple(JointForm(tuple(term for term in form.terms if TERMS[term[0]].filled not in GEARS)) for form in forms)
    bare = carry_over(rows, equations, fit, ("spring",))
    without, seen = fit_robustly(fit.arm, rows, bare, replace(fit.model, forms=rigid), prior)
    search, gapped = GearSearch(GearMotion(rows, without), "gap"), without
    for _ in range(_ROUNDS):
        seen = search.propose(seen, gapped, prior, JointJudges(seen, gapped))
        own = [form.geared and gap[1] > 0.0 for form, gap in zip(forms, seen.gears["gap"], strict=True)]
        if not any(own):
            return BandFit(0.0, rows, seen, without)
        pairs = [
            (bare.with_term(GAP, 0), bare) if has else (form, form)
            for form, bare, has in zip(forms, rigid, own, strict=True)
        ]
        with_gaps, without_gaps = (replace(fit.model, forms=tuple(each)) for each in zip(*pairs, strict=True))
        gapped, seen = fit_robustly(fit.arm, rows, seen, with_gaps, prior, gapped)
    gain = gapped.log_evidence - fit_arm(fit.arm, seen, without_gaps, prior, gapped).log_evidence
    return BandFit(gain, rows, seen, gapped)


def _is_other(fit: ArmFit, joint: int) -> bool:
    """Whether the gear of a joint that gives way is surely stiffer or softer than it was taken to be."""
    if YIELDING_GEAR not in fit.model.forms[joint].names:
        return False
    place, names = fit.find_friction(joint)
    at = place.start + names.index(TERMS[YIELDING_GEAR].names(0)[0])
    share, spread = float(fit.x[at]), _SURELY * float(np.sqrt(fit.covariance[at, at]))
    return share + spread < 1.0 / _OTHER or share - spread > _OTHER

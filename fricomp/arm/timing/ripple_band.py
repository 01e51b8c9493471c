"""In which band a wave of torque over the position shows: fast joints pass it beyond a narrow one."""

from __future__ import annotations

import numpy as np

from ..arm_recording import ArmRecording
from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit
from ..glance import Glance
from ..prior import ArmPrior
from ..rigid.inertia import N_INERTIA
from ..robust_fit import fit_robustly
from ..rows import ArmRows, build_rows
from ..search.ripple import propose_ripples
from .bandwidth import CUTOFFS, MOST_DEARER, MOST_OF_RATE, carry_over
from .gear_band import BandFit, choose_gain

_RIPPLE = "cogging"

_EVIDENCE = 6.0
"""By how much a wave must make the recording more probable, as all that is taken in."""

_LEAST_FALL = 0.1
"""Part by which it must lower what is left of its joint, as what is named does: for less, no noisier band is taken. The
steps of a coarse encoder come again over the position as well."""


def find_ripples(
    rows: ArmRows, equations: ArmEquations, fit: ArmFit, recording: ArmRecording, prior: ArmPrior
) -> BandFit | None:
    """Waves beside what was found, in a wider band where one shows; None where none does.

    Nothing else is sought there: noise of encoders, of which a wider band has more, would be taken for something.

    Args:
        rows: At the cutoff that was chosen.
        equations: Of these rows.
        fit: What was found.
        recording: Of the joints.
        prior: How far the simulation is trusted.
    """
    wider = [one for one in CUTOFFS if rows.cutoff < one <= MOST_OF_RATE / recording.period]
    seen = [_fit_ripples(build_rows(fit.arm, recording, one, rows.late), equations, fit, prior) for one in wider]
    return choose_gain([one for one in seen if _compare_links(one.fit, fit) <= MOST_DEARER], 0.0)


def _compare_links(one: ArmFit, other: ArmFit) -> float:
    """Logarithm of how much larger deviations of links and rotors are, in the mean of those that are told."""
    rigid = slice(N_INERTIA * len(other.arm.links) + len(other.arm.joints))
    wide, narrow = (np.diag(fit.covariance)[rigid] for fit in (one, other))
    known = float(np.sum(1.0 - narrow / other.prior_deviation[rigid] ** 2))
    return float(np.sum(0.5 * np.log(wide / narrow))) / max(known, 1.0)


def _fit_ripples(rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> BandFit:
    """Waves at other rows, one joint after the other."""
    there, seen = fit_robustly(fit.arm, rows, carry_over(rows, equations, fit), fit.model, prior)
    total = 0.0
    while True:
        seen = propose_ripples(rows, seen, there)
        glance = Glance(seen, there, prior)
        gains = {model: glance.measure_gain(model) for model in _add_ripple(there.model)}
        best = max(gains, key=lambda one: gains[one], default=None)
        if best is None or gains[best] < _EVIDENCE:
            return BandFit(total, rows, seen, there)
        waving, weighed = fit_robustly(fit.arm, rows, seen, best, prior, there)
        if np.min(weighed.weights.noise / seen.weights.noise) > 1.0 - _LEAST_FALL:
            return BandFit(total, rows, seen, there)
        total, there, seen = total + gains[best], waving, weighed


def _add_ripple(model: ArmModel) -> list[ArmModel]:
    """The model with a wave more, in each joint that has none."""
    return [
        model.with_form(j, form.with_term(_RIPPLE, 0))
        for j, form in enumerate(model.forms)
        if _RIPPLE not in form.names
    ]

"""Up to which frequency motion and torque are compared: structure that rings above it is no friction.

The cutoff is the one at which the recording fixes the parameters best, all that is left being noise. What is missing in
a joint is such noise as well until it is found; the cutoff that is right with it may be another than that without.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from fricomp.errors import IdentificationError
from fricomp.laws import FloatArray

from ..arm_recording import ArmRecording
from ..coordinates import ArmModel
from ..encoder_noise import is_blurred
from ..equations import ArmEquations, build_equations
from ..fit import ArmFit, fit_arm
from ..friction import GEARS, Filled
from ..prior import ArmPrior
from ..rigid.simulated_arm import SimulatedArm
from ..robust_fit import fit_robustly
from ..rows import ArmRows, build_rows
from ..search.gear import GearSearch
from ..search.gear_motion import GearMotion

CUTOFFS = (1.25, 2.5, 5.0, 10.0, 20.0)
"""[Hz] that are tried."""

MOST_OF_RATE = 0.2
"""Highest cutoff, as part of the sample rate."""

_FELL = 0.5
"""Part of its noise that is left of a joint, from which on what was found in it may ask for another cutoff."""

MOST_DEARER = 0.1
"""Part by which standard deviations may be larger in a wider band, on average. There a ripple, a gap or a delay shows
that a narrow one hides."""

_MOST_SETTLING = 0.25
"""Part of the recording that filters may take to settle: of a few seconds, links and friction hold whatever is missing,
so that what is left is no measure of a band."""

_CLEARLY = 6.0
"""By how much the logarithm of the parameters' volume must fall at a higher cutoff: e³ in their standard deviations."""


class BandLook(NamedTuple):
    """What a cutoff is worth.

    Attributes:
        volume: Logarithm of the volume of the parameters' covariance.
        known: How many parameters the recording tells, those that it tells in part counting as such.
        rows: At this cutoff.
        equations: As they were fitted.
        fit: Of these equations.
    """

    volume: float
    known: float
    rows: ArmRows
    equations: ArmEquations
    fit: ArmFit


def choose_rows(
    arm: SimulatedArm, recording: ArmRecording, model: ArmModel, prior: ArmPrior
) -> tuple[ArmRows, ArmEquations]:
    """Rows at the highest cutoff at which the parameters' covariance has nearly the least volume.

    All that is left counts as noise.

    Args:
        arm: The simulation.
        recording: Of its joints.
        model: Plain.
        prior: How far the simulation is trusted.

    Raises:
        IdentificationError: No cutoff leaves enough rows.
    """
    looks: list[BandLook] = []
    for cutoff in CUTOFFS:
        if looks and cutoff > MOST_OF_RATE / recording.period:
            break
        rows = build_rows(arm, recording, cutoff)
        if len(rows) < 3 * len(arm.joints):
            continue
        bare = build_equations(arm, rows, rows.links @ arm.inertia.ravel(), plain=True)
        looks.append(_look(arm, rows, bare, model, prior))
    if not looks:
        raise IdentificationError(f"the recording of {recording.duration:.3g} s is too short for an arm")
    long_enough = [one for one in looks if is_long_enough(one.rows, recording)] or looks[-1:]
    clear = [one for one in long_enough if not _is_blurred(one)] or long_enough[:1]
    best = min(clear, key=lambda one: one.volume)
    most = best.volume + 2.0 * MOST_DEARER * best.known
    return begin_search(arm, [one for one in clear if one.volume <= most][-1])


def _is_blurred(look: BandLook) -> bool:
    return is_blurred(look.rows, look.fit, look.equations.weights.noise)


def is_long_enough(rows: ArmRows, recording: ArmRecording) -> bool:
    """Whether filters that settle leave most of a recording."""
    kept = sum(float(np.ptp(rows.time[rows.part == k])) for k in np.unique(rows.part))
    return kept >= (1.0 - _MOST_SETTLING) * recording.duration


def choose_again(
    rows: ArmRows,
    equations: ArmEquations,
    fit: ArmFit,
    recording: ArmRecording,
    prior: ArmPrior,
    noise: FloatArray,
) -> tuple[ArmRows, ArmEquations] | None:
    """Rows at another cutoff, where what was found leaves so much less that it fixes the parameters better there.

    A gear asks for no higher one than it was found at. But in a band that was chosen while something else was most of
    what is left, the steps of the encoders may be most of it now: torques that follow accelerations less than those
    steps do look like a gear that gives way.

    Args:
        rows: At the cutoff that was chosen.
        equations: Of these rows.
        fit: What was found.
        recording: Of the joints.
        prior: How far the simulation is trusted.
        noise: What a plain model left of each joint at that cutoff [N·m] or [N]. Shape (n_joints,).
    """
    if not np.any(equations.weights.noise < _FELL * noise):
        return None
    geared = fit.model.geared
    most = MOST_OF_RATE / recording.period
    others = [one for one in CUTOFFS if (one < rows.cutoff if geared else rows.cutoff < one <= most)]
    looks: list[BandLook] = []
    for cutoff in (rows.cutoff, *others) if others else ():
        fresh = build_rows(fit.arm, recording, cutoff)
        if looks and not is_long_enough(fresh, recording):
            continue
        look = look_again(fresh, equations, fit, prior)
        if not looks or cutoff < rows.cutoff or not _is_blurred(look):
            looks.append(look)
    best = min(looks, key=lambda one: one.volume, default=None)
    least = 0.0 if geared else _CLEARLY  # the name of a gear hangs on it
    return begin_search(fit.arm, best) if best is not None and best.volume < looks[0].volume - least else None


def look_again(rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> BandLook:
    """The same of what was found at other rows."""
    return _look(fit.arm, rows, carry_over(rows, equations, fit), fit.model, prior)


def carry_over(rows: ArmRows, equations: ArmEquations, fit: ArmFit, gears: Sequence[Filled] = GEARS) -> ArmEquations:
    """The equations at other rows, with the waves and gears that were found.

    Args:
        rows: At which they are built.
        equations: That hold what was found.
        fit: Of these equations.
        gears: What of gears is taken over.
    """
    bare = build_equations(fit.arm, rows, fit.compute_load(rows)).with_ripple(rows, equations.ripple)
    for filled in gears if fit.model.geared else ():
        bare = GearSearch(GearMotion(rows, fit), filled).build(bare, equations.gears[filled])
    return bare


def _look(arm: SimulatedArm, rows: ArmRows, bare: ArmEquations, model: ArmModel, prior: ArmPrior) -> BandLook:
    fit, equations = fit_robustly(arm, rows, bare, model, prior)
    whole = equations.with_residuals(fit.residuals(equations), rows, robust=False)
    fit = fit_arm(arm, whole, model, prior, fit)
    size = np.sqrt(np.diag(fit.covariance))
    volume = float(np.linalg.slogdet(fit.covariance / np.outer(size, size))[1]) + 2.0 * float(np.sum(np.log(size)))
    known = fit.x.size - float(np.sum(size**2 / fit.prior_deviation**2))
    return BandLook(volume, known, rows, equations, fit)


def begin_search(arm: SimulatedArm, look: BandLook) -> tuple[ArmRows, ArmEquations]:
    """Equations with all columns, and the weights of a look."""
    rows = look.rows
    return rows, replace(build_equations(arm, rows, rows.links @ arm.inertia.ravel()), weights=look.equations.weights)

"""Torques brought to the time of the positions: by how much all of them are late, found and taken off."""

from __future__ import annotations

import numpy as np

from ..arm_recording import ArmRecording
from ..coordinates import ArmModel
from ..equations import ArmEquations
from ..fit import ArmFit
from ..prior import ArmPrior
from ..rigid.simulated_arm import SimulatedArm
from ..robust_fit import fit_robustly
from ..rows import ArmRows, build_rows
from ..search.early_torque import EarlyTorques
from ..search.shared_delay import SharedDelay, measure_delay, measure_seen
from .bandwidth import CUTOFFS, is_long_enough, look_again

_ROUNDS = 6
"""Of the search for a delay."""

_HOLD, _SURELY = 0.5, 2.0
"""Of a sample's period, by which torques may be ahead of the positions without more: a command acts from its row to the
next, in the mean half a period after it, and no row is known to be of one instant. Standard deviations by which a delay
must be beyond that to be further: that of a command is half a period, and comes out on either side of it."""

_LESS = 3.5
"""Standard deviations by which torques must be less early in a narrower band than in the whole to be taken for prompt:
as many as whatever is taken in has."""


def take_off_delay(
    recording: ArmRecording,
    rows: ArmRows,
    equations: ArmEquations,
    model: ArmModel,
    prior: ArmPrior,
    start: float,
    arm: SimulatedArm,
) -> tuple[ArmRows, ArmEquations, SharedDelay, bool]:
    """Rows in which the torques are as early as the positions, and the delay that was taken off.

    Torques are not taken to be further ahead of the positions than a held command is where friction turns before its
    joints do, which looks like it; nor ahead at all where a gear gives way, which does so too; nor where a narrower
    band tells another time.
    Whether a delay is sure is seen where it stands still: on the way there, each joint shows another part of its own.

    Returns:
        The last tells whether the time is held where the rows have it: they look early, and are taken to be prompt, or
        joints differ so surely that the one whose torque tells most would have its own time taken for that of all.
    """
    total, found, moved, before, held = start, SharedDelay(start, 0.0, {}), 0.0, 0.0, -_HOLD * recording.period
    for _ in range(_ROUNDS):  # settled: a joint that sticks turns later than it would
        fit, equations = fit_robustly(arm, rows, equations, model, prior, settled=True)
        more = measure_delay(equations, fit, prior)
        ahead = total + more.value < 0.0
        beyond, early = total + more.value + _SURELY * more.deviation < held, EarlyTorques(rows, equations, fit)
        if beyond and not (early.are_all(total + fit.delay[0]) and _is_lasting(recording, rows, equations, fit, prior)):
            at = held if early.are_held(total + fit.delay[0]) else 0.0
            return *move_torques(rows, equations, at), more.move(total, at - total), True
        still = abs(more.value) < 0.5 * more.deviation
        moved = 0.0 if still else more.value / measure_seen(more.value, before, moved)
        before = more.value
        found = more.move(total, moved)
        if still:
            break
        total = found.value
        rows, equations = move_torques(rows, equations, total)
    if found.is_sure or not total:
        return rows, equations, found, found.is_torn or (ahead and not total)
    least = found.take_least()
    return *move_torques(rows, equations, least.value), least, found.is_torn or (ahead and not least.value)


def _is_lasting(recording: ArmRecording, rows: ArmRows, equations: ArmEquations, fit: ArmFit, prior: ArmPrior) -> bool:
    """Whether torques that look early do so in narrower bands as well: a time is the same at all frequencies.

    What moves a joint and is not in the model, such as a gap that is crossed or the steps of an encoder, is answered by
    its loop, whose torque is ahead of that by which links answer it, and the more so the wider the band is.
    """
    found = measure_delay(equations, fit, prior)
    for cutoff in (one for one in reversed(CUTOFFS) if one < rows.cutoff):
        fresh = build_rows(fit.arm, recording, cutoff, rows.late)
        if not is_long_enough(fresh, recording):
            break
        look = look_again(fresh, equations, fit, prior)
        lower = measure_delay(look.equations, look.fit, prior)
        less = lower.value - found.value > _LESS * float(np.hypot(lower.deviation, found.deviation))
        if less and rows.late + lower.value + _SURELY * lower.deviation > -_HOLD * recording.period:
            return False
    return True


def move_torques(rows: ArmRows, equations: ArmEquations, delay: float) -> tuple[ArmRows, ArmEquations]:
    """Rows and equations of torques that are taken to be late by this [s]."""
    moved = rows.with_delay(delay)
    return moved, equations.with_torque(moved)

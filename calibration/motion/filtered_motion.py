"""A motion that was low-passed before it was recorded, as drives filter their velocity: it is late by no mere delay."""

from dataclasses import replace

import numpy as np

from fricomp.errors import IdentificationError

from ..identification import Status
from ..identification.doubt import doubted
from .identify import MotionIdentification
from .joint_samples import JointSamples, RegressionSettings
from .rigid_body import fit_rigid_body

_LATE = 0.01
"""Lag of the motion behind the torque that no bus explains [s]."""
_TIME_CONSTANTS = tuple(np.geomspace(0.6, 4.0, 12).tolist())
"""Time constants to try, in lags: a delay that is fitted to a low-pass is shorter than its time constant."""
_BETTER = 0.8
"""Residual with the torque low-passed alike over that with it delayed, below which the motion was low-passed."""


def find_motion_filter(samples: JointSamples, settings: RegressionSettings, lag: float) -> float | None:
    """Cutoff of the low-pass that the motion went through before it was recorded [Hz]; None where none shows.

    A torque that is low-passed in the same way, by a filter of the first order, fits the motion then better than one
    that is delayed. A slow motion does not tell one from the other, and does not need to.

    Args:
        samples: As they were recorded.
        settings: Whether gravity acts.
        lag: How late the torque was found to come, negative where it comes early [s].
    """
    if lag > -_LATE:
        return None
    constants = [-lag * factor for factor in _TIME_CONSTANTS]
    torques = [samples.recorded.torque_after(lag), *map(samples.recorded.low_passed_torque, constants)]
    rows = samples.sliding(settings.slowest, bends=False)
    try:
        fits = [fit_rigid_body(replace(samples, torque=one), gravity=settings.gravity, rows=rows) for one in torques]
    except IdentificationError:
        return None
    delayed, *filtered = (fit.residual for fit in fits)
    best = int(np.argmin(filtered))
    return 1.0 / (2.0 * np.pi * constants[best]) if filtered[best] < _BETTER * delayed else None


def doubt_for_filter(motion: MotionIdentification, cutoff: float) -> MotionIdentification:
    """The motion with its friction in doubt, which a low-pass has smeared.

    Args:
        motion: As identified with a delay.
        cutoff: Of the low-pass [Hz].
    """
    message = (
        f"the motion comes {-1e3 * motion.lag.value:.2g} ms after the torque, as by a low-pass of some {cutoff:.2g} Hz "
        "and not by a delay: so do velocities that a drive filters, and motors behind which a gear has a gap; the "
        "inertia and the bend of friction at low speed are smeared by it: record the position, or the velocity before "
        "its filter; where it was no filter, 'fricomp diagnose' looks for what it is"
    )
    return replace(motion, friction=doubted(motion.friction, Status.NOT_IDENTIFIABLE, message))

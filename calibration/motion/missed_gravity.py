"""Gravity that acts on a joint and was not asked for: friction and inertia would hold it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fricomp.errors import IdentificationError

from ..identification import Status
from ..identification.doubt import doubted
from .joint_samples import JointSamples, RegressionSettings
from .rigid_body import MotionIdentification, fit_rigid_body

__all__ = ["with_gravity_doubt"]

_HEAVY = 0.5
"""What gravity must leave unexplained, over what is so without it, where it is missed; cogging leaves more."""
_SURE = 4.0
"""Standard deviations that such a gravity must have."""


def with_gravity_doubt(
    motion: MotionIdentification, samples: JointSamples, settings: RegressionSettings, flag: str
) -> MotionIdentification:
    """The motion with its friction in doubt, where gravity was not asked for and explains most of what is left.

    Args:
        motion: Identified without gravity.
        samples: Of a rotary joint.
        settings: As it was identified.
        flag: What stands before the name of an argument, such as `--` on the command line.
    """
    if settings.gravity:
        return motion
    rows = samples.sliding(settings.slowest, bends=False)
    try:
        without, heavy = (fit_rigid_body(samples, gravity=gravity, rows=rows) for gravity in (False, True))
    except IdentificationError:
        return motion
    size = float(np.hypot(*heavy.gravity))
    if heavy.residual > _HEAVY * without.residual or size < _SURE * max(heavy.gravity_deviations):
        return motion
    unit = motion.friction.model.torque_unit
    message = (
        f"the torque holds {size:.4g} {unit} that goes with sine and cosine of the angle, as gravity does, and "
        f"friction would hold it: without gravity {without.residual:.2g} of the torque is unexplained, with it "
        f"{heavy.residual:.2g}; say {flag}gravity"
    )
    return replace(motion, friction=doubted(motion.friction, Status.NOT_IDENTIFIABLE, message))

"""Gravity that acts on a joint and is not fitted: friction and inertia would hold it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import IdentificationError

from ..identification import Status
from ..identification.doubt import doubted
from .joint_samples import JointSamples, RegressionSettings
from .rigid_body import MotionIdentification, fit_rigid_body

__all__ = ["HEAVY", "SURE", "MissedGravity", "doubt_for_gravity", "find_missed_gravity"]

HEAVY = 0.5
"""What gravity or a spring that is missed leaves unexplained, over what is so without it. Cogging leaves more."""
SURE = 4.0
"""Standard deviations that it must have."""


@dataclass(frozen=True)
class MissedGravity:
    """Gravity that a fit without it misses.

    Attributes:
        size: Its largest torque [N·m].
        without: Part of the torque that is unexplained without it.
        left: The same with it.
    """

    size: float
    without: float
    left: float

    def describe(self, unit: str) -> str:
        """Say how gravity shows, in half a sentence."""
        return (
            f"the torque holds {self.size:.4g} {unit} that goes with sine and cosine of the angle, as gravity does: "
            f"without gravity {self.without:.2g} of the torque is unexplained, with it {self.left:.2g}"
        )


def find_missed_gravity(samples: JointSamples, settings: RegressionSettings) -> MissedGravity | None:
    """Find gravity that explains most of what a fit without it leaves; None where there is none, or it is fitted.

    Args:
        samples: Of a rotary joint.
        settings: As it is to be identified.
    """
    if settings.gravity:
        return None
    rows = samples.sliding(settings.slowest, bends=False)
    try:
        without, heavy = (fit_rigid_body(samples, gravity=gravity, rows=rows) for gravity in (False, True))
    except IdentificationError:
        return None
    size = float(np.hypot(*heavy.gravity))
    if heavy.residual > HEAVY * without.residual or size < SURE * max(heavy.gravity_deviations):
        return None
    return MissedGravity(size, without.residual, heavy.residual)


def doubt_for_gravity(motion: MotionIdentification, missed: MissedGravity, flag: str) -> MotionIdentification:
    """The motion with its friction in doubt, which holds gravity that was not to be fitted.

    Args:
        motion: Identified without gravity.
        missed: What it misses.
        flag: What stands before the name of an argument, such as `--` on the command line.
    """
    message = f"{missed.describe(motion.friction.model.torque_unit)}, and friction would hold it; say {flag}gravity"
    return replace(motion, friction=doubted(motion.friction, Status.NOT_IDENTIFIABLE, message))

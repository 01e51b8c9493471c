"""A spring that pulls at a joint: no part of the law, inertia and friction would hold it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fricomp.errors import IdentificationError

from ..identification import Status
from ..identification.doubt import doubted
from .joint_samples import JointSamples, RegressionSettings
from .missed_gravity import HEAVY, SURE
from .rigid_body import MotionIdentification, fit_rigid_body

__all__ = ["MissedSpring", "doubt_for_spring", "find_missed_spring"]


@dataclass(frozen=True)
class MissedSpring:
    """A spring that a fit without it misses.

    Attributes:
        stiffness: [N·m/rad] or [N/m].
        without: Part of the torque that is unexplained without it.
        left: The same with it.
    """

    stiffness: float
    without: float
    left: float


def find_missed_spring(samples: JointSamples, settings: RegressionSettings) -> MissedSpring | None:
    """Find a spring that explains most of what a fit without it leaves; None where there is none.

    Args:
        samples: Filtered samples.
        settings: As it is to be identified, gravity included, which over a short way looks alike.
    """
    rows = samples.sliding(settings.slowest, bends=False)
    try:
        without, sprung = (
            fit_rigid_body(samples, gravity=settings.gravity, spring=spring, rows=rows) for spring in (False, True)
        )
    except IdentificationError:
        return None
    stiffness, deviation = sprung.stiffness
    if sprung.residual > HEAVY * without.residual or abs(stiffness) < SURE * deviation:
        return None
    return MissedSpring(stiffness, without.residual, sprung.residual)


def doubt_for_spring(motion: MotionIdentification, missed: MissedSpring) -> MotionIdentification:
    """The motion with its friction in doubt, which holds what the spring does.

    Args:
        motion: Identified without the spring.
        missed: What it misses.
    """
    model = motion.friction.model
    unit = f"{model.torque_unit}/{'rad' if model.motion == 'rotary' else 'm'}"
    message = (
        f"the torque follows the position like a spring of {missed.stiffness:.4g} {unit}: without it "
        f"{missed.without:.2g} of the torque is unexplained, with it {missed.left:.2g}; inertia and friction hold a "
        "part of it here: take 'fricomp diagnose', whose model has a spring"
    )
    return replace(motion, friction=doubted(motion.friction, Status.NOT_IDENTIFIABLE, message))

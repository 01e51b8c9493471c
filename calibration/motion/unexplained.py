"""Torque that neither rigid body nor friction explains, and that is no noise: other physics is in the recording."""

from dataclasses import replace

import numpy as np

from fricomp.control.compensation.trust import find_doubt_in_status

from ..identification import Status
from ..identification.doubt import doubted
from .identify import MotionIdentification
from .joint_samples import RecordedMotion

_MUCH = 0.05
"""Root mean square of what is unexplained over that of the friction, from which on its intervals do not hold. Of 20
simulated joints with nothing else in them none had more than 0.01; with gaps or elastic gears up to 0.5, and the curves
were off by up to 1.2 times the part. Public recordings have 0.02 (EMPS, a UR10e's base) to 0.5 (under load)."""

_SOME = 0.015
"""The same from which on it is told. Rigid joints, and such with a gear of 20,000 N·m/rad between 0.05 kg·m² on either
side, had up to 0.0025 in twelve simulated recordings. A gear of 500 N·m/rad with 0.03 to 0.045 bent the curve by up to
0.12 at low speed, a gap of 1 mrad with 0.02 by up to 0.007."""


def measure_unexplained(motion: MotionIdentification, recorded: RecordedMotion) -> float:
    """Root mean square of what is unexplained beyond the noise of torque and acceleration, over the friction's."""
    of_acceleration = motion.rigid_body.inertia * recorded.acceleration_noise
    left = motion.friction.noise.level**2 - of_acceleration**2 - recorded.torque_noise**2
    return float(np.sqrt(max(left, 0.0) / max(float(np.mean(motion.points[:, 1] ** 2)), 1e-300)))


def doubt_for_unexplained(motion: MotionIdentification, recorded: RecordedMotion) -> MotionIdentification:
    """The motion with its intervals in doubt where much of its torque is of something else; else as it is."""
    part = measure_unexplained(motion, recorded)
    if part < _MUCH or find_doubt_in_status(motion.friction.status, "") is not None:
        return motion
    message = (
        f"{100.0 * part:.2g} % as much as the friction is left of the torque and is no noise: something else acts, "
        "such as a gap, an elastic gear, cogging or friction under load, and the curve may be off by as much, which "
        "its intervals do not hold: 'fricomp diagnose' looks for what it is"
    )
    return replace(motion, friction=doubted(motion.friction, Status.LACK_OF_FIT, message))


def tell_unexplained(motion: MotionIdentification, recorded: RecordedMotion) -> list[str]:
    """What to know of torque that is left where it is too little to doubt the intervals for it."""
    part = measure_unexplained(motion, recorded)
    if not _SOME <= part < _MUCH:
        return []
    return [
        f"Careful: {100.0 * part:.2g} % as much as the friction is left of the torque and is no noise. A gear that "
        "twists, a gap, cogging or friction under load does that, and may bend the curve beyond its intervals, most at "
        "low speed: 'fricomp diagnose' looks for what it is."
    ]

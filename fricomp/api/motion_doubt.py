"""What else acts on a recorded joint than friction: gravity that is fitted, and what makes a model doubtful."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fricomp.calibration.identification import Status
from fricomp.calibration.identification.doubt import doubted
from fricomp.calibration.motion.filtered_motion import doubt_for_filter, find_motion_filter
from fricomp.calibration.motion.identify import MotionIdentification
from fricomp.calibration.motion.joint_samples import JointSamples, RegressionSettings
from fricomp.calibration.motion.missed_torque import (
    MissedTorque,
    deny_gravity,
    describe_gravity,
    describe_level_gravity,
    doubt_for_gravity,
    doubt_for_spring,
    find_level_gravity,
    find_missed_spring,
)
from fricomp.calibration.motion.unexplained import doubt_for_unexplained, tell_unexplained
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.evaluation import find_friction_change
from fricomp.recording import Finding


def fit_gravity_where_it_shows(
    samples: JointSamples, settings: RegressionSettings, missed: MissedTorque | None, unit: str, flag: str
) -> tuple[RegressionSettings, list[str]]:
    """The settings with the gravity that the torque shows, or may be a constant torque, and what is said of it.

    Args:
        samples: Of a rotary joint of which nobody has said whether gravity acts on it.
        settings: Without gravity.
        missed: Gravity that a fit without it misses.
        unit: Of the torque.
        flag: What stands before the name of an argument, such as `--` on the command line.
    """
    if missed is not None:
        said = f"Gravity is fitted: {describe_gravity(missed, unit)}; {deny_gravity(flag)} leaves it out."
        return replace(settings, gravity=True), [said]
    level = find_level_gravity(samples, settings)
    if level == 0.0:
        return settings, []
    return replace(settings, level_gravity=True), [describe_level_gravity(level, unit, flag)]


def doubt_for_all(
    motion: MotionIdentification,
    samples: JointSamples,
    settings: RegressionSettings,
    left_out: MissedTorque | None,
    flag: str,
) -> MotionIdentification:
    """The motion of a joint that moves both ways, in doubt where its friction holds something else.

    Args:
        motion: As identified.
        samples: From these.
        settings: With these.
        left_out: Gravity that shows and was not to be fitted.
        flag: As for `fit_gravity_where_it_shows`.
    """
    sprung = find_missed_spring(samples, settings)
    if sprung is not None and (left_out is None or sprung.left < left_out.left):
        turns = motion.friction.model.motion == "rotary" and not settings.gravity
        motion = doubt_for_spring(motion, sprung, f"{flag}gravity" if turns else "")
    elif left_out is not None:
        motion = doubt_for_gravity(motion, left_out, flag)
    cutoff = find_motion_filter(samples, settings, motion.lag.value)
    if cutoff is not None:
        motion = doubt_for_filter(motion, cutoff)
    return doubt_for_unexplained(motion, samples.recorded)


def doubt_for_degrees(motion: MotionIdentification, findings: Sequence[Finding]) -> MotionIdentification:
    """The motion with degrees as the reason of its doubt, where they seem to be: they look like other things too.

    Args:
        motion: As identified, in doubt for all else.
        findings: Of the checks of its recording.
    """
    likely = next((one for one in findings if one.code == "degrees_likely"), None)
    if likely is None or find_doubt_in_status(motion.friction.status, "") is None:
        return motion
    return replace(
        motion, friction=doubted(motion.friction, Status.NOT_IDENTIFIABLE, f"{likely.message}; {likely.advice}")
    )


def doubt_for_step(motion: MotionIdentification, findings: Sequence[Finding]) -> MotionIdentification:
    """The motion in doubt where friction becomes another multiple of itself at once: one curve is none of both.

    Args:
        motion: As identified.
        findings: Of the checks of its recording.
    """
    step = next((one for one in findings if one.code == "friction_step"), None)
    if step is None:
        return motion
    return replace(motion, friction=doubted(motion.friction, Status.LACK_OF_FIT, f"{step.message}; {step.advice}"))


def tell_what_else_acts(motion: MotionIdentification, samples: JointSamples) -> list[str]:
    """What to know of torque that is left, and of friction that changes from the beginning to the end."""
    velocity, torque = motion.points.T
    left = torque - np.asarray(motion.friction.model.torque(velocity), dtype=np.float64)
    change = find_friction_change(np.arange(torque.size, dtype=np.float64), left, torque, velocity)
    said = [] if change is None else [f"Careful: {change.describe(motion.friction.model.torque_unit)}."]
    return [*tell_unexplained(motion, samples.recorded), *said]

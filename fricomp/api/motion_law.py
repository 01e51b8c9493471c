"""The law that a recorded motion is identified with, where none was asked for."""

from __future__ import annotations

import math

from fricomp.calibration import IdentificationOptions
from fricomp.calibration.motion.joint_samples import JointSamples, RegressionSettings
from fricomp.calibration.motion.rigid_body import MotionIdentification, identify_motion
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.errors import IdentificationError

__all__ = ["USUAL_LAW", "identify_with_law"]

USUAL_LAW = "stribeck"
"""Law of a recording for which none is asked."""
_PLAINER_LAWS = ("symmetric_stribeck", "coulomb_viscous")
"""Laws with fewer parameters, the first of which that is as good takes the place of one that is not determined."""
_ONE_WAY_LAWS = ("coulomb_viscous", "coulomb")
"""Laws of a joint that moves in one direction alone, the first of which that is determined is given."""
_AS_GOOD, _NEARLY = 1.02, 1.1
"""What a plainer law may leave over what the usual one leaves, whose four or six parameters more fit noise as well; and
up to which it may where the gain of these is less than what so many parameters must bring by chance."""


def identify_with_law(
    samples: JointSamples, settings: RegressionSettings, law: str, options: IdentificationOptions
) -> tuple[MotionIdentification, list[str]]:
    """The motion by the law that was asked for; by the usual one, or by a plainer one where that says as much.

    That eight parameters are not determined is no fault of the recording where four with the same curve in both
    directions, or two without a bend, leave no more of the torque.
    """
    try:
        found = identify_motion(samples, settings, law=law or USUAL_LAW, options=options)
    except IdentificationError as error:
        if law or samples.goes_both_ways:
            raise
        return _identify_one_way(samples, settings, options, error)
    if law or find_doubt_in_status(found.friction.status, "") is None:
        return found, []
    for plainer in _PLAINER_LAWS:
        try:
            plain = identify_motion(samples, settings, law=plainer, options=options)
        except IdentificationError:
            continue
        if _is_as_good(plain, found) and find_doubt_in_status(plain.friction.status, "") is None:
            why = found.friction.message.split(";", 1)[0].split(":", 1)[0]
            return plain, [f"Law: {plainer}, which leaves no more of the torque than {USUAL_LAW}, of which {why}."]
    return found, []


def _identify_one_way(
    samples: JointSamples, settings: RegressionSettings, options: IdentificationOptions, error: IdentificationError
) -> tuple[MotionIdentification, list[str]]:
    """The motion by a law that is the same in both directions, where the joint goes in one alone.

    Raises:
        IdentificationError: What the usual law was refused with, where no plainer one fits either.
    """
    said = "the joint moves in one direction alone, where friction and a constant torque are one: this is their sum"
    found = []
    for plainer in _ONE_WAY_LAWS:
        try:
            plain = identify_motion(samples, settings, law=plainer, options=options)
        except IdentificationError:
            continue
        found.append((plain, [f"Law: {plainer}; {said}."]))
        if find_doubt_in_status(plain.friction.status, "") is None:
            return found[-1]
    if not found:
        raise error
    return found[0]


def _is_as_good(plain: MotionIdentification, usual: MotionIdentification) -> bool:
    """Whether a law with fewer parameters says as much, by Schwarz's criterion on samples that do not go together."""
    worse = plain.friction.noise.level / usual.friction.noise.level
    if worse <= _AS_GOOD or worse > _NEARLY:
        return worse <= _AS_GOOD
    count = min(len(plain.points), len(usual.points)) / max(plain.alike, usual.alike)
    more = len(usual.friction.parameters) - len(plain.friction.parameters)
    return count * math.log(worse) <= 0.5 * more * math.log(max(count, 2.0))

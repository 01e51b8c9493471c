"""The law that a recorded motion is identified with, where none was asked for."""

import math
from dataclasses import replace

import numpy as np

from fricomp.calibration import IdentificationOptions
from fricomp.calibration.identification import Status
from fricomp.calibration.identification.doubt import doubted
from fricomp.calibration.motion.identify import MotionIdentification, identify_motion
from fricomp.calibration.motion.joint_samples import JointSamples, RegressionSettings
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.errors import IdentificationError

USUAL_LAW = "stribeck"
"""Law of a recording for which none is asked."""
_PLAIN_LAW, _SYMMETRIC_LAW, _FLAT_LAW = "coulomb_viscous", "symmetric_stribeck", "asymmetric_coulomb_viscous"
"""Laws with six, four and four parameters less, which take the place of the usual one where it is not determined."""
_ONE_WAY_LAWS = ("coulomb_viscous", "coulomb")
"""Laws of a joint that moves in one direction alone, the first of which that is determined is given."""
_ONE_WAY = "the joint moves in one direction alone, where friction, a constant torque and an error of gravity are one"
_BOTH = "record both directions"
_AS_GOOD, _NEARLY = 1.02, 1.1
"""What a plainer law may leave over what the usual one leaves, whose four or six parameters more fit noise as well; and
up to which it may where the gain of these is less than what so many parameters must bring by chance."""

_LITTLE = 0.02
"""What a plain law may leave of the friction where no other one is determined: less than most torques are known to."""
_DETERMINED = (Status.CONVERGED, Status.LACK_OF_FIT)
"""Where the usual law is taken as it is. A second basin that is nearly as likely is most often a bend the wrong way in
one direction, with a static torque far off."""


def identify_with_law(
    samples: JointSamples,
    settings: RegressionSettings,
    law: str,
    options: IdentificationOptions,
    *,
    one_way: bool,
) -> tuple[MotionIdentification, list[str]]:
    """The motion by the law that was asked for; by the usual one, or by a plainer one where that says as much.

    That eight parameters are not determined is no fault of the recording where four with the same curve in both
    directions, four without a bend, or two, leave no more of the torque. `one_way` says that it goes in one direction
    alone.
    """
    if one_way and not law:
        return _identify_one_way(samples, settings, options)
    found = identify_motion(samples, settings, law=law or USUAL_LAW, options=options)
    unseen = _describe_unseen_bend(found)
    if law or (found.friction.status in _DETERMINED and not unseen):
        return found, []
    laws = (_PLAIN_LAW, _SYMMETRIC_LAW, _FLAT_LAW)
    fits = {law: _fit_usable(samples, settings, law, options) for law in laws}
    plain, symmetric, flat = fits.values()
    for plainer, gain_counts in ((plain, False), (symmetric, True), (flat, True), (plain, True)):
        if plainer is not None and _is_as_good(plainer, found, gain_counts=gain_counts):
            name = next(law for law, fit in fits.items() if fit is plainer)
            why = unseen or found.friction.message.split(";", 1)[0].split(":", 1)[0]
            return plainer, [f"Law: {name}, which leaves no more of the torque than {USUAL_LAW}, of which {why}."]
    if plain is not None and find_doubt_in_status(found.friction.status, "") is not None and _is_close(plain, found):
        slowest = float(np.min(np.abs(plain.points[:, 0])))
        note = f"Law: {_PLAIN_LAW}, which is close above a speed of {slowest:.3g}; friction bends below, by how much "
        return plain, [f"{note}is not seen: record more time at low speed where it matters there."]
    return found, []


def _describe_unseen_bend(found: MotionIdentification) -> str:
    """Why the falling part of a curve is no Stribeck effect that the motion shows; empty where it is, or has none.

    A static torque below the Coulomb torque does not fall, and of a curve that falls below the slowest speed nothing is
    seen but its end: both are what reversals leave at the slowest speeds.
    """
    known, speeds = found.friction.parameters, found.points[:, 0]
    for name in (one for one in known if one.endswith("static_torque")):
        curve = name.rpartition(".")[0]
        direction = {"forward": 1.0, "reverse": -1.0}.get(curve.rpartition(".")[2], 0.0)
        slowest = float(np.min(np.abs(speeds[speeds * direction >= 0.0]), initial=np.inf))
        if known[name] < known[f"{curve}.coulomb_torque"]:
            return f"the static torque is below the Coulomb torque ({name})"
        if known[f"{curve}.stribeck_velocity"] < slowest < np.inf:
            return f"the bend lies below the slowest speed of {slowest:.3g} ({name})"
    return ""


def _is_close(plain: MotionIdentification, found: MotionIdentification) -> bool:
    """Whether what a law leaves beyond the noise, which the usual one leaves as well, is little beside the friction."""
    left = math.sqrt(max(plain.friction.noise.level**2 - found.friction.noise.level**2, 0.0))
    return left < _LITTLE * float(np.mean(np.abs(plain.points[:, 1])))


def _fit_usable(
    samples: JointSamples, settings: RegressionSettings, law: str, options: IdentificationOptions
) -> MotionIdentification | None:
    """The motion by a law; None where it is not determined either."""
    try:
        found = identify_motion(samples, settings, law=law, options=options)
    except IdentificationError:
        return None
    return found if find_doubt_in_status(found.friction.status, "") is None else None


def _identify_one_way(
    samples: JointSamples, settings: RegressionSettings, options: IdentificationOptions
) -> tuple[MotionIdentification, list[str]]:
    """The sum of friction and constant torque, where the joint goes one way; it is a measurement, and no model.

    Raises:
        IdentificationError: No plain law is determined.
    """
    for plainer in _ONE_WAY_LAWS:
        plain = _fit_usable(samples, settings, plainer, options)
        if plain is not None:
            friction = doubted(plain.friction, Status.NOT_IDENTIFIABLE, f"{_ONE_WAY}: this is their sum; {_BOTH}")
            return replace(plain, friction=friction), [f"Law: {plainer}, which is the same in both directions."]
    raise IdentificationError(f"{_ONE_WAY}, and these speeds do not determine it; {_BOTH}")


def _is_as_good(plain: MotionIdentification, usual: MotionIdentification, *, gain_counts: bool) -> bool:
    """Whether a law with fewer parameters says as much.

    Args:
        plain: By it.
        usual: By the law with more.
        gain_counts: Whether it may leave more where that is no gain by Schwarz's criterion, on samples that do not go
            together.
    """
    worse = plain.friction.noise.level / usual.friction.noise.level
    if worse <= _AS_GOOD or worse > _NEARLY or not gain_counts:
        return worse <= _AS_GOOD
    count = min(len(plain.points), len(usual.points)) / max(plain.alike, usual.alike)
    more = len(usual.friction.parameters) - len(plain.friction.parameters)
    return count * math.log(worse) <= 0.5 * more * math.log(max(count, 2.0))

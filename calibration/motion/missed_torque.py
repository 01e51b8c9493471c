"""Torque that goes with the position and is not fitted, of gravity or a spring: friction and inertia would hold it."""

from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import IdentificationError

from ..identification import Status
from ..identification.doubt import doubted
from .identify import MotionIdentification
from .joint_samples import JointSamples, RegressionSettings
from .rigid_body import RigidBodyFit, fit_rigid_body

_HEAVY = 0.5
"""What gravity or a spring that is missed leaves unexplained, over what is so without it. Cogging leaves more."""
_SHOWS, _TAKES = 0.8, 0.25
"""The same of gravity that takes a constant torque with it, and the part of that torque which it may leave.

Friction that bends leaves much in both fits, and a constant torque would count as friction of one direction.
"""
_SURE = 4.0
"""Standard deviations that it must have."""
_UNKNOWN = 0.5
"""Half of the 95 % interval of a constant torque beside gravity, over it, from which on it may be all gravity."""
_MATTERS = 0.05
"""Part of the Coulomb torque below which a constant torque may be anything: directions differ by as much."""


@dataclass(frozen=True)
class MissedTorque:
    """Gravity or a spring that a fit without it misses.

    Attributes:
        size: Largest torque of gravity [N·m]; stiffness of a spring [N·m/rad] or [N/m].
        without: Part of the torque that is unexplained without it.
        left: The same with it.
    """

    size: float
    without: float
    left: float


def find_missed_gravity(samples: JointSamples, settings: RegressionSettings) -> MissedTorque | None:
    """Find gravity that explains most of what a fit without it leaves; None where there is none, or it is fitted.

    Args:
        samples: Of a rotary joint.
        settings: As it is to be identified.
    """
    fits = None if settings.gravity else _fit_both(samples, settings, gravity=True)
    if fits is None:
        return None
    without, heavy = fits
    if _does_show_inertia(without) and not _does_show_inertia(heavy):
        return None  # of a single swing the angle goes with the acceleration: gravity stands in for the inertia
    most = _SHOWS if _does_take_offset(without, heavy) else _HEAVY
    return _judge(without, heavy, float(np.hypot(*heavy.gravity)), max(heavy.gravity_deviations), most)


def _does_take_offset(without: RigidBodyFit, heavy: RigidBodyFit) -> bool:
    """Whether a constant torque that matters is next to nothing once gravity is fitted."""
    matters = abs(without.offset) > _MATTERS * without.coulomb_torque
    return matters and abs(heavy.offset) < _TAKES * abs(without.offset)


def _does_show_inertia(body: RigidBodyFit) -> bool:
    return body.inertia > _SURE * body.standard_deviations[0]


def find_missed_spring(samples: JointSamples, settings: RegressionSettings) -> MissedTorque | None:
    """Find a spring that explains most of what a fit without it leaves; None where there is none.

    Args:
        samples: Filtered samples.
        settings: As it is to be identified, gravity included, which over a short way looks alike.
    """
    fits = _fit_both(samples, settings, gravity=settings.gravity, spring=True)
    if fits is None:
        return None
    without, sprung = fits
    if _does_show_inertia(without) and not _does_show_inertia(sprung):
        return None
    return _judge(without, sprung, *sprung.stiffness)


def find_level_gravity(samples: JointSamples, settings: RegressionSettings) -> float:
    """Constant torque that may all be gravity, which over a small angle is one [N·m]; 0 where it is none, or is told.

    Sliding does not tell a constant torque from friction that differs between the directions. What gravity may be is
    no friction: at another angle it is another torque.

    Args:
        samples: Of a rotary joint.
        settings: As it is to be identified.
    """
    fits = None if settings.gravity else _fit_both(samples, settings, gravity=True)
    if fits is None:
        return 0.0
    without, heavy = fits
    half = 1.96 * heavy.standard_deviations[3]
    least = min(abs(without.offset), abs(_fit_constant(samples, settings)))
    return without.offset if half > _UNKNOWN * least > _UNKNOWN * _MATTERS * without.coulomb_torque else 0.0


def _fit_constant(samples: JointSamples, settings: RegressionSettings) -> float:
    """Constant torque beside viscous friction of its own in each direction, whose difference is no constant [N·m]."""
    rows = samples.sliding(settings.slowest, bends=False)
    velocity = samples.velocity[rows]
    columns = [np.ones_like(velocity), samples.acceleration[rows], samples.direction[rows]]
    columns += [np.maximum(velocity, 0.0), np.minimum(velocity, 0.0)]
    return float(np.linalg.lstsq(np.stack(columns, axis=1), samples.torque[rows], rcond=None)[0][0])


def describe_gravity(missed: MissedTorque, unit: str) -> str:
    """Say how gravity shows, in half a sentence."""
    return (
        f"the torque holds {missed.size:.4g} {unit} that goes with sine and cosine of the angle, as gravity does: "
        f"without gravity {missed.without:.2g} of the torque is unexplained, with it {missed.left:.2g}"
    )


def deny_gravity(flag: str) -> str:
    """How a user says that no gravity acts.

    Args:
        flag: What stands before the name of an argument; empty in Python.
    """
    return f"{flag}no-gravity" if flag else "gravity=False"


def describe_level_gravity(level: float, unit: str, flag: str) -> str:
    """Say what was made of a constant torque that may be gravity, and what else it may be.

    Args:
        level: The torque.
        unit: Its unit.
        flag: What stands before the name of an argument, such as `--` on the command line.
    """
    return (
        f"Over so small an angle a constant torque of {level:.4g} {unit} may be gravity: it is the offset of the rigid "
        f"body, and no part of the friction, which is not told from it where it differs between the directions; move "
        f"over a wider angle, or say {deny_gravity(flag)} where no gravity acts."
    )


def doubt_for_gravity(motion: MotionIdentification, missed: MissedTorque, flag: str) -> MotionIdentification:
    """The motion with its friction in doubt, which holds gravity that was not to be fitted.

    Args:
        motion: Identified without gravity.
        missed: What it misses.
        flag: What stands before the name of an argument, such as `--` on the command line.
    """
    shown = describe_gravity(missed, motion.friction.model.torque_unit)
    return _doubt(motion, f"{shown}, and friction would hold it; say {flag}gravity")


def doubt_for_spring(motion: MotionIdentification, missed: MissedTorque, gravity: str) -> MotionIdentification:
    """The motion with its friction in doubt, which holds what the spring does.

    Args:
        motion: Identified without the spring.
        missed: What it misses.
        gravity: What to say where it is gravity, which is a spring over a small angle; empty where it cannot be.
    """
    instead = (
        f", or say {gravity} where it is the weight of the joint, which is alike over a small angle" if gravity else ""
    )
    model = motion.friction.model
    unit = f"{model.torque_unit}/{'rad' if model.motion == 'rotary' else 'm'}"
    message = (
        f"the torque follows the position like a spring of {missed.size:.4g} {unit}: without it {missed.without:.2g} "
        f"of the torque is unexplained, with it {missed.left:.2g}; inertia and friction hold a part of it here: take "
        f"'fricomp diagnose', whose model has a spring{instead}"
    )
    return _doubt(motion, message)


def _fit_both(
    samples: JointSamples, settings: RegressionSettings, *, gravity: bool, spring: bool = False
) -> tuple[RigidBodyFit, RigidBodyFit] | None:
    """The body as it is to be identified, and with more; None where the motion does not excite that."""
    rows = samples.sliding(settings.slowest, bends=False)
    try:
        without = fit_rigid_body(samples, gravity=settings.gravity, rows=rows)
        return without, fit_rigid_body(samples, gravity=gravity, spring=spring, rows=rows)
    except IdentificationError:
        return None


def _judge(
    without: RigidBodyFit, more: RigidBodyFit, size: float, deviation: float, most: float = _HEAVY
) -> MissedTorque | None:
    """What is missed, where it leaves no more than a part and is sure."""
    if more.residual > most * without.residual or abs(size) < _SURE * deviation:
        return None
    return MissedTorque(size, without.residual, more.residual)


def _doubt(motion: MotionIdentification, message: str) -> MotionIdentification:
    return replace(motion, friction=doubted(motion.friction, Status.NOT_IDENTIFIABLE, message))

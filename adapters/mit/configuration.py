"""What a configuration file says about MIT-mode motors, and the motors made from it."""

from collections.abc import Mapping

from fricomp.errors import AdapterConfigurationError

from ..configuration import CanAdapterConfiguration, JointConfiguration
from .codec import MitRanges
from .cybergear import CyberGearMotor
from .motor import AkMotor, DamiaoMotor, Motor, RobstrideMotor
from .profile import find_model

__all__ = ["MitConfiguration", "MitJointConfiguration", "make_motor"]

DIALECTS: Mapping[str, type[Motor]] = {
    "damiao": DamiaoMotor,
    "ak": AkMotor,
    "robstride": RobstrideMotor,
    "cybergear": CyberGearMotor,
}


class MitJointConfiguration(JointConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One motor.

    Attributes:
        model: `vendor/model`, such as `damiao/DM4310`.
        feedback_id: Identifier of its answers; the vendor's default if not given.
        ranges: Ranges set on the motor if they are not the model's: `[position, velocity, torque]`.
        stiffness: K of the velocity mode, at the motor [N·m/rad]; both or none, and without them only torque mode.
        damping: D of the velocity mode, closed in the motor, at the motor [N·m·s/rad].
    """

    model: str
    feedback_id: int | None = None
    ranges: tuple[float, float, float] | None = None
    stiffness: float | None = None
    damping: float | None = None


class MitConfiguration(CanAdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """MIT-mode motors on one CAN bus."""

    joints: tuple[MitJointConfiguration, ...]


def make_motor(joint: MitJointConfiguration) -> Motor:
    """The motor of a joint.

    Raises:
        AdapterConfigurationError: Its model is unknown, or an identifier is out of range.
    """
    profile, ranges = find_model(joint.model)
    if joint.ranges is not None:
        ranges = MitRanges(*joint.ranges, kp=ranges.kp, kd=ranges.kd)
    feedback_id = joint.feedback_id
    if feedback_id is None:
        feedback_id = profile.feedback_id if profile.feedback_offset is None else joint.id + profile.feedback_offset
    highest = 0xFF if profile.dialect in ("cybergear", "robstride") else 0x7FE
    for what, number, lowest in (("id", joint.id, 1), ("feedback_id", feedback_id, 0)):
        if not lowest <= number <= highest:
            raise AdapterConfigurationError(f"joint {joint.name!r}: {what} {number} is not in {lowest}..{highest}")
    return DIALECTS[profile.dialect](joint.id, feedback_id, ranges, profile.registers)

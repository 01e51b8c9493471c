"""What a configuration file says about Dynamixel servos."""

from ..configuration import JointConfiguration, SerialAdapterConfiguration
from .control_table import WATCHDOG_COUNT


class DynamixelJointConfiguration(JointConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """One servo.

    Attributes:
        torque_constant: [N·m/A]; if given, torques and limits are in N·m, else everything stays in amperes.
    """

    torque_constant: float | None = None


class DynamixelConfiguration(SerialAdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Dynamixel X servos on one line."""

    joints: tuple[DynamixelJointConfiguration, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        for joint in self.joints:
            if not 0 <= joint.id <= 252:
                raise ValueError(f"joint {joint.name!r}: servos are numbered 0 to 252, got {joint.id}")
            if joint.torque_constant is not None and not joint.torque_constant > 0.0:
                raise ValueError(f"joint {joint.name!r}: torque_constant must be positive, got {joint.torque_constant}")
        if not WATCHDOG_COUNT <= self.watchdog <= 127 * WATCHDOG_COUNT:
            raise ValueError(f"the watchdog of these servos runs from 0.02 to 2.54 s, got {self.watchdog}")

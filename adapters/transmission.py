"""From motor to joint: gear ratio, sign and zero, applied once, in one place."""

from dataclasses import dataclass, replace
from typing import get_args

from fricomp.control.number import is_number
from fricomp.errors import AdapterConfigurationError
from fricomp.joint import JointCapabilities
from fricomp.model import Motion

SCALED_UNITS = ("N·m", "N")
"""Torque in the actuator's own unit, such as ampere, is not scaled by a gear: only the sign carries over."""


@dataclass(frozen=True)
class Transmission:
    """Gear between a drive and its joint: q_joint = sign q_drive / ratio - zero, tau_joint = sign ratio tau_drive.

    Attributes:
        gear_ratio: Drive turns for one joint turn, positive [1], or [rad/m] where the joint is linear.
        sign: +1, or -1 where the drive counts the other way.
        zero: Joint position at which q_joint is to read 0 [rad] or [m].
        motion: Of the joint: `rotary` (rad), or `linear` (m), whose drive turns all the same.

    Raises:
        AdapterConfigurationError: The ratio is not positive, the sign not +1 or -1, or the motion unknown.
    """

    gear_ratio: float = 1.0
    sign: int = 1
    zero: float = 0.0
    motion: Motion = "rotary"

    def __post_init__(self) -> None:
        if not (is_number(self.gear_ratio, 0.0) and self.gear_ratio > 0.0):
            raise AdapterConfigurationError(
                f"gear_ratio must be positive, got {self.gear_ratio!r}: put a reversal into sign"
            )
        if not is_number(self.sign) or self.sign not in (1, -1):
            raise AdapterConfigurationError(f"sign must be 1 or -1, got {self.sign!r}")
        if not is_number(self.zero):
            raise AdapterConfigurationError(f"zero must be finite, got {self.zero!r}")
        if self.motion not in get_args(Motion):
            raise AdapterConfigurationError(f"motion must be 'rotary' or 'linear', got {self.motion!r}")

    @property
    def is_identity(self) -> bool:
        """Whether drive side and joint side are the same."""
        return self == Transmission()

    def position_to_joint(self, position: float) -> float:
        """Joint position [rad] or [m] of a drive position [rad]."""
        return self.sign * position / self.gear_ratio - self.zero

    def torque_to_drive(self, torque: float) -> float:
        """Drive torque [N·m] of a joint torque [N·m] or [N]."""
        return self.sign * torque / self.gear_ratio

    def torque_gain(self, unit: str) -> float:
        """Torque at the joint for one at the drive, both in `unit` [1]."""
        return self.sign * (self.gear_ratio if unit in SCALED_UNITS else 1.0)

    def capabilities_to_joint(self, drive: JointCapabilities) -> JointCapabilities:
        """What the drive declares, seen from the joint."""
        if self.is_identity:
            return drive
        limits = drive.position_limits
        if limits is not None:
            low, high = sorted(self.position_to_joint(edge) for edge in limits)
            limits = (low, high)
        torque_ratio = abs(self.torque_gain(drive.torque_unit))
        linear = self.motion == "linear"
        return replace(
            drive,
            motion=self.motion if linear else drive.motion,
            torque_unit="N" if linear and drive.torque_unit == "N·m" else drive.torque_unit,
            position_quantum=drive.position_quantum / self.gear_ratio,
            velocity_quantum=drive.velocity_quantum / self.gear_ratio,
            velocity_command_quantum=drive.velocity_command_quantum / self.gear_ratio,
            velocity_limit=drive.velocity_limit / self.gear_ratio,
            torque_quantum=drive.torque_quantum * torque_ratio,
            torque_limit=drive.torque_limit * torque_ratio,
            position_limits=limits,
        )

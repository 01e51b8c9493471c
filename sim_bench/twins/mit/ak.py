"""A T-Motor AK module in MIT mode, from the CubeMars manual: Damiao's control frame, another answer, no registers.

The answer goes to one identifier for all motors, carries the motor's number first and no sign of being enabled.
The timeout is set with the maker's own tool only and is off as delivered.
"""

from dataclasses import dataclass
from enum import IntEnum
from typing import ClassVar

from .damiao import MitMotor, MitSettings, MitStatus, to_code

__all__ = ["AkFault", "AkMotor", "AkSettings"]

COLDEST, HOTTEST = -40, 215


class AkFault(IntEnum):
    """Last byte of every answer."""

    NONE = 0
    MOTOR_OVER_TEMPERATURE = 1
    OVER_CURRENT = 2
    OVER_VOLTAGE = 3
    UNDER_VOLTAGE = 4
    ENCODER = 5


FAULTS = {
    MitStatus.COIL_OVER_TEMPERATURE: AkFault.MOTOR_OVER_TEMPERATURE,
    MitStatus.OVER_CURRENT: AkFault.OVER_CURRENT,
    MitStatus.OVER_VOLTAGE: AkFault.OVER_VOLTAGE,
    MitStatus.UNDER_VOLTAGE: AkFault.UNDER_VOLTAGE,
}


@dataclass(frozen=True)
class AkSettings(MitSettings):
    """As `MitSettings`, with the identifiers and ranges of an AK80-9."""

    model: ClassVar[str] = "tmotor/AK80-9"

    feedback_id: int = 0x00
    velocity_range: float = 50.0
    torque_range: float = 18.0


class AkMotor(MitMotor):
    """One module."""

    def tick(self, now_ns: int) -> None:
        """Falling silent makes it limp without a fault code."""
        was_lost = self.status == MitStatus.LOST_COMMUNICATION
        super().tick(now_ns)
        if self.status == MitStatus.LOST_COMMUNICATION and not was_lost:
            self.status = MitStatus.DISABLED

    def _answer(self) -> None:
        s = self.settings
        position = to_code(self.axis.position, 16, s.position_range)
        velocity = to_code(self.axis.velocity, 12, s.velocity_range)
        torque = to_code(self.axis.torque, 12, s.torque_range)
        state = position << 24 | velocity << 12 | torque
        temperature = max(COLDEST, min(HOTTEST, round(self.axis.temperature))) - COLDEST
        fault = FAULTS.get(self.status, AkFault.NONE)
        self.send(s.feedback_id, bytes([s.receive_id]) + state.to_bytes(5, "big") + bytes([temperature, fault]), False)

    def _register(self, data: bytes) -> None:
        """It has none."""

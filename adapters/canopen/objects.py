"""The objects of the dictionary that the adapter uses [cia301], [cia402]."""

import struct
from dataclasses import dataclass

__all__ = ["CanOpenObject"]


@dataclass(frozen=True)
class CanOpenObject:
    """One entry of an object dictionary.

    Attributes:
        index: Index.
        subindex: Subindex.
        format: Its type as in `struct`, without byte order.
    """

    index: int
    subindex: int
    format: str

    @property
    def n_bytes(self) -> int:
        """Size [byte]."""
        return struct.calcsize("<" + self.format)

    @property
    def mapping(self) -> int:
        """How it stands in a PDO mapping: index, subindex and length in bits."""
        return self.index << 16 | self.subindex << 8 | 8 * self.n_bytes

    def pack(self, value: float) -> bytes:
        """The bytes of a whole number."""
        return struct.pack("<" + self.format, int(value))

    def unpack(self, data: bytes) -> int:
        """The whole number in some bytes; short answers are extended by zeros, as drives send them."""
        padded = data[: self.n_bytes].ljust(self.n_bytes, b"\0")
        return int(struct.unpack("<" + self.format, padded)[0])


DEVICE_TYPE = CanOpenObject(0x1000, 0, "I")
CONSUMER_HEARTBEAT = CanOpenObject(0x1016, 1, "I")
PRODUCER_HEARTBEAT = CanOpenObject(0x1017, 0, "H")

ABORT_CONNECTION_OPTION = CanOpenObject(0x6007, 0, "h")
ERROR_CODE = CanOpenObject(0x603F, 0, "H")
CONTROLWORD = CanOpenObject(0x6040, 0, "H")
QUICK_STOP_OPTION = CanOpenObject(0x605A, 0, "h")
STATUSWORD = CanOpenObject(0x6041, 0, "H")
MODE = CanOpenObject(0x6060, 0, "b")
MODE_DISPLAY = CanOpenObject(0x6061, 0, "b")
POSITION = CanOpenObject(0x6064, 0, "i")
VELOCITY = CanOpenObject(0x606C, 0, "i")
TARGET_TORQUE = CanOpenObject(0x6071, 0, "h")
MAX_TORQUE = CanOpenObject(0x6072, 0, "H")
RATED_TORQUE = CanOpenObject(0x6076, 0, "I")
TORQUE = CanOpenObject(0x6077, 0, "h")
TARGET_POSITION = CanOpenObject(0x607A, 0, "i")
LOWEST_POSITION = CanOpenObject(0x607B, 1, "i")
HIGHEST_POSITION = CanOpenObject(0x607B, 2, "i")
MAX_MOTOR_SPEED = CanOpenObject(0x6080, 0, "I")
ENCODER_INCREMENTS = CanOpenObject(0x608F, 1, "I")
ENCODER_REVOLUTIONS = CanOpenObject(0x608F, 2, "I")
GEAR_MOTOR_REVOLUTIONS = CanOpenObject(0x6091, 1, "I")
GEAR_SHAFT_REVOLUTIONS = CanOpenObject(0x6091, 2, "I")
FEED = CanOpenObject(0x6092, 1, "I")
FEED_SHAFT_REVOLUTIONS = CanOpenObject(0x6092, 2, "I")
VELOCITY_UNIT = CanOpenObject(0x60A9, 0, "I")
POSITION_OFFSET = CanOpenObject(0x60B0, 0, "i")
VELOCITY_OFFSET = CanOpenObject(0x60B1, 0, "i")
TORQUE_OFFSET = CanOpenObject(0x60B2, 0, "h")
INTERPOLATION_PERIOD = CanOpenObject(0x60C2, 1, "B")
INTERPOLATION_EXPONENT = CanOpenObject(0x60C2, 2, "b")
TARGET_VELOCITY = CanOpenObject(0x60FF, 0, "i")
SUPPORTED_MODES = CanOpenObject(0x6502, 0, "I")

"""A Xiaomi CyberGear, from its manual: 29-bit identifiers of type, 16 bits of data and address; 16-bit fields.

A control frame (type 1) carries the torque in its identifier; feedback (type 2) carries mode and faults there.
Parameters are read and written (types 17 and 18) little endian, motion is big endian. Parameter 0x200C is the time
without a frame, in counts of 50 µs, after which the motor resets; 0, as delivered, switches that off.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum
from math import pi
from typing import Any

import can

from fricomp.errors import ParameterError

from ..axis import DriveAxis
from ..can_twin import CanDevice
from .damiao import from_code, to_code

__all__ = ["CyberGearMotor", "CyberGearSettings", "Mode"]

CONTROL, FEEDBACK, ENABLE, STOP, SET_ZERO, READ, WRITE = 1, 2, 3, 4, 6, 17, 18
POSITION_RANGE, VELOCITY_RANGE, TORQUE_RANGE = 4.0 * pi, 30.0, 12.0
LARGEST_STIFFNESS, LARGEST_DAMPING = 500.0, 5.0
RUN_MODE, TIMEOUT, POSITION, VELOCITY, BUS_VOLTAGE = 0x7005, 0x200C, 0x7019, 0x701B, 0x701C
FORMATS = {RUN_MODE: "<B3x", TIMEOUT: "<I", POSITION: "<f", VELOCITY: "<f", BUS_VOLTAGE: "<f"}
OPERATION_CONTROL = 0
TIMEOUT_COUNT_NS = 50_000


class Mode(IntEnum):
    """Bits 22 and 23 of a feedback identifier."""

    RESET = 0
    RUN = 2


@dataclass(frozen=True)
class CyberGearSettings:
    """What is stored in a motor.

    Attributes:
        motor_id: Its address, 0 to 127.
        timeout: Parameter 0x200C [50 µs].
    """

    motor_id: int = 0x7F
    timeout: int = 0

    def __post_init__(self) -> None:
        if not 0 <= self.motor_id <= 127:
            raise ParameterError(f"motor_id must be from 0 to 127, got {self.motor_id!r}")

    @property
    def ranges(self) -> tuple[float, float]:
        """Largest torque [N·m] and velocity [rad/s] that the protocol's numbers carry, at the motor."""
        return TORQUE_RANGE, VELOCITY_RANGE

    def adapter_entry(self) -> dict[str, Any]:
        """What the adapter's configuration says of such a drive."""
        return {"id": self.motor_id, "model": "xiaomi/CyberGear"}


class CyberGearMotor(CanDevice):
    """One motor.

    Args:
        axis: The joint behind it.
        settings: What is stored in it.
    """

    def __init__(self, axis: DriveAxis, settings: CyberGearSettings = CyberGearSettings()) -> None:
        self.axis, self.settings = axis, settings
        self.power_cycle()

    def power_cycle(self) -> None:
        """Reset mode, parameters as stored."""
        self.mode, self.faults = Mode.RESET, 0
        self.parameters: dict[int, float] = {RUN_MODE: OPERATION_CONTROL, TIMEOUT: self.settings.timeout}
        self._silence_ns = self._now_ns = self._host = 0
        self.axis.disable()

    def fail(self, bit: int) -> None:
        """Go limp with a fault bit (0 undervoltage, 1 overcurrent, 2 overtemperature), which a stop can clear."""
        self.faults |= 1 << bit
        self._reset()

    def receive(self, message: can.Message) -> None:
        """Frames to this motor."""
        identifier, data = message.arbitration_id, bytes(message.data)
        if not message.is_extended_id or identifier & 0xFF != self.settings.motor_id or len(data) != 8:
            return
        kind, middle = identifier >> 24, identifier >> 8 & 0xFFFF
        self._silence_ns = 0
        if kind == CONTROL:
            self._control(middle, data)
            self._report(0)
        elif kind in (ENABLE, STOP, SET_ZERO):
            self._switch(kind, data)
            self._report(middle & 0xFF)
        elif kind == READ:
            self._read(middle & 0xFF, data)
        elif kind == WRITE:
            self._write(data)
            self._report(middle & 0xFF)

    def tick(self, now_ns: int) -> None:
        """Reset when nothing has come for the time of 0x200C."""
        if self._now_ns:
            self._silence_ns += now_ns - self._now_ns
        self._now_ns = now_ns
        if self.mode == Mode.RUN and 0 < self.parameters[TIMEOUT] * TIMEOUT_COUNT_NS < self._silence_ns:
            self._reset()

    def _reset(self) -> None:
        self.mode = Mode.RESET
        self.axis.disable()

    def _switch(self, kind: int, data: bytes) -> None:
        if kind == STOP:
            self._reset()
            self.faults = 0 if data[0] == 1 else self.faults
        elif kind == ENABLE and not self.faults and self.mode == Mode.RESET:
            if self.parameters[RUN_MODE] == OPERATION_CONTROL:
                self.mode = Mode.RUN
                self.axis.enable("impedance")
        elif kind == SET_ZERO and data[0] == 1 and self.mode == Mode.RESET:
            self.axis.set_zero()

    def _control(self, torque: int, data: bytes) -> None:
        if self.mode != Mode.RUN:
            return
        position, velocity, stiffness, damping = struct.unpack(">4H", data)
        self.axis.command_gains(stiffness / 65535 * LARGEST_STIFFNESS, damping / 65535 * LARGEST_DAMPING)
        self.axis.command(
            from_code(torque, 16, TORQUE_RANGE),
            from_code(velocity, 16, VELOCITY_RANGE),
            from_code(position, 16, POSITION_RANGE),
        )

    def _report(self, host: int) -> None:
        self._host = host or self._host
        middle = self.mode << 14 | (self.faults & 0x3F) << 8 | self.settings.motor_id
        data = struct.pack(
            ">4H",
            to_code(self.axis.position, 16, POSITION_RANGE),
            to_code(self.axis.velocity, 16, VELOCITY_RANGE),
            to_code(self.axis.torque, 16, TORQUE_RANGE),
            max(0, min(0xFFFF, round(10.0 * self.axis.temperature))),
        )
        self.send(FEEDBACK << 24 | middle << 8 | self._host, data, True)

    def _read(self, host: int, data: bytes) -> None:
        index = int.from_bytes(data[:2], "little")
        measured = {POSITION: self.axis.position, VELOCITY: self.axis.velocity, BUS_VOLTAGE: 24.0}
        value = measured.get(index, self.parameters.get(index))
        if value is None:
            return
        layout = FORMATS[index]
        raw = struct.pack(layout, value if layout == "<f" else int(value))
        self.send(READ << 24 | self.settings.motor_id << 8 | host, data[:2] + b"\0\0" + raw, True)

    def _write(self, data: bytes) -> None:
        index = int.from_bytes(data[:2], "little")
        if index in self.parameters:
            (self.parameters[index],) = struct.unpack(FORMATS[index], data[4:])

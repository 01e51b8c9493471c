"""A motor in MIT mode as Damiao builds it, from the protocol description of its DM series.

A control frame packs position and velocity references, two gains and a torque into eight bytes, big endian:
q16, dq12, kp12, kd12, tau12, over ranges that registers 21 to 23 hold. Every frame is answered with the state.
Register 9 is the time without a frame, in counts of 50 µs, after which the motor goes limp; 0 switches that off.
"""

import struct
from dataclasses import dataclass
from enum import IntEnum
from typing import Any, ClassVar

import can

from fricomp.errors import ParameterError

from ..axis import DriveAxis
from ..can_twin import CanDevice

__all__ = ["MitMotor", "MitSettings", "MitStatus", "from_code", "to_code"]

REGISTER_ID = 0x7FF
READ, WRITE, STORE, REFRESH = 0x33, 0x55, 0xAA, 0xCC
ENABLE, DISABLE, SET_ZERO, CLEAR = 0xFC, 0xFD, 0xFE, 0xFB
MIT_CONTROL_MODE = 1
LARGEST_STIFFNESS, LARGEST_DAMPING = 500.0, 5.0
TIMEOUT_COUNT_NS = 50_000

FEEDBACK_ID, RECEIVE_ID, TIMEOUT, CONTROL_MODE, PMAX, VMAX, TMAX = 7, 8, 9, 10, 21, 22, 23
FLOAT_REGISTERS = {0, 1, 2, 3, 4, 5, 6, 11, 12, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30, 31, 32, 33, 34}
READ_ONLY_REGISTERS = {11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 33, 34, 36}


class MitStatus(IntEnum):
    """Upper half of the first byte of every answer."""

    DISABLED = 0x0
    ENABLED = 0x1
    OVER_VOLTAGE = 0x8
    UNDER_VOLTAGE = 0x9
    OVER_CURRENT = 0xA
    MOSFET_OVER_TEMPERATURE = 0xB
    COIL_OVER_TEMPERATURE = 0xC
    LOST_COMMUNICATION = 0xD
    OVERLOAD = 0xE


@dataclass(frozen=True)
class MitSettings:
    """What is stored in a motor.

    Attributes:
        receive_id: Identifier of control frames.
        feedback_id: Identifier of answers.
        position_range: PMAX [rad].
        velocity_range: VMAX [rad/s].
        torque_range: TMAX [N·m].
        timeout: Register 9 [50 µs]; 0 for none, as delivered.
    """

    model: ClassVar[str] = "damiao/DM4310"

    receive_id: int = 0x01
    feedback_id: int = 0x11
    position_range: float = 12.5
    velocity_range: float = 30.0
    torque_range: float = 10.0
    timeout: int = 0

    def __post_init__(self) -> None:
        for name in ("receive_id", "feedback_id"):
            if not 0 <= getattr(self, name) < REGISTER_ID:
                raise ParameterError(f"{name} must be from 0 to 0x7FE, got {getattr(self, name)!r}")
        for name in ("position_range", "velocity_range", "torque_range"):
            if not getattr(self, name) > 0.0:
                raise ParameterError(f"{name} must be positive, got {getattr(self, name)!r}")

    @property
    def ranges(self) -> tuple[float, float]:
        """Largest torque [N·m] and velocity [rad/s] that the protocol's numbers carry, at the motor."""
        return self.torque_range, self.velocity_range

    def adapter_entry(self) -> dict[str, Any]:
        """What the adapter's configuration says of such a drive."""
        return {
            "id": self.receive_id,
            "feedback_id": self.feedback_id,
            "model": self.model,
            "ranges": [self.position_range, self.velocity_range, self.torque_range],
        }


class MitMotor(CanDevice):
    """One motor.

    Args:
        axis: The joint behind it.
        settings: What is stored in it.
    """

    def __init__(self, axis: DriveAxis, settings: MitSettings = MitSettings()) -> None:
        self.axis, self.settings = axis, settings
        self.power_cycle()

    def power_cycle(self) -> None:
        """Disabled, registers as stored."""
        s = self.settings
        self.status = MitStatus.DISABLED
        self._silence_ns = self._now_ns = 0
        self.registers: dict[int, float] = {
            **dict.fromkeys(range(37), 0),
            FEEDBACK_ID: s.feedback_id,
            RECEIVE_ID: s.receive_id,
            TIMEOUT: s.timeout,
            CONTROL_MODE: MIT_CONTROL_MODE,
            PMAX: s.position_range,
            VMAX: s.velocity_range,
            TMAX: s.torque_range,
        }
        self.axis.disable()

    def fail(self, status: MitStatus) -> None:
        """Go limp with a fault, which stays until it is cleared."""
        self.status = status
        self.axis.disable()

    def receive(self, message: can.Message) -> None:
        """Control frames and commands on the receive id, register access on 0x7FF."""
        data = bytes(message.data)
        if message.is_extended_id or message.is_remote_frame or len(data) != 8:
            return
        if message.arbitration_id == self.registers[RECEIVE_ID]:
            self._silence_ns = 0
            if data[:7] == b"\xff" * 7 and data[7] in (ENABLE, DISABLE, SET_ZERO, CLEAR):
                self._command(data[7])
            elif self.registers[CONTROL_MODE] == MIT_CONTROL_MODE:
                self._control(int.from_bytes(data, "big"))
            self._answer()
        elif message.arbitration_id == REGISTER_ID and int.from_bytes(data[:2], "little") == self.registers[RECEIVE_ID]:
            self._register(data)

    def tick(self, now_ns: int) -> None:
        """Go limp when nothing has come for the time of register 9."""
        if self._now_ns:
            self._silence_ns += now_ns - self._now_ns
        self._now_ns = now_ns
        limit_ns = self.registers[TIMEOUT] * TIMEOUT_COUNT_NS
        if 0 < limit_ns < self._silence_ns and self.status == MitStatus.ENABLED:
            self.fail(MitStatus.LOST_COMMUNICATION)

    def _command(self, code: int) -> None:
        if code == ENABLE and self.status == MitStatus.DISABLED:
            self.status = MitStatus.ENABLED
            self.axis.enable("impedance")
        elif code == DISABLE:
            self.axis.disable()
            self.status = MitStatus.DISABLED if self.status == MitStatus.ENABLED else self.status
        elif code == CLEAR and self.status != MitStatus.ENABLED:
            self.status = MitStatus.DISABLED
        elif code == SET_ZERO and self.status == MitStatus.DISABLED:
            self.axis.set_zero()

    def _control(self, bits: int) -> None:
        if self.status != MitStatus.ENABLED:
            return
        position = from_code(bits >> 48, 16, self.registers[PMAX])
        velocity = from_code(bits >> 36 & 0xFFF, 12, self.registers[VMAX])
        torque = from_code(bits & 0xFFF, 12, self.registers[TMAX])
        self.axis.command_gains(
            (bits >> 24 & 0xFFF) / 4095 * LARGEST_STIFFNESS, (bits >> 12 & 0xFFF) / 4095 * LARGEST_DAMPING
        )
        self.axis.command(torque, velocity, position)

    def _answer(self) -> None:
        position = to_code(self.axis.position, 16, self.registers[PMAX])
        velocity = to_code(self.axis.velocity, 12, self.registers[VMAX])
        torque = to_code(self.axis.torque, 12, self.registers[TMAX])
        head = int(self.status) << 4 | int(self.registers[RECEIVE_ID]) & 0xF
        state = position << 24 | velocity << 12 | torque
        temperature = max(0, min(255, round(self.axis.temperature)))
        data = bytes([head]) + state.to_bytes(5, "big") + bytes([temperature, temperature])
        self.send(int(self.registers[FEEDBACK_ID]), data, False)

    def _register(self, data: bytes) -> None:
        operation, register = data[2], data[3]
        if operation == REFRESH:
            self._answer()
        elif operation in (READ, WRITE) and register in self.registers:
            if operation == WRITE:
                self._write(register, data[4:])
            self._reply(operation, register)
        elif operation == STORE:
            self._reply(operation, register)

    def _write(self, register: int, raw: bytes) -> None:
        if register in READ_ONLY_REGISTERS:
            return
        value: float = struct.unpack("<f" if register in FLOAT_REGISTERS else "<I", raw)[0]
        if value != value or (register in (PMAX, VMAX, TMAX) and value <= 0.0):
            return
        if register == CONTROL_MODE and not 1 <= value <= 4:
            return
        self.registers[register] = value

    def _reply(self, operation: int, register: int) -> None:
        value = self.registers.get(register, 0)
        raw = struct.pack("<f", value) if register in FLOAT_REGISTERS else struct.pack("<I", int(value))
        identifier = int(self.registers[RECEIVE_ID]).to_bytes(2, "little")
        self.send(int(self.registers[FEEDBACK_ID]), identifier + bytes([operation, register]) + raw, False)


def from_code(code: int, bits: int, limit: float) -> float:
    """Value of a code that spans -limit to limit."""
    return code / ((1 << bits) - 1) * 2.0 * limit - limit


def to_code(value: float, bits: int, limit: float) -> int:
    """Nearest code, at the end of the range beyond it."""
    highest = (1 << bits) - 1
    return max(0, min(highest, round((value + limit) / (2.0 * limit) * highest)))

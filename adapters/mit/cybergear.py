"""CyberGear, and Robstride in its native protocol: 29-bit identifiers, 16-bit fields, torque inside the identifier.

Identifier: type << 24 | 16 data bits << 8 | address. Type 1 commands q16 dq16 kp16 kd16 and carries the torque in the
data bits; type 2 answers q16 dq16 tau16 and the temperature in tenths [xiaomi2023].
"""

import struct

from ..driver import name_bits
from ..link import CanFrame
from .codec import CODES_16, MitRanges, to_code
from .fault import CYBERGEAR_BITS, OWN_CODES
from .motor import Motor, MotorState
from .profile import Register, Registers

__all__ = ["CyberGearMotor"]

COMMAND, STATE, ENABLE, STOP, READ, WRITE = 1, 2, 3, 4, 17, 18
RUNNING = 2


class CyberGearMotor(Motor):
    """One motor.

    Args:
        address: Its identifier on the bus.
        feedback_id: Our own identifier, to which it answers.
        ranges: Of its model.
        registers: Its parameters.
    """

    gain_codes = CODES_16

    def __init__(self, address: int, feedback_id: int, ranges: MitRanges, registers: Registers) -> None:
        super().__init__(address, feedback_id, ranges, registers)
        self.enable_frame = self._frame(ENABLE, feedback_id)
        self.disable_frame = self._frame(STOP, feedback_id)
        self.clear_frame = self._frame(STOP, feedback_id, b"\x01" + bytes(7))
        self.poll_frame = self.disable_frame
        middle = to_code(0.0, -1.0, 1.0, CODES_16)
        self._idle = struct.pack(">HHHH", middle, middle, 0, 0)
        self.quanta = (
            2.0 * ranges.position / CODES_16,
            2.0 * ranges.velocity / CODES_16,
            2.0 * ranges.torque / CODES_16,
        )
        self.answer_key = address << 8 | feedback_id

    def _frame(self, kind: int, field: int, data: bytes = bytes(8)) -> CanFrame:
        return CanFrame(kind << 24 | field << 8 | self.address, data, True)

    def torque_frame(self, torque: float) -> CanFrame:
        """A command of torque alone [N·m].

        Raises:
            AdapterValueError: It is not finite.
        """
        limit = self.ranges.torque
        return self._frame(COMMAND, to_code(torque, -limit, limit, CODES_16), self._idle)

    def command_frame(self, position: float, velocity: float, kp: float, kd: float, torque: float) -> CanFrame:
        """A whole command [rad], [rad/s], [N·m/rad], [N·m·s/rad], [N·m]; values beyond a range saturate.

        Raises:
            AdapterValueError: A value is not finite.
        """
        r = self.ranges
        fields = (
            to_code(position, -r.position, r.position, CODES_16),
            to_code(velocity, -r.velocity, r.velocity, CODES_16),
            to_code(kp, 0.0, r.kp, CODES_16),
            to_code(kd, 0.0, r.kd, CODES_16),
        )
        return self._frame(COMMAND, to_code(torque, -r.torque, r.torque, CODES_16), struct.pack(">HHHH", *fields))

    def _is_mine(self, frame: CanFrame, kind: int) -> bool:
        identifier = frame.identifier
        return (
            frame.extended
            and len(frame.data) == 8
            and identifier >> 24 == kind
            and identifier & 0xFF == self.feedback_id
            and identifier >> 8 & 0xFF == self.address
        )

    def decode(self, frame: CanFrame) -> MotorState | None:
        """The state in a frame; None if it is another's, or damaged."""
        if not self._is_mine(frame, STATE):
            return None
        q, dq, tau, temperature = struct.unpack(">HHHH", frame.data)
        r, (q_step, dq_step, tau_step) = self.ranges, self.quanta
        fault, mode = frame.identifier >> 16 & 0x3F, frame.identifier >> 22 & 0x3
        return MotorState(
            q * q_step - r.position,
            dq * dq_step - r.velocity,
            tau * tau_step - r.torque,
            temperature * 0.1,
            fault,
            mode == RUNNING,
        )

    def describe_fault(self, code: int) -> str:
        """The words of a fault; empty where nobody says what it means."""
        return OWN_CODES.get(code) or name_bits(code, CYBERGEAR_BITS)

    def read_frame(self, register: Register) -> CanFrame:
        """The request to read a parameter."""
        return self._frame(READ, self.feedback_id, struct.pack("<HH", register.number, 0) + bytes(4))

    def write_frame(self, register: Register, value: bytes) -> CanFrame:
        """The request to write a parameter."""
        return self._frame(WRITE, self.feedback_id, struct.pack("<HH", register.number, 0) + value)

    def decode_register(self, frame: CanFrame) -> tuple[int, bytes] | None:
        """Number and four bytes of a parameter in an answer; None if it is something else."""
        if not self._is_mine(frame, READ):
            return None
        return int.from_bytes(frame.data[:2], "little"), frame.data[4:8]

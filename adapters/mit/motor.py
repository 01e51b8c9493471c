"""What the vendors of MIT-mode motors do differently, behind one interface."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from math import nan
from typing import NamedTuple

from fricomp.errors import AdapterConfigurationError

from ..link import CanFrame
from .codec import CODES_12, MitCodec, MitRanges
from .fault import AK_CODES, DAMIAO_CODES, OWN_CODES
from .profile import Register, Registers

__all__ = ["AkMotor", "DamiaoMotor", "Motor", "MotorState", "RobstrideMotor"]

ENABLE, DISABLE, CLEAR = (b"\xff" * 7 + bytes((last,)) for last in (0xFC, 0xFD, 0xFB))


class MotorState(NamedTuple):
    """One state frame.

    Attributes:
        position: [rad].
        velocity: [rad/s].
        torque: [N·m], estimated by the motor from its current.
        temperature: [°C]; NaN where not reported.
        fault: The vendor's code; 0 for none.
        enabled: Whether the motor is energised; None where not reported.
    """

    position: float
    velocity: float
    torque: float
    temperature: float
    fault: int
    enabled: bool | None


class Motor(ABC):
    """One motor: the frames it takes, and what its answers mean.

    Args:
        address: Its identifier on the bus.
        feedback_id: Identifier of its answers.
        ranges: Of its model.
        registers: Where it keeps its ranges, its mode and its watchdog; none that are unknown.

    Attributes:
        quanta: Steps of position [rad], velocity [rad/s] and torque [N·m].
        gain_codes: Number of steps from zero to the highest stiffness and damping.
        answer_key: Lower 16 bits of the identifiers of its answers.
        tells_when_asked: Whether `poll_frame` is a mere request. Where not, only a command is answered, and the one
            that is harmless at rest is to de-energise.
        has_own_feedback_id: Whether the identifier of its answers can be set for each motor.
        fault_words: What its fault codes mean.
        lost: Fault code of a motor that nothing but its own watchdog has stopped; None where it has none.
    """

    quanta: tuple[float, float, float]
    gain_codes = CODES_12
    tells_when_asked = has_own_feedback_id = False
    fault_words: Mapping[int, str] = {}
    lost: int | None = None

    def __init__(self, address: int, feedback_id: int, ranges: MitRanges, registers: Registers) -> None:
        self.address = address
        self.feedback_id = feedback_id
        self.ranges = ranges
        self.registers = registers
        self.codec = MitCodec(ranges)
        self.quanta = self.codec.position_quantum, self.codec.velocity_quantum, self.codec.torque_quantum
        self.answer_key = feedback_id
        self.enable_frame = CanFrame(address, ENABLE)
        self.disable_frame = CanFrame(address, DISABLE)
        self.clear_frame = CanFrame(address, CLEAR)
        self.poll_frame = self.disable_frame  # answered with the state, and harmless while the motor rests

    def torque_frame(self, torque: float) -> CanFrame:
        """A command of torque alone [N·m].

        Raises:
            AdapterValueError: It is not finite.
        """
        return CanFrame(self.address, self.codec.encode_torque(torque))

    def command_frame(self, position: float, velocity: float, kp: float, kd: float, torque: float) -> CanFrame:
        """A whole command [rad], [rad/s], [N·m/rad], [N·m·s/rad], [N·m]; values beyond a range saturate.

        Raises:
            AdapterValueError: A value is not finite.
        """
        return CanFrame(self.address, self.codec.encode(position, velocity, kp, kd, torque))

    @abstractmethod
    def decode(self, frame: CanFrame) -> MotorState | None:
        """The state in a frame; None if it is another's, or damaged."""

    def read_frame(self, register: Register) -> CanFrame:
        """The request to read a register.

        Raises:
            AdapterConfigurationError: This motor has none.
        """
        raise self._without_registers(register)

    def write_frame(self, register: Register, value: bytes) -> CanFrame:
        """The request to write the four bytes of a register.

        Raises:
            AdapterConfigurationError: This motor has none.
        """
        raise self._without_registers(register)

    def _without_registers(self, register: Register) -> AdapterConfigurationError:
        return AdapterConfigurationError(
            f"motor {self.address:#x} ({type(self).__name__}) has no registers: take {register} out of its profile"
        )

    def decode_register(self, frame: CanFrame) -> tuple[int, bytes] | None:
        """Number and four bytes of a register in an answer; None if it is something else."""
        return None

    def describe_fault(self, code: int) -> str:
        """The words of a fault; empty where nobody says what it means."""
        return OWN_CODES.get(code) or self.fault_words.get(code, "")


class DamiaoMotor(Motor):
    """Damiao: status in the upper half of the first byte, registers behind identifier 0x7FF [damiao2024]."""

    tells_when_asked = has_own_feedback_id = True
    fault_words, lost = DAMIAO_CODES, 0xD
    SERVICE_ID = 0x7FF
    READ, WRITE, REFRESH = 0x33, 0x55, 0xCC
    ANSWERS = (READ, WRITE)
    ENABLED = 1

    def __init__(self, address: int, feedback_id: int, ranges: MitRanges, registers: Registers) -> None:
        super().__init__(address, feedback_id, ranges, registers)
        self._own = bytes((address & 0xFF, address >> 8))
        self.poll_frame = CanFrame(self.SERVICE_ID, self._own + bytes((self.REFRESH, 0, 0, 0, 0, 0)))

    def decode(self, frame: CanFrame) -> MotorState | None:
        """The state in a frame; None if it is another's, an answer about a register, or damaged."""
        data = frame.data
        if frame.identifier != self.feedback_id or frame.extended or len(data) != 8:
            return None
        if data[0] & 0x0F != self.address & 0x0F or (data[2] in self.ANSWERS and self._is_answer(frame)):
            return None
        status = data[0] >> 4
        fault = status if status > self.ENABLED else 0
        return MotorState(*self.codec.decode(data[1:6]), float(max(data[6], data[7])), fault, status == self.ENABLED)

    def read_frame(self, register: Register) -> CanFrame:
        """The request to read a register."""
        return CanFrame(self.SERVICE_ID, self._own + bytes((self.READ, register.number, 0, 0, 0, 0)))

    def write_frame(self, register: Register, value: bytes) -> CanFrame:
        """The request to write the four bytes of a register."""
        return CanFrame(self.SERVICE_ID, self._own + bytes((self.WRITE, register.number)) + value)

    def decode_register(self, frame: CanFrame) -> tuple[int, bytes] | None:
        """Number and four bytes of a register in an answer to a request to read; None if it is something else."""
        return (frame.data[3], frame.data[4:8]) if self._is_answer(frame) and frame.data[2] == self.READ else None

    def _is_answer(self, frame: CanFrame) -> bool:
        # A state frame looks like this only with the position at the very edge of its range, which is a fault anyway.
        data = frame.data
        if frame.identifier != self.feedback_id or len(data) != 8 or data[:2] != self._own:
            return False
        return data[2] in self.ANSWERS


class AkMotor(Motor):
    """T-Motor AK: motor id in the first byte, temperature offset by 40 °C and error code at the end [cubemars2021]."""

    fault_words = AK_CODES

    def decode(self, frame: CanFrame) -> MotorState | None:
        """The state in a frame; firmware before 2022 sends six bytes, without temperature and error."""
        data = frame.data
        if frame.identifier != self.feedback_id or frame.extended or len(data) not in (6, 8):
            return None
        if data[0] != self.address & 0xFF:
            return None
        temperature, fault = (float(data[6]) - 40.0, data[7]) if len(data) == 8 else (nan, 0)
        return MotorState(*self.codec.decode(data[1:6]), temperature, fault, None)


class RobstrideMotor(Motor):
    """Robstride switched to its MIT protocol: motor id first, temperature in tenths at the end [robstride2024]."""

    def decode(self, frame: CanFrame) -> MotorState | None:
        """The state in a frame; None if it is another's, or damaged."""
        data = frame.data
        if frame.identifier != self.feedback_id or frame.extended or len(data) != 8 or data[0] != self.address:
            return None
        temperature = int.from_bytes(data[6:8], "big") * 0.1
        return MotorState(*self.codec.decode(data[1:6]), temperature, 0, None)

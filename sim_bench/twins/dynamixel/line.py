"""Dynamixel servos on one line, protocol 2.0: single, group and broadcast instructions."""

from collections.abc import Iterator, Sequence

from ...stand_in import StandIn
from ..port import BytePort
from ..serial_twin import SerialTwin
from .packet import BROADCAST, Instruction, PacketReader, StatusError, fast_status, status_packet
from .servo import DynamixelServo, DynamixelSettings
from .table import STATUS_RETURN_LEVEL

__all__ = ["DynamixelServo", "DynamixelSettings", "DynamixelTwin"]


RESET_ALL = b"\xff"
SLOW_READS = (Instruction.SYNC_READ, Instruction.BULK_READ)
FAST_READS = (Instruction.FAST_SYNC_READ, Instruction.FAST_BULK_READ)


class DynamixelTwin(SerialTwin):
    """Servos on one line.

    Args:
        port: The servos' end of the line.
        stand_in: The joints.
        servos: One for each joint.
    """

    drives: tuple[DynamixelServo, ...]

    def __init__(self, port: BytePort, stand_in: StandIn, servos: Sequence[DynamixelServo]) -> None:
        super().__init__(port, stand_in, servos)
        self._reader = PacketReader()

    def _feed(self, data: bytes) -> None:
        for identifier, instruction, parameters in self._reader.feed(data):
            if identifier == BROADCAST:
                self._broadcast(instruction, parameters)
                continue
            for servo in self.drives:
                if servo.identifier == identifier:
                    servo.feed()
                    self._single(servo, instruction, parameters)

    def _single(self, servo: DynamixelServo, instruction: int, parameters: bytes) -> None:
        address, identifier = int.from_bytes(parameters[:2], "little"), servo.identifier  # of the answer, too
        level = servo.table[STATUS_RETURN_LEVEL]
        error, data = 0, b""
        if instruction == Instruction.PING:
            data = bytes(servo.table[0:2]) + bytes(servo.table[6:7])
            level = 2
        elif instruction == Instruction.READ and len(parameters) == 4:
            error, data = servo.read(address, int.from_bytes(parameters[2:4], "little"))
            level = 2 if level else 0
        else:
            error = self._obey(servo, instruction, parameters)
        if level == 2:
            self._send(status_packet(identifier, error | servo.alert, data))

    def _obey(self, servo: DynamixelServo, instruction: int, parameters: bytes) -> int:
        """What a servo does on an instruction that reads nothing; the error of its status."""
        address, data = int.from_bytes(parameters[:2], "little"), parameters[2:]
        if instruction == Instruction.WRITE and data:
            return servo.write(address, data)
        if instruction == Instruction.REG_WRITE and data:
            return servo.hold(address, data)
        if instruction == Instruction.ACTION:
            return servo.act()
        if instruction == Instruction.REBOOT:
            servo.power_cycle()
            return 0
        if instruction == Instruction.FACTORY_RESET and len(parameters) == 1:
            return servo.reset(parameters[0])
        if instruction == Instruction.CLEAR:
            return servo.clear_turns(parameters)
        return StatusError.INSTRUCTION

    def _broadcast(self, instruction: int, parameters: bytes) -> None:
        """Instructions to all; none of them is answered but pings and reads of a group."""
        if instruction == Instruction.PING:
            for servo in sorted(self.drives, key=lambda each: each.identifier):
                self._single(servo, instruction, parameters)
        elif instruction in SLOW_READS or instruction in FAST_READS:
            self._group_read(instruction, parameters)
        elif instruction == Instruction.SYNC_WRITE:
            self._sync_write(parameters)
        elif instruction == Instruction.BULK_WRITE:
            self._bulk_write(parameters)
        elif not (instruction == Instruction.FACTORY_RESET and parameters == RESET_ALL):  # from firmware 42 on
            for servo in self.drives:
                servo.feed()
                self._obey(servo, instruction, parameters)

    def _group_read(self, instruction: int, parameters: bytes) -> None:
        """A status of each servo, or of a fast read one packet of all."""
        parts = []
        for servo, start, length in self._asked(instruction, parameters):
            servo.feed()
            error, data = servo.read(start, length)
            parts.append((servo.identifier, error | servo.alert, data))
        if instruction in FAST_READS and parts:
            self._send(fast_status(parts))
        else:
            self._send(b"".join(status_packet(*part) for part in parts))

    def _asked(self, instruction: int, parameters: bytes) -> Iterator[tuple[DynamixelServo, int, int]]:
        """The servos that a group read names, in its order, each with address and length."""
        if instruction in (Instruction.SYNC_READ, Instruction.FAST_SYNC_READ):
            yield from ((servo, *_two_words(parameters)) for servo in self._named(parameters[4:]))
            return
        for at in range(0, len(parameters) - 4, 5):
            place = _two_words(parameters[at + 1 : at + 5])
            yield from ((servo, *place) for servo in self._named(parameters[at : at + 1]))

    def _sync_write(self, parameters: bytes) -> None:
        start, length = _two_words(parameters)
        step = length + 1
        for at in range(4, len(parameters) - length, step):
            for servo in self._named(parameters[at : at + 1]):
                servo.feed()
                servo.write(start, parameters[at + 1 : at + step])

    def _bulk_write(self, parameters: bytes) -> None:
        """Each servo its own address and length; what is cut short is for nobody."""
        at = 0
        while at + 5 < len(parameters):
            start, length = _two_words(parameters[at + 1 : at + 5])
            data = parameters[at + 5 : at + 5 + length]
            if len(data) == length:
                for servo in list(self._named(parameters[at : at + 1])):
                    servo.feed()
                    servo.write(start, data)
            at += 5 + length

    def _named(self, identifiers: bytes) -> Iterator[DynamixelServo]:
        for identifier in identifiers:
            yield from (servo for servo in self.drives if servo.identifier == identifier)

    def _power_cycle(self) -> None:
        self._reader = PacketReader()
        super()._power_cycle()


def _two_words(parameters: bytes) -> tuple[int, int]:
    return int.from_bytes(parameters[:2], "little"), int.from_bytes(parameters[2:4], "little")

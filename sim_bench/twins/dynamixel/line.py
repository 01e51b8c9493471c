"""Dynamixel servos on one line, protocol 2.0: single, group and broadcast instructions."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from ...stand_in import StandIn
from ..port import BytePort
from ..serial_twin import SerialTwin
from .packet import Instruction, PacketReader, StatusError, status_packet
from .servo import DynamixelServo, DynamixelSettings
from .table import STATUS_RETURN_LEVEL

__all__ = ["DynamixelServo", "DynamixelSettings", "DynamixelTwin"]

BROADCAST = 0xFE


class DynamixelTwin(SerialTwin):
    """Servos on one line.

    Args:
        port: The servos' end of the line.
        stand_in: The joints.
        servos: One for each joint.
    """

    def __init__(self, port: BytePort, stand_in: StandIn, servos: Sequence[DynamixelServo]) -> None:
        super().__init__(port, stand_in)
        self.servos = tuple(servos)
        self._reader = PacketReader()

    def _feed(self, data: bytes) -> None:
        for identifier, instruction, parameters in self._reader.feed(data):
            if identifier == BROADCAST:
                self._broadcast(instruction, parameters)
                continue
            for servo in self.servos:
                if servo.identifier == identifier:
                    servo.feed()
                    self._single(servo, instruction, parameters)

    def _single(self, servo: DynamixelServo, instruction: int, parameters: bytes) -> None:
        address = int.from_bytes(parameters[:2], "little")
        level = servo.table[STATUS_RETURN_LEVEL]
        error, data = 0, b""
        if instruction == Instruction.PING:
            data = bytes(servo.table[0:2]) + bytes(servo.table[6:7])
            level = 2
        elif instruction == Instruction.READ and len(parameters) == 4:
            error, data = servo.read(address, int.from_bytes(parameters[2:4], "little"))
            level = 2 if level else 0
        elif instruction == Instruction.WRITE and len(parameters) > 2:
            error = servo.write(address, parameters[2:])
        elif instruction == Instruction.REG_WRITE and len(parameters) > 2:
            error = servo.hold(address, parameters[2:])
        elif instruction == Instruction.ACTION:
            error = servo.act()
        elif instruction == Instruction.REBOOT:
            servo.power_cycle()
        else:
            error = StatusError.INSTRUCTION
        if level == 2:
            self._send(status_packet(servo.identifier, error | servo.alert, data))

    def _broadcast(self, instruction: int, parameters: bytes) -> None:
        if instruction == Instruction.PING:
            for servo in sorted(self.servos, key=lambda each: each.identifier):
                self._single(servo, instruction, parameters)
        elif instruction in (Instruction.SYNC_READ, Instruction.BULK_READ):
            for servo, start, length in self._asked(instruction, parameters):
                servo.feed()
                error, data = servo.read(start, length)
                self._send(status_packet(servo.identifier, error | servo.alert, data))
        elif instruction == Instruction.SYNC_WRITE:
            self._sync_write(parameters)
        elif instruction == Instruction.ACTION:
            for servo in self.servos:
                servo.act()

    def _asked(self, instruction: int, parameters: bytes) -> Iterator[tuple[DynamixelServo, int, int]]:
        """The servos that a group read names, in its order, each with address and length."""
        if instruction == Instruction.SYNC_READ:
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

    def _named(self, identifiers: bytes) -> Iterator[DynamixelServo]:
        for identifier in identifiers:
            yield from (servo for servo in self.servos if servo.identifier == identifier)

    def _tick(self, now_ns: int) -> None:
        for servo in self.servos:
            servo.tick(now_ns)

    def _power_cycle(self) -> None:
        self._reader = PacketReader()
        for servo in self.servos:
            servo.power_cycle()


def _two_words(parameters: bytes) -> tuple[int, int]:
    return int.from_bytes(parameters[:2], "little"), int.from_bytes(parameters[2:4], "little")

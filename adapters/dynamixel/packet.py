"""Packets of Dynamixel protocol 2.0: FF FF FD 00, id, length, instruction, parameters, CRC [robotis2024]."""

from __future__ import annotations

from collections.abc import Mapping
from enum import IntEnum
from functools import cache, reduce
from operator import getitem, xor
from typing import NamedTuple

__all__ = [
    "BROADCAST",
    "Instruction",
    "PacketBuffer",
    "StatusPacket",
    "compute_crc",
    "encode_packet",
    "read_packet",
    "sync_read_packet",
    "sync_write_packet",
    "write_packet",
]

HEADER = b"\xff\xff\xfd\x00"
BROADCAST = 0xFE
STATUS = 0x55
SHORTEST, LONGEST = 4, 512
POLYNOMIAL = 0x8005
LONGEST_TABLED = 64  # states of servos are 30 bytes; what is longer is rare


class Instruction(IntEnum):
    """Instructions that the adapter gives."""

    READ = 0x02
    WRITE = 0x03
    REBOOT = 0x08
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83


class StatusPacket(NamedTuple):
    """An answer.

    Attributes:
        identifier: Servo.
        error: Lower seven bits: what was wrong with the instruction; bit 7: there is a hardware error.
        data: What was asked for.
    """

    identifier: int
    error: int
    data: bytes


def _make_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        crc = byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (POLYNOMIAL if crc & 0x8000 else 0)) & 0xFFFF
        table.append(crc)
    return tuple(table)


CRC_TABLE = _make_table()


@cache
def _position_tables(n_bytes: int) -> tuple[tuple[int, ...], ...]:
    """What each byte of a string contributes to its CRC, by its place: the CRC is linear, and starts from 0."""
    tables = [CRC_TABLE]
    while len(tables) < n_bytes:  # one more zero byte behind it
        tables.append(tuple((crc << 8 & 0xFF00) ^ CRC_TABLE[crc >> 8] for crc in tables[-1]))
    return tuple(reversed(tables[:n_bytes]))


def compute_crc(data: bytes) -> int:
    """CRC-16 with polynomial 0x8005 from 0."""
    if len(data) <= LONGEST_TABLED:
        return reduce(xor, map(getitem, _position_tables(len(data)), data), 0)
    crc = 0
    for byte in data:
        crc = (crc << 8 & 0xFF00) ^ CRC_TABLE[crc >> 8 ^ byte]
    return crc


def encode_packet(identifier: int, instruction: int, parameters: bytes = b"") -> bytes:
    """A whole packet; FF FF FD inside is stuffed, so that it does not look like a header."""
    body = (bytes((instruction,)) + parameters).replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
    packet = HEADER + bytes((identifier,)) + (len(body) + 2).to_bytes(2, "little") + body
    return packet + compute_crc(packet).to_bytes(2, "little")


def _words(*values: int) -> bytes:
    return b"".join(value.to_bytes(2, "little") for value in values)


def read_packet(identifier: int, address: int, n_bytes: int) -> bytes:
    """Ask one servo for some bytes of its table."""
    return encode_packet(identifier, Instruction.READ, _words(address, n_bytes))


def write_packet(identifier: int, address: int, data: bytes) -> bytes:
    """Write some bytes of one servo's table."""
    return encode_packet(identifier, Instruction.WRITE, _words(address) + data)


def sync_read_packet(address: int, n_bytes: int, identifiers: bytes) -> bytes:
    """Ask several servos for the same bytes."""
    return encode_packet(BROADCAST, Instruction.SYNC_READ, _words(address, n_bytes) + identifiers)


def sync_write_packet(address: int, values: Mapping[int, bytes]) -> bytes:
    """Write the same address of several servos, in one packet: all or none."""
    n_bytes = len(next(iter(values.values())))
    data = b"".join(bytes((identifier,)) + value for identifier, value in values.items())
    return encode_packet(BROADCAST, Instruction.SYNC_WRITE, _words(address, n_bytes) + data)


class PacketBuffer:
    """Finds status packets in bytes as they come; what is damaged is dropped and counted."""

    def __init__(self) -> None:
        self._bytes = bytearray()
        self.n_damaged = 0

    def take(self, data: bytes) -> list[StatusPacket]:
        """The packets that are complete now."""
        self._bytes += data
        packets: list[StatusPacket] = []
        while (size := self._find()) is not None:
            packet = bytes(self._bytes[:size])
            if int.from_bytes(packet[-2:], "little") != compute_crc(packet[:-2]):
                self.n_damaged += 1
                del self._bytes[:1]  # the next header may lie inside
                continue
            del self._bytes[:size]
            body = packet[7:-2].replace(b"\xff\xff\xfd\xfd", b"\xff\xff\xfd")
            if body[0] == STATUS and len(body) >= 2:
                packets.append(StatusPacket(packet[4], body[1], body[2:]))
        return packets

    def _find(self) -> int | None:
        """Move to the next header; size of its packet once all of it is there."""
        while True:
            start = self._bytes.find(HEADER)
            if start < 0:
                del self._bytes[: max(len(self._bytes) - 3, 0)]
                return None
            del self._bytes[:start]
            if len(self._bytes) < 7:
                return None
            length = int.from_bytes(self._bytes[5:7], "little")
            if SHORTEST <= length <= LONGEST:
                return length + 7 if len(self._bytes) >= length + 7 else None
            self.n_damaged += 1
            del self._bytes[:1]

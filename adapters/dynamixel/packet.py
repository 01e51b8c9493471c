"""Packets of Dynamixel protocol 2.0: FF FF FD 00, id, length, instruction, parameters, CRC [robotis2024]."""

import struct
from collections.abc import Mapping, Sequence
from enum import IntEnum
from typing import NamedTuple

from .checksum import add_to_crc, compute_crc, head_crc, position_tables

HEADER = b"\xff\xff\xfd\x00"
# What looks like a header within a packet, and how it is written so that it does not.
HEADER_LIKE, STUFFED = b"\xff\xff\xfd", b"\xff\xff\xfd\xfd"
BROADCAST = 0xFE
STATUS = 0x55


class Instruction(IntEnum):
    """Instructions that the adapter gives."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REBOOT = 0x08
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    BULK_READ = 0x92


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


def encode_packet(identifier: int, instruction: int, parameters: bytes = b"") -> bytes:
    """A whole packet; FF FF FD inside is stuffed, so that it does not look like a header."""
    body = (bytes((instruction,)) + parameters).replace(HEADER_LIKE, STUFFED)
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


def bulk_read_packet(n_bytes: int, addresses: Mapping[int, int]) -> bytes:
    """Ask several servos for as many bytes from an address of each one's own."""
    asked = (bytes((identifier,)) + _words(address, n_bytes) for identifier, address in addresses.items())
    return encode_packet(BROADCAST, Instruction.BULK_READ, b"".join(asked))


def sync_write_packet(address: int, values: Mapping[int, bytes]) -> bytes:
    """Write the same address of several servos, in one packet: all or none."""
    n_bytes = len(next(iter(values.values())))
    data = b"".join(bytes((identifier,)) + value for identifier, value in values.items())
    return encode_packet(BROADCAST, Instruction.SYNC_WRITE, _words(address, n_bytes) + data)


class SyncWriter:
    """The packet that writes the same address of the same servos, cycle after cycle: only the values change.

    Args:
        address: Where.
        n_bytes: Of each value, 2 or 4.
        identifiers: Of the servos.
    """

    def __init__(self, address: int, n_bytes: int, identifiers: bytes) -> None:
        self._address = address
        self._layout = struct.Struct("<" + {2: "Bh", 4: "Bi"}[n_bytes] * len(identifiers))
        self._fields = [0] * (2 * len(identifiers))
        self._fields[0::2] = identifiers
        whole = sync_write_packet(address, dict.fromkeys(identifiers, bytes(n_bytes)))
        self._head = whole[: -2 - self._layout.size]
        self._head_crc = head_crc(self._head, self._layout.size)
        self._tables = position_tables(self._layout.size)

    def encode(self, counts: Sequence[int]) -> bytes:
        """The packet; each value must fit into its bytes."""
        fields = self._fields
        fields[1::2] = counts
        values = self._layout.pack(*fields)
        if HEADER_LIKE in values:
            n_bytes = len(values) // len(counts)
            parts = (values[at : at + n_bytes] for at in range(0, len(values), n_bytes))
            return sync_write_packet(self._address, {part[0]: part[1:] for part in parts})
        return self._head + values + add_to_crc(self._head_crc, values, self._tables).to_bytes(2, "little")

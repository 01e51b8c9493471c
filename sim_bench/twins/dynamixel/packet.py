"""Packets of Dynamixel protocol 2.0 as a servo takes and makes them."""

from collections.abc import Iterator, Sequence
from enum import IntEnum

__all__ = ["BROADCAST", "Instruction", "PacketReader", "StatusError", "crc16", "fast_status", "status_packet"]

HEADER = b"\xff\xff\xfd\x00"
STUFFED, PLAIN = b"\xff\xff\xfd\xfd", b"\xff\xff\xfd"
STATUS = 0x55
BROADCAST = 0xFE
CRC_POLYNOMIAL = 0x8005
LONGEST = 1024


class Instruction(IntEnum):
    """Instructions that the twin knows."""

    PING = 0x01
    READ = 0x02
    WRITE = 0x03
    REG_WRITE = 0x04
    ACTION = 0x05
    FACTORY_RESET = 0x06
    REBOOT = 0x08
    CLEAR = 0x10
    SYNC_READ = 0x82
    SYNC_WRITE = 0x83
    FAST_SYNC_READ = 0x8A
    BULK_READ = 0x92
    BULK_WRITE = 0x93
    FAST_BULK_READ = 0x9A


class StatusError(IntEnum):
    """Lower seven bits of a status packet's error."""

    RESULT_FAIL = 1
    INSTRUCTION = 2
    CRC = 3
    DATA_RANGE = 4
    DATA_LENGTH = 5
    DATA_LIMIT = 6
    ACCESS = 7


class PacketReader:
    """Finds instruction packets in bytes that come in any pieces; what is damaged is dropped in silence."""

    def __init__(self) -> None:
        self._bytes = bytearray()

    def feed(self, data: bytes) -> Iterator[tuple[int, int, bytes]]:
        """(id, instruction, parameters) of each whole packet."""
        buffer = self._bytes
        buffer += data
        while True:
            start = buffer.find(HEADER)
            if start < 0:
                del buffer[: -len(HEADER) + 1]
                return
            del buffer[:start]
            if len(buffer) < 7:
                return
            length = int.from_bytes(buffer[5:7], "little")
            if not 3 <= length <= LONGEST:
                del buffer[:1]
                continue
            if len(buffer) < 7 + length:
                return
            packet = bytes(buffer[: 7 + length])
            if crc16(packet[:-2]) != int.from_bytes(packet[-2:], "little"):
                del buffer[:1]
                continue
            del buffer[: 7 + length]
            body = packet[7:-2].replace(STUFFED, PLAIN)
            if body and body[0] != STATUS:
                yield packet[4], body[0], body[1:]


def status_packet(identifier: int, error: int, data: bytes) -> bytes:
    """A status packet."""
    body = bytes([STATUS, error]) + data
    body = body.replace(PLAIN, STUFFED)
    packet = HEADER + bytes([identifier]) + (len(body) + 2).to_bytes(2, "little") + body
    return packet + crc16(packet).to_bytes(2, "little")


def fast_status(parts: Sequence[tuple[int, int, bytes]]) -> bytes:
    """The one packet in which several servos answer a fast read: error, id, data and the CRC so far of each, unstuffed.

    Args:
        parts: Id, error and data of each servo, in the order of the request.
    """
    length = sum(len(data) + 4 for _, _, data in parts) + 1
    packet = HEADER + bytes([BROADCAST]) + length.to_bytes(2, "little") + bytes([STATUS])
    for identifier, error, data in parts:
        packet += bytes([error, identifier]) + data
        packet += crc16(packet).to_bytes(2, "little")
    return packet


def crc16(data: bytes) -> int:
    """CRC-16 with polynomial 0x8005, from zero, most significant bit first."""
    crc = 0
    for byte in data:
        crc = (crc << 8 & 0xFF00) ^ _CRC_OF_BYTE[crc >> 8 ^ byte]
    return crc


def _crc_of_byte(byte: int) -> int:
    crc = byte << 8
    for _ in range(8):
        crc = (crc << 1 ^ (CRC_POLYNOMIAL if crc & 0x8000 else 0)) & 0xFFFF
    return crc


_CRC_OF_BYTE = tuple(map(_crc_of_byte, range(256)))

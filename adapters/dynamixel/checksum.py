"""CRC-16 of Dynamixel packets: polynomial 0x8005 from 0, most significant bit first [robotis2024].

The CRC is linear: that of a packet is the sum, bit by bit, of what its parts contribute where they stand. So the parts
that never change are reckoned once, and each further byte costs one look into the table of its place.
"""

from collections.abc import Sequence
from functools import cache, reduce
from operator import getitem, xor

__all__ = ["add_to_crc", "closing_tables", "compute_crc", "head_crc", "position_tables"]

POLYNOMIAL = 0x8005
LONGEST_TABLED = 64  # states of servos are shorter; what is longer is rare


def _make_table() -> tuple[int, ...]:
    table = []
    for byte in range(256):
        crc = byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (POLYNOMIAL if crc & 0x8000 else 0)) & 0xFFFF
        table.append(crc)
    return tuple(table)


CRC_TABLE = _make_table()


# What a byte contributes with so many bytes behind it; grows to the longest packet that is ever sent.
TABLES_BY_DISTANCE = [CRC_TABLE]
CRC_BYTES = tuple(range(256)), tuple(range(0, 1 << 16, 256))


@cache
def position_tables(n_bytes: int) -> tuple[tuple[int, ...], ...]:
    """What each byte of the last `n_bytes` of a packet contributes to its CRC, by its place."""
    tables = TABLES_BY_DISTANCE
    while len(tables) < n_bytes:  # one more zero byte behind it
        tables.append(tuple((crc << 8 & 0xFF00) ^ CRC_TABLE[crc >> 8] for crc in tables[-1]))
    return tuple(reversed(tables[:n_bytes]))


@cache
def closing_tables(n_bytes: int) -> tuple[tuple[int, ...], ...]:
    """`position_tables`, and more for the CRC that follows, low byte first: with it all adds up to 0 if it is right."""
    return (*position_tables(n_bytes), *CRC_BYTES)


def head_crc(head: bytes, n_further: int) -> int:
    """What the first bytes of a packet contribute to its CRC when `n_further` follow."""
    return compute_crc(head + bytes(n_further))


def add_to_crc(crc: int, data: bytes, tables: Sequence[Sequence[int]]) -> int:
    """The CRC of a packet that ends with `data`, from what its head contributes.

    Args:
        crc: Of the head, by `head_crc`.
        data: The rest.
        tables: `position_tables` of its length.
    """
    return reduce(xor, map(getitem, tables, data), crc)


def compute_crc(data: bytes) -> int:
    """The CRC of some bytes."""
    if len(data) <= LONGEST_TABLED:
        return add_to_crc(0, data, position_tables(len(data)))
    crc = 0
    for byte in data:
        crc = (crc << 8 & 0xFF00) ^ CRC_TABLE[crc >> 8 ^ byte]
    return crc

"""Status packets in bytes as they come, in any pieces."""

from functools import reduce
from operator import getitem, xor
from typing import NamedTuple

from .checksum import closing_tables, compute_crc, head_crc
from .packet import HEADER, HEADER_LIKE, STATUS, STUFFED, StatusPacket

__all__ = ["PacketBuffer"]

SHORTEST, LONGEST = 4, 512
# Header, id, length, instruction and error: the same in every answer of a healthy servo to the same question.
HEAD = 9
MOST_HEADS, LONGEST_REST = 256, 64


class _KnownHead(NamedTuple):
    """What is reckoned once for packets that begin alike: size of the rest, and what the head adds to the CRC."""

    identifier: int
    error: int
    n_rest: int
    crc: int
    tables: tuple[tuple[int, ...], ...]


class PacketBuffer:
    """Finds status packets; what is damaged is dropped and counted."""

    def __init__(self) -> None:
        self._left = b""
        self._heads: dict[bytes, _KnownHead] = {}
        self.n_damaged = 0

    def take(self, data: bytes) -> list[StatusPacket]:
        """The packets that are complete now."""
        data, at, heads = self._left + data, 0, self._heads
        packets: list[StatusPacket] = []
        while True:
            known = heads.get(data[at : at + HEAD])
            if known is not None:
                identifier, error, n_rest, crc, tables = known
                rest = data[at + HEAD : at + HEAD + n_rest]
                is_right = len(rest) == n_rest and not reduce(xor, map(getitem, tables, rest), crc)
                if is_right and HEADER_LIKE not in rest:
                    packets.append(StatusPacket(identifier, error, rest[:-2]))
                    at += HEAD + n_rest
                    continue
            start = data.find(HEADER, at)
            if start < 0:
                self._left = data[max(at, len(data) - 3) :]  # the last three bytes may be the beginning of one
                return packets
            size = _size_at(data, start)
            # No header stands inside a packet, where its bytes are stuffed: one that does has lost the end before it.
            other = data.find(HEADER, start + 1, len(data) if size is None else start + size)
            if other >= 0:
                self.n_damaged += 1
                at = other
                continue
            if size is None:
                self._left = data[start:]
                return packets
            at = self._take_whole(data[start : start + size], packets) + start

    def _take_whole(self, whole: bytes, packets: list[StatusPacket]) -> int:
        """Add a packet, unless it is damaged or an instruction to somebody, and remember its head; how far to go on."""
        if not whole or compute_crc(whole[:-2]) != int.from_bytes(whole[-2:], "little"):
            self.n_damaged += 1
            return 1  # the next header may lie inside
        body = whole[7:-2].replace(STUFFED, HEADER_LIKE)
        if body[0] != STATUS or len(body) < 2:
            return len(whole)
        packets.append(StatusPacket(whole[4], body[1], body[2:]))
        n_rest = len(whole) - HEAD
        if 2 < n_rest <= LONGEST_REST and len(self._heads) < MOST_HEADS:
            head = whole[:HEAD]
            crc = head_crc(head, n_rest - 2)
            self._heads[head] = _KnownHead(whole[4], whole[8], n_rest, crc, closing_tables(n_rest - 2))
        return len(whole)


def _size_at(data: bytes, start: int) -> int | None:
    """Size of the packet whose header is at `start`; None while it is not all there, 0 if no packet is that long."""
    if len(data) < start + 7:
        return None
    length = data[start + 5] | data[start + 6] << 8
    if not SHORTEST <= length <= LONGEST:
        return 0
    return length + 7 if len(data) >= start + 7 + length else None

"""Subframes of the multiplex protocol that moteus speaks."""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite, nan

__all__ = [
    "LONGEST_FRAME",
    "Failure",
    "Read",
    "StreamPoll",
    "StreamWrite",
    "Write",
    "encode_reply",
    "encode_stream",
    "parse_frame",
]

INT8, INT16, INT32, FLOAT = range(4)
FORMATS = ("<b", "<h", "<i", "<f")
NOP = 0x50
# A CAN-FD frame holds no more bytes, so none asks for or carries more registers.
LONGEST_FRAME = 64

# Registers by what their integers count: value of one count as int8, int16 and int32.
PLAIN = (1.0, 1.0, 1.0)
POSITION = (0.01, 0.0001, 0.00001)
VELOCITY = (0.1, 0.00025, 0.00001)
TORQUE = (0.5, 0.01, 0.001)
CURRENT = (1.0, 0.1, 0.001)
TEMPERATURE = (1.0, 0.1, 0.001)
VOLTAGE = (0.5, 0.1, 0.001)
SHARE = (1.0 / 127.0, 1.0 / 32767.0, 1.0 / 2147483647.0)
TIME = (0.01, 0.001, 0.000001)
ACCELERATION = (0.05, 0.001, 0.00001)
SCALES = {
    **dict.fromkeys((0x001, 0x006, 0x020, 0x026, 0x040, 0x041), POSITION),
    **dict.fromkeys((0x002, 0x021, 0x028), VELOCITY),
    **dict.fromkeys((0x003, 0x022, 0x025, 0x042, 0x045), TORQUE),
    **dict.fromkeys((0x004, 0x005, 0x01C, 0x01D), CURRENT),
    **dict.fromkeys((0x00A, 0x00E), TEMPERATURE),
    0x00D: VOLTAGE,
    **dict.fromkeys((0x023, 0x024, 0x043, 0x044, 0x047), SHARE),
    **dict.fromkeys((0x027, 0x046), TIME),
    0x029: ACCELERATION,
}


@dataclass(frozen=True)
class Write:
    """A register to be written; NaN where the integer says "not given"."""

    register: int
    value: float


@dataclass(frozen=True)
class Read:
    """A register to be answered in this kind of number."""

    register: int
    kind: int


@dataclass(frozen=True)
class StreamWrite:
    """Bytes for a diagnostic channel."""

    channel: int
    data: bytes


@dataclass(frozen=True)
class StreamPoll:
    """A request for what a diagnostic channel has to say."""

    channel: int
    longest: int


@dataclass(frozen=True)
class Failure:
    """A register that could not be written (0x30) or read (0x31)."""

    kind: int
    register: int
    code: int

    def encode(self) -> bytes:
        """The subframe."""
        return bytes([self.kind]) + _encode_varuint(self.register) + _encode_varuint(self.code)


class _Bytes:
    """A frame being read; running past its end raises IndexError or struct.error."""

    def __init__(self, data: bytes) -> None:
        self.data, self.at = data, 0

    def varuint(self) -> int:
        value = shift = 0
        while True:
            byte = self.data[self.at]
            self.at += 1
            value |= (byte & 0x7F) << shift
            shift += 7
            if byte < 0x80 or shift > 28:
                return value

    def number(self, kind: int) -> float:
        (value,) = struct.unpack_from(FORMATS[kind], self.data, self.at)
        self.at += struct.calcsize(FORMATS[kind])
        return float(value) if kind == FLOAT or value != -(1 << (8, 16, 32)[kind] - 1) else nan

    def take(self, count: int) -> bytes:
        chunk = self.data[self.at : self.at + count]
        self.at += count
        return chunk


def parse_frame(data: bytes) -> Iterator[Write | Read | StreamWrite | StreamPoll]:
    """What a frame asks for; a damaged or unknown remainder is dropped, as the firmware does."""
    stream = _Bytes(data)
    try:
        while stream.at < len(data):
            yield from _parse_subframe(stream)
    except (IndexError, struct.error):
        return


def _parse_subframe(stream: _Bytes) -> Iterator[Write | Read | StreamWrite | StreamPoll]:
    head = stream.varuint()
    kind, count = head >> 2 & 0x3, head & 0x3
    if head == NOP:
        return
    if head < 0x20:
        count = count or stream.varuint()
        first = stream.varuint()
        for register in range(first, first + min(count, LONGEST_FRAME)):
            if head >= 0x10:
                yield Read(register, kind)
            else:
                yield Write(register, _scaled(register, kind, stream.number(kind)))
    elif head == 0x40:
        channel, size = stream.varuint(), stream.varuint()
        yield StreamWrite(channel, stream.take(size))
    elif head == 0x42:
        yield StreamPoll(stream.varuint(), stream.varuint())
    else:
        stream.at = len(stream.data)


def encode_reply(register: int, kind: int, value: float) -> bytes:
    """The answer to a read; integers saturate, truncate as the firmware does, and say NaN as their least."""
    head = bytes([0x20 | kind << 2 | 1]) + _encode_varuint(register)
    if kind == FLOAT:
        return head + struct.pack("<f", value)
    highest = (1 << (8, 16, 32)[kind] - 1) - 1
    if not isfinite(value):
        return head + struct.pack(FORMATS[kind], -highest - 1)
    counts = value / SCALES.get(register, PLAIN)[kind]
    return head + struct.pack(FORMATS[kind], int(max(-highest, min(highest, counts))))


def encode_stream(channel: int, data: bytes) -> bytes:
    """Bytes of a diagnostic channel."""
    return b"\x41" + _encode_varuint(channel) + _encode_varuint(len(data)) + data


def _scaled(register: int, kind: int, value: float) -> float:
    return value if kind == FLOAT else value * SCALES.get(register, PLAIN)[kind]


def _encode_varuint(value: int) -> bytes:
    encoded = bytearray()
    while value > 0x7F:
        encoded.append(value & 0x7F | 0x80)
        value >>= 7
    encoded.append(value)
    return bytes(encoded)

"""The text protocol of the fdcanusb: `can send ID HEX` out, `OK` and `rcv ID HEX ...` back [mjbots2024]."""

from binascii import hexlify, unhexlify
from typing import NamedTuple

from fricomp.joint import CommandMode

from .codec import POSITION_HEAD, REFERENCES, encode_command, encode_references, pad

__all__ = [
    "HEAD_SIZE",
    "CommandLine",
    "LineBuffer",
    "ReceivedFrame",
    "decode_known",
    "decode_line",
    "encode_line",
    "line_heads",
]

REPLY_WANTED = 0x8000
LONGEST_LINE = 256
HEAD_SIZE = len("rcv 0100 ")


class ReceivedFrame(NamedTuple):
    """A frame from the bus.

    Attributes:
        source: Controller that sent it.
        data: At most 64 bytes.
    """

    source: int
    data: bytes


def encode_line(destination: int, data: bytes) -> bytes:
    """The line that sends a frame and asks for an answer."""
    return b"can send %04x %s\n" % (REPLY_WANTED | destination, hexlify(data))


def decode_line(line: bytes) -> ReceivedFrame | None:
    """The frame in a line; None if it is another line, or damaged."""
    if line[:4] != b"rcv ":
        return None
    try:
        _, source, data, *_ = line.split(None, 3)
        return ReceivedFrame(int(source, 16) >> 8 & 0x7F, unhexlify(data))
    except ValueError:
        return None


def line_heads(source: int) -> tuple[bytes, bytes]:
    """How the lines of frames from a controller to us usually begin."""
    return b"rcv %02x00 " % source, b"rcv %02X00 " % source


def decode_known(line: bytes) -> bytes | None:
    """The data in a line with one of `line_heads`; None if it has to be looked at more closely."""
    try:
        return unhexlify(line[HEAD_SIZE:].partition(b" ")[0])
    except ValueError:
        return None


class CommandLine:
    """A command whose line is put together from a prepared head and tail: only references and torque vary.

    Args:
        address: Controller.
        mode: Command mode.
        highest_torque: Bound on all that its loop commands [N·m].
        timeout: Time after which a command lapses [s].
    """

    def __init__(self, address: int, mode: CommandMode, highest_torque: float, timeout: float) -> None:
        line = encode_line(address, pad(encode_command(mode, 0.0, 0.0, highest_torque, timeout)))
        start = line.index(hexlify(POSITION_HEAD)) + 2 * len(POSITION_HEAD)
        self._head, self._tail = line[:start], line[start + 2 * REFERENCES.size :]
        self._mode, self._highest = mode, highest_torque

    def encode(self, torque: float, reference: float) -> bytes:
        """The line for a torque [N·m] and a reference [rad/s] or [rad].

        Raises:
            AdapterValueError: A value is not finite, or beyond a 32 bit float.
        """
        values = encode_references(self._mode, torque, reference, self._highest)
        return self._head + hexlify(values) + self._tail


class LineBuffer:
    """Puts lines together from bytes as they come; a line without end is dropped."""

    def __init__(self) -> None:
        self._partial = b""
        self.n_dropped = 0

    def take(self, data: bytes) -> list[bytes]:
        """The lines that are complete now."""
        *lines, self._partial = (self._partial + data).split(b"\n")
        if len(self._partial) > LONGEST_LINE:
            self._partial = b""
            self.n_dropped += 1
        return lines

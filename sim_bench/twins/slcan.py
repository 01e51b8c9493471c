"""A CAN adapter on a serial line (Lawicel's slcan) for CAN twins in another process, without CAN in the kernel."""

from collections import deque

import can

from .port import BytePort

__all__ = ["SlcanPort"]

OK, BELL = b"\r", b"\a"
# Length of identifier in hex digits, by frame letter: small for 11 bits, capital for 29; r and R are remote frames.
IDENTIFIER_DIGITS = {"t": 3, "r": 3, "T": 8, "R": 8}
LONGEST_LINE = 64


class SlcanPort:
    """The adapter's end of the line; a `CanPort` for a twin.

    Args:
        port: The byte stream.
    """

    def __init__(self, port: BytePort) -> None:
        self.port = port
        self._line = bytearray()
        self._frames: deque[can.Message] = deque()
        self.is_open = False
        """Whether the channel was opened with `O`."""

    def recv(self, timeout: float | None = None) -> can.Message | None:
        """The next frame that the other end sent; never waits."""
        if not self._frames:
            for byte in self.port.read():
                self._take(byte)
        return self._frames.popleft() if self._frames else None

    def send(self, msg: can.Message) -> None:
        """Pass a frame to the other end, if the channel is open."""
        if not self.is_open:
            return
        letter = "T" if msg.is_extended_id else "t"
        identifier = f"{msg.arbitration_id:0{IDENTIFIER_DIGITS[letter]}X}"
        self.port.write(f"{letter}{identifier}{msg.dlc}{bytes(msg.data).hex().upper()}\r".encode())

    def shutdown(self) -> None:
        """Close the line."""
        self.port.close()

    def _take(self, byte: int) -> None:
        if byte != 0x0D:
            if len(self._line) < LONGEST_LINE:
                self._line.append(byte)
            return
        line, self._line = bytes(self._line), bytearray()
        self.port.write(self._answer(line))

    def _answer(self, line: bytes) -> bytes:
        try:
            text = line.decode("ascii")
        except UnicodeDecodeError:
            return BELL
        letter = text[:1]
        if letter in IDENTIFIER_DIGITS:
            return self._frame(text)
        if letter in ("O", "C", "L"):
            self.is_open = letter != "C"
            return OK
        if letter == "V":
            return b"V1013\r"
        if letter == "N":
            return b"NF1C0\r"
        return OK if letter in ("S", "s", "Z", "M", "m", "F", "") else BELL

    def _frame(self, text: str) -> bytes:
        if not self.is_open:
            return BELL
        letter, digits = text[0], IDENTIFIER_DIGITS[text[0]]
        try:
            identifier, length = int(text[1 : 1 + digits], 16), int(text[1 + digits])
            data = bytes.fromhex(text[2 + digits : 2 + digits + 2 * length])
        except (ValueError, IndexError):
            return BELL
        is_remote = letter in "rR"
        if length > 8 or (not is_remote and len(data) != length):
            return BELL
        message = can.Message(
            arbitration_id=identifier,
            is_extended_id=letter in "TR",
            is_remote_frame=is_remote,
            dlc=length,
            data=None if is_remote else data,
        )
        self._frames.append(message)
        return b"z\r" if letter in "tr" else b"Z\r"

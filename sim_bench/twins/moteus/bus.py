"""moteus controllers behind an fdcanusb, or directly on a UART: lines `can send ID DATA` and `rcv ID DATA`."""

from collections.abc import Sequence

from ...stand_in import StandIn
from ..port import BytePort
from ..serial_twin import SerialTwin
from .controller import BROADCAST, LONGEST_LINE, MoteusController, MoteusSettings
from .frame import LONGEST_FRAME

__all__ = ["MoteusController", "MoteusSettings", "MoteusTwin", "crc8"]

CRC_POLYNOMIAL = 0x97


class MoteusTwin(SerialTwin):
    """Controllers behind one fdcanusb.

    Args:
        port: The adapter's end of the line.
        stand_in: The joints.
        controllers: One for each joint.
    """

    drives: tuple[MoteusController, ...]

    def __init__(self, port: BytePort, stand_in: StandIn, controllers: Sequence[MoteusController]) -> None:
        super().__init__(port, stand_in, controllers)
        self._partial = b""

    def _feed(self, data: bytes) -> None:
        *lines, self._partial = (self._partial + data).split(b"\n")
        self._partial = self._partial[-LONGEST_LINE:]
        for line in lines:
            self._line(line.strip())

    def _line(self, line: bytes) -> None:
        """A UART without an adapter checks each line; whoever sends a checksum gets one back."""
        body, star, check = line.rpartition(b"*")
        checked = bool(star) and len(check) == 2
        if checked:
            if check.upper() != b"%02X" % crc8(body):
                self._reply(b"ERR checksum mismatch", checked)
                return
            line = body.strip()
        words = line.split()
        if words[:2] != [b"can", b"send"] or len(words) < 3:
            if words:
                self._reply(b"ERR unknown command", checked)
            return
        try:
            identifier, data = int(words[2], 16), bytes.fromhex(words[3].decode() if len(words) > 3 else "")
        except ValueError:
            self._reply(b"ERR malformed frame", checked)
            return
        self._reply(b"OK", checked)
        self._deliver(identifier, data[:LONGEST_FRAME], checked)

    def _deliver(self, identifier: int, data: bytes, checked: bool) -> None:
        destination, source = identifier & 0x7F, identifier >> 8 & 0x7F
        for controller in self.drives:
            if destination not in (controller.settings.identifier, BROADCAST):
                continue
            answer = controller.frame(data)
            if identifier & 0x8000 and answer:
                own = controller.settings.identifier << 8 | source
                self._reply(b"rcv %04X %s E0 B0 F0" % (own, answer.hex().upper().encode()), checked)

    def _reply(self, line: bytes, checked: bool) -> None:
        if checked:
            line += b" *%02X" % crc8(line + b" ")
        self._send(line + b"\n")

    def _power_cycle(self) -> None:
        self._partial = b""
        super()._power_cycle()


def crc8(data: bytes) -> int:
    """CRC-8 with polynomial 0x97, over all that stands before the asterisk."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ (CRC_POLYNOMIAL if crc & 0x80 else 0)) & 0xFF
    return crc

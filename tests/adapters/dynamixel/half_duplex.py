"""One wire for both directions: what overlaps on it is lost, on either side."""

from __future__ import annotations

from fricomp.adapters.bus_budget import serial_time
from fricomp.adapters.link import SerialLink
from fricomp.testing import VirtualClock

__all__ = ["HalfDuplexLine"]


class HalfDuplexLine:
    """Between the adapter and its bus, at the speed of the line.

    A servo answers as soon as it is asked; the host does not listen before it speaks, as no adapter cable does.

    Args:
        bus: To the servos, which answer at once.
        clock: Of all.
        baudrate: [baud].

    Attributes:
        n_collisions: Packets of the host that met an answer; both are gone.
    """

    def __init__(self, bus: SerialLink, clock: VirtualClock, baudrate: float = 1e6) -> None:
        self._bus, self._clock, self._baudrate = bus, clock, baudrate
        self._host_until_ns = 0
        self._answers: list[tuple[int, int, bytes]] = []
        self.n_collisions = 0

    def send(self, data: bytes) -> None:
        """Packets of the host, one right after the other."""
        at = max(self._clock.now_ns(), self._host_until_ns)
        for packet in _packets(data):
            end = at + self._duration_ns(packet)
            if any(start < end and until > at for start, until, _ in self._answers):
                self.n_collisions += 1
                self._answers = [each for each in self._answers if not (each[0] < end and each[1] > at)]
            else:
                self._bus.send(packet)
                self._take_answers(end)
            at = end
        self._host_until_ns = at

    def _take_answers(self, at: int) -> None:
        for answer in _packets(self._bus.receive()):
            end = at + self._duration_ns(answer)
            self._answers.append((at, end, answer))
            at = end

    def _duration_ns(self, data: bytes) -> int:
        return round(serial_time(len(data), self._baudrate) * 1e9)

    def receive(self) -> bytes:
        """Answers that have come whole."""
        now = self._clock.now_ns()
        whole = [each for each in self._answers if each[1] <= now]
        self._answers = [each for each in self._answers if each[1] > now]
        return b"".join(data for _, _, data in whole)

    def discard_output(self) -> None:
        """Nothing waits here."""

    def close(self) -> None:
        """Nothing is held here."""


def _packets(data: bytes) -> list[bytes]:
    packets, at = [], 0
    while at < len(data):
        end = at + 7 + int.from_bytes(data[at + 5 : at + 7], "little")
        packets.append(data[at:end])
        at = end
    return packets

"""A Damiao motor from its manual: registers, status, watchdog; not the adapter's codec turned around."""

from __future__ import annotations

import struct

from fricomp.adapters.link import CanFrame
from tests.adapters.peers.bus import Peer


def linear(code: int, limit: float, bits: int) -> float:
    return -limit + 2.0 * limit * code / ((1 << bits) - 1)


def coded(value: float, limit: float, bits: int) -> int:
    highest = (1 << bits) - 1
    return max(0, min(highest, int((value + limit) / (2.0 * limit) * highest + 0.5)))


class DamiaoPeer(Peer):
    """Registers 7 to 10 and 21 to 23; a watchdog in counts of 50 µs; faults latch until cleared."""

    def __init__(self, address: int, master: int, ranges: tuple[float, float, float]) -> None:
        super().__init__()
        self.made_of = (address, master, ranges)
        self.address, self.master = address, master
        self.registers: dict[int, bytes] = {9: struct.pack("<I", 0), 10: struct.pack("<I", 2)}
        for number, value in zip((21, 22, 23), ranges, strict=True):
            self.registers[number] = struct.pack("<f", value)
        self.latched = 0
        self.fed_ns = 0

    @property
    def ranges(self) -> tuple[float, float, float]:
        p, v, t = (struct.unpack("<f", self.registers[number])[0] for number in (21, 22, 23))
        return p, v, t

    def on_time(self, now_ns: int) -> None:
        if self.failed:
            self.trip(0xA)
        self.fed_ns = now_ns if self.held else self.fed_ns
        timeout = struct.unpack("<I", self.registers[9])[0] * 50_000
        if self.on and timeout and now_ns - self.fed_ns > timeout:
            self.trip(0xD)

    def trip(self, status: int) -> None:
        self.latched, self.on, self.torque = self.latched or status, False, 0.0

    def on_frame(self, frame: CanFrame) -> None:
        if frame.identifier == 0x7FF and frame.data[:2] == bytes((self.address & 0xFF, self.address >> 8)):
            self.on_service(frame.data)
        elif frame.identifier == self.address and len(frame.data) == 8:
            self.fed_ns = self.now_ns
            self.on_command(frame.data)
            self.answer_state()

    def on_service(self, data: bytes) -> None:
        operation, number = data[2], data[3]
        if operation == 0xCC:
            self.answer_state()
        elif operation in (0x33, 0x55) and number in self.registers:
            if operation == 0x55 and not (number == 10 and self.refuses_mode):
                self.registers[number] = data[4:8]
            self.outbox.append(CanFrame(self.master, data[:4] + self.registers[number]))

    def on_command(self, data: bytes) -> None:
        if data[:7] == b"\xff" * 7:
            if data[7] == 0xFC and not self.latched:
                self.on = True
            elif data[7] == 0xFD:
                self.on, self.torque = False, 0.0
            elif data[7] == 0xFB and not self.failed:
                self.latched = 0
        elif self.on and struct.unpack("<I", self.registers[10])[0] == 1:
            number = int.from_bytes(data, "big")
            kp, kd = number >> 24 & 0xFFF, number >> 12 & 0xFFF
            assert kp == kd == 0
            self.torque = linear(number & 0xFFF, self.ranges[2], 12)

    def answer_state(self) -> None:
        p, v, t = self.ranges
        status = self.latched or int(self.on)
        q, dq, tau = coded(self.position, p, 16), coded(self.velocity, v, 12), coded(self.torque, t, 12)
        packed = (q << 24 | dq << 12 | tau).to_bytes(5, "big")
        head = bytes((self.address & 0xF | status << 4,))
        self.outbox.append(CanFrame(self.master, head + packed + bytes((40, 45))))

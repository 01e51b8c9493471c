"""A CyberGear motor from its manual: 29-bit identifiers, parameters, watchdog; not the codec turned around."""

from __future__ import annotations

import struct
from math import pi

from fricomp.adapters.link import CanFrame
from tests.adapters.peers.bus import Peer

RUN_MODE, TIMEOUT = 0x7005, 0x200C


def linear(code: int, limit: float) -> float:
    return (2.0 * code / 65535.0 - 1.0) * limit


def coded(value: float, limit: float) -> int:
    return max(0, min(65535, int((value / limit + 1.0) / 2.0 * 65535.0 + 0.5)))


class CyberGearPeer(Peer):
    """Answers enabling, stopping and commands with its state, and parameters with their value."""

    def __init__(self, address: int) -> None:
        super().__init__()
        self.made_of = (address,)
        self.address = address
        self.parameters = {RUN_MODE: bytes((1, 0, 0, 0)), TIMEOUT: bytes(4)}
        self.latched = 0
        self.fed_ns = 0

    def on_time(self, now_ns: int) -> None:
        if self.failed:
            self.trip(0x02)
        if self.held:
            self.fed_ns = now_ns
            self.answer(0xFD)  # to every command of whoever holds it
        timeout = int.from_bytes(self.parameters[TIMEOUT], "little") * 50_000
        if self.on and timeout and now_ns - self.fed_ns > timeout:
            self.on, self.torque = False, 0.0

    def trip(self, fault: int) -> None:
        self.latched, self.on, self.torque = self.latched | fault, False, 0.0

    def on_frame(self, frame: CanFrame) -> None:
        if not frame.extended or frame.identifier & 0xFF != self.address:
            return
        kind, field = frame.identifier >> 24, frame.identifier >> 8 & 0xFFFF
        self.fed_ns = self.now_ns
        if kind == 1:
            self.on_command(field, frame.data)
        elif kind == 3 and not self.latched:
            self.on = True
        elif kind == 4:
            self.held = False
            self.on, self.torque = False, 0.0
            self.latched = 0 if frame.data[0] == 1 and not self.failed else self.latched
        elif kind in (17, 18):
            self.on_parameter(kind, field & 0xFF, frame.data)
            return
        self.answer(0xFD)

    def on_command(self, torque: int, data: bytes) -> None:
        _, _, kp, kd = struct.unpack(">HHHH", data)
        assert kp == kd == 0
        if self.on and self.parameters[RUN_MODE][0] == 0:
            self.torque = linear(torque, 12.0)

    def on_parameter(self, kind: int, host: int, data: bytes) -> None:
        number = int.from_bytes(data[:2], "little")
        if kind == 18:
            if not (number == RUN_MODE and self.refuses_mode):
                self.parameters[number] = data[4:8]
            self.answer(host)
        elif number in self.parameters:
            identifier = 17 << 24 | self.address << 8 | host
            self.outbox.append(CanFrame(identifier, data[:4] + self.parameters[number], True))

    def answer(self, host: int) -> None:
        mode = 2 if self.on else 0
        identifier = 2 << 24 | mode << 22 | self.latched << 16 | self.address << 8 | host
        q, dq, tau = coded(self.position, 4.0 * pi), coded(self.velocity, 30.0), coded(self.torque, 12.0)
        self.outbox.append(CanFrame(identifier, struct.pack(">HHHH", q, dq, tau, 312), True))

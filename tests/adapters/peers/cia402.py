"""A CiA 402 drive: objects, SDO and NMT by canopen's LocalNode, power state machine and PDOs from the specification."""

from __future__ import annotations

import struct
from typing import Any

import can
import canopen
from canopen.objectdictionary import ODRecord, ODVariable

from fricomp.adapters.link import CanFrame
from tests.adapters.peers.bus import Peer

U8, U16, U32, I8, I16, I32 = 0x05, 0x06, 0x07, 0x02, 0x03, 0x04

VARIABLES = {
    0x1000: (U32, 402),
    0x1017: (U16, 0),
    0x6007: (I16, 0),
    0x603F: (U16, 0),
    0x6040: (U16, 0),
    0x6041: (U16, 0x40),
    0x6060: (I8, 0),
    0x6061: (I8, 0),
    0x6064: (I32, 0),
    0x606C: (I32, 0),
    0x6071: (I16, 0),
    0x6072: (U16, 2000),
    0x6076: (U32, 5000),
    0x6077: (I16, 0),
    0x607A: (I32, 0),
    0x6080: (U32, 6000),
    0x60B0: (I32, 0),
    0x60B1: (I32, 0),
    0x60B2: (I16, 0),
    0x60FF: (I32, 0),
    0x6502: (U32, 0x380),
}
RECORDS = {
    0x1016: [(U32, 0)],
    0x608F: [(U32, 65536), (U32, 1)],
    0x6091: [(U32, 1), (U32, 1)],
    **{0x1400 + n: [(U32, 0x80000000), (U8, 255)] for n in range(4)},
    **{0x1800 + n: [(U32, 0x80000000), (U8, 255)] for n in range(4)},
    **{0x1600 + n: [(U32, 0)] * 8 for n in range(4)},
    **{0x1A00 + n: [(U32, 0)] * 8 for n in range(4)},
}
FORMATS = {8: "b", 16: "h", 32: "i"}


def object_dictionary() -> Any:
    make: Any = canopen.ObjectDictionary
    dictionary: Any = make()
    for index, (kind, default) in VARIABLES.items():
        dictionary.add_object(variable(index, 0, kind, default))
    for index, members in RECORDS.items():
        record: Any = ODRecord(f"object {index:04X}", index)
        record.add_member(variable(index, 0, U8, len(members)))
        for subindex, (kind, default) in enumerate(members, start=1):
            record.add_member(variable(index, subindex, kind, default))
        dictionary.add_object(record)
    return dictionary


def variable(index: int, subindex: int, kind: int, default: int) -> Any:
    made: Any = ODVariable(f"object {index:04X} {subindex}", index, subindex)
    made.data_type, made.default, made.access_type = kind, default, "rw"
    return made


class Task:
    """canopen's own heartbeat would need a thread; the peer sends its heartbeat itself."""

    def stop(self) -> None:
        """Nothing runs."""


class Wire:
    """What the local node sends."""

    def __init__(self, outbox: list[CanFrame]) -> None:
        self._outbox = outbox

    def send(self, message: can.Message, timeout: float | None = None) -> None:
        self._outbox.append(CanFrame(message.arbitration_id, bytes(message.data)))

    def send_periodic(self, *_: object, **__: object) -> Task:
        return Task()


class Cia402Peer(Peer):
    """The cyclic modes; in velocity and position mode a proportional loop of the drive's own adds to the offset.

    Attributes:
        gain: Of that loop, thousandths of rated torque for a count of error.
        stubborn: Objects that keep their value although a write was confirmed.
        leaves_operational: Whether a missed heartbeat of the master ends in pre-operational, as 1029 has it by default.
        forgives: Whether the consumer of heartbeats waits for the first one again after 1016 was written.
    """

    def __init__(self, node_id: int) -> None:
        super().__init__()
        self.made_of = (node_id,)
        self.node_id = node_id
        network: Any = canopen.Network()
        self.network = network
        self.network.bus = Wire(self.outbox)
        node: Any = canopen.LocalNode(node_id, object_dictionary())
        self.node = node
        self.set_data = node.set_data
        node.set_data = self.on_write
        self.network.add_node(self.node)
        self.state = "switch on disabled"
        self.controlword = 0
        self.pending: dict[int, bytes] = {}
        self.operational = False
        self.heard_ns: int | None = None
        self.beat_ns = 0
        self.gain = 0.1
        self.stubborn: set[int] = set()
        self.leaves_operational, self.forgives = False, True
        self.outbox.append(CanFrame(0x700 + node_id, b"\0"))

    def value(self, index: int, subindex: int = 0) -> int:
        entry = self.node.object_dictionary.get_variable(index, subindex)
        return int(entry.decode_raw(self.node.get_data(index, subindex)))

    def store(self, index: int, value: int) -> None:
        entry = self.node.object_dictionary.get_variable(index, 0)
        self.node.set_data(index, 0, entry.encode_raw(value))

    def on_write(self, index: int, subindex: int, data: bytes, check_writable: bool = False) -> None:
        if index in self.stubborn:
            return
        self.set_data(index, subindex, data, check_writable)
        if index == 0x1016 and self.forgives:
            self.heard_ns = None

    def lack(self, *indices: int) -> None:
        for index in indices:
            del self.node.object_dictionary[index]

    # -- frames -------------------------------------------------------------------------------------------

    def on_frame(self, frame: CanFrame) -> None:
        kind, node = frame.identifier & 0x780, frame.identifier & 0x7F
        if frame.identifier == 0:
            self.on_nmt(frame.data)
        elif frame.identifier == 0x80:
            self.on_sync()
        elif kind == 0x200 and node == self.node_id and self.operational:
            self.pending[0] = frame.data
        elif kind == 0x600 and node == self.node_id:
            self.refresh()
            before = self.value(0x6040)
            self.network.notify(frame.identifier, bytearray(frame.data), 0.0)
            if self.value(0x6040) != before:
                self.obey(self.value(0x6040))
        elif kind == 0x700 and node == self.value(0x1016, 1) >> 16:
            self.heard_ns = self.now_ns

    def on_nmt(self, data: bytes) -> None:
        command, node = data
        if node in (0, self.node_id):
            self.operational = {1: True, 0x80: False}.get(command, self.operational)

    def on_sync(self) -> None:
        if not self.operational:
            return
        if 0 in self.pending:
            self.apply(self.pending.pop(0))
        self.refresh()
        for number in range(2):
            if not self.value(0x1800 + number, 1) >> 31 and self.value(0x1800 + number, 2) == 1:
                self.outbox.append(CanFrame(0x180 + 0x100 * number + self.node_id, self.collect(0x1A00 + number)))

    def mapped(self, index: int) -> list[tuple[int, int]]:
        entries = [self.value(index, place) for place in range(1, self.value(index, 0) + 1)]
        return [(entry >> 16, entry & 0xFF) for entry in entries]

    def collect(self, index: int) -> bytes:
        return b"".join(self.node.get_data(entry, 0)[: bits // 8] for entry, bits in self.mapped(index))

    def apply(self, data: bytes) -> None:
        at = 0
        for index, bits in self.mapped(0x1600):
            self.node.set_data(index, 0, data[at : at + bits // 8])
            at += bits // 8
        self.obey(self.value(0x6040))

    # -- the power state machine ----------------------------------------------------------------------------

    def obey(self, word: int) -> None:
        rising_reset = word & 0x80 and not self.controlword & 0x80
        self.controlword = word
        if self.state == "fault":
            if rising_reset and not self.failed:
                self.state = "switch on disabled"
                self.store(0x603F, 0)
            return
        if not word & 0x02 or not word & 0x04:
            self.state = "switch on disabled"
        elif word & 0x07 == 0x06:
            self.state = "ready to switch on"
        elif word & 0x0F == 0x07 and self.state != "switch on disabled":
            self.state = "switched on"
        elif word & 0x0F == 0x0F and self.state in ("switched on", "operation enabled"):
            self.state = "operation enabled"
        self.on = self.state == "operation enabled"
        self.drive()

    def drive(self) -> None:
        """Torque is what target, offset and loop ask for, in thousandths of the rated torque, within 6072."""
        self.refresh()
        mode, most = self.value(0x6061), self.optional(0x6072, 2000)
        demand = float(self.optional(0x60B2))
        if mode == 8:
            demand += self.gain * (self.value(0x607A) + self.optional(0x60B0) - self.value(0x6064))
        elif mode == 9:
            demand += self.gain * (self.value(0x60FF) + self.optional(0x60B1) - self.value(0x606C))
        else:
            demand += self.value(0x6071)
        self.torque = max(-most, min(most, demand)) * 5.0 / 1000.0 if self.on and mode in (8, 9, 10) else 0.0

    def optional(self, index: int, default: int = 0) -> int:
        return self.value(index) if index in self.node.object_dictionary else default

    def refresh(self) -> None:
        words = {"switch on disabled": 0x40, "ready to switch on": 0x21, "switched on": 0x23, "fault": 0x08}
        self.store(0x6041, words.get(self.state, 0x27))
        self.store(0x6064, round(self.position / 6.283185307179586 * 65536))
        self.store(0x606C, round(self.velocity / 6.283185307179586 * 65536))
        self.store(0x6077, round(self.torque / 5.0 * 1000))

    def on_time(self, now_ns: int) -> None:
        if not self.refuses_mode:
            self.store(0x6061, self.value(0x6060))
        if self.failed and self.state != "fault":
            self.fault(0x2310)
        watched = 0 if self.held else self.value(0x1016, 1) & 0xFFFF
        if self.heard_ns is not None and watched and now_ns - self.heard_ns > watched * 1_000_000:
            self.heard_ns = None
            self.operational = self.operational and not self.leaves_operational
            if self.value(0x6007) == 1:
                self.fault(0x8130)
        period = self.value(0x1017) * 1_000_000
        if period and now_ns - self.beat_ns >= period:
            self.beat_ns = now_ns
            self.outbox.append(CanFrame(0x700 + self.node_id, b"\x05" if self.operational else b"\x7f"))

    def fault(self, code: int) -> None:
        self.state, self.on, self.torque = "fault", False, 0.0
        self.store(0x603F, code)
        self.outbox.append(CanFrame(0x80 + self.node_id, struct.pack("<HB5x", code, 1)))

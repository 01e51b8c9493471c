"""A CANopen node on any CAN port and in simulated time: object dictionary and SDO server from the canopen package,
NMT, heartbeat, SYNC and process data here, because that package's local node sends none by itself [cia301]."""

import struct
from abc import abstractmethod
from pathlib import Path
from typing import Any

import can
import canopen
from canopen.sdo.exceptions import SdoAbortedError

from ..can_twin import CanDevice
from .network import ProcessData, SimulatedNetwork

__all__ = ["EDS", "CanopenNode", "SdoAbortedError"]

EDS = Path(__file__).parent / "cia402_drive.eds"
INVALID, SYNC_ID, NMT_ID = 0x80000000, 0x080, 0x000
STOPPED, OPERATIONAL, PRE_OPERATIONAL = 4, 5, 127
RESET_NODE, RESET_COMMUNICATION = 0x81, 0x82
PDO_COUNT = 4
NOT_MAPPABLE, TOO_LONG, WRONG_STATE, UNKNOWN_COMMAND = 0x06040041, 0x06040042, 0x08000022, 0x05040001
INVALID_VALUE, KEPT_BITS = 0x06090030, 0x60000000


class CanopenNode(CanDevice):
    """The communication part of a drive.

    Args:
        node_id: 1 to 127.
    """

    def __init__(self, node_id: int) -> None:
        self.node_id = node_id
        self._now_ns = self._heartbeat_left_ns = 0
        self._errors: list[int] = []
        self._boot()

    # -- what a drive fills in ------------------------------------------------------------------------

    @abstractmethod
    def on_object_written(self, index: int, subindex: int, value: int) -> None:
        """A master wrote an object; raise `SdoAbortedError` to refuse."""

    @abstractmethod
    def object_value(self, index: int, subindex: int) -> int | None:
        """Present value of an object that the drive measures; None for what is merely stored."""

    @abstractmethod
    def on_connection_lost(self, code: int) -> None:
        """The master's heartbeat failed, or NMT stopped the node; `code` is the emergency code."""

    @abstractmethod
    def on_reset(self) -> None:
        """The node was reset."""

    # -- services -------------------------------------------------------------------------------------

    @property
    def is_operational(self) -> bool:
        """Whether process data flow."""
        return bool(self._node.nmt._state == OPERATIONAL)

    def stored(self, index: int, subindex: int = 0) -> int:
        """An object as it is stored."""
        return _decode(self._node.get_data(index, subindex), self._variable(index, subindex))

    def store(self, index: int, subindex: int, value: int) -> None:
        """Change an object from within the drive."""
        raw = self._variable(index, subindex).encode_raw(value)
        self._node.data_store.setdefault(index, {})[subindex] = raw

    def emergency(self, code: int, register: int) -> None:
        """Send an emergency message and keep it in 0x1003."""
        self._errors = [code, *self._errors][:8] if code else []
        self._network.send_message(0x80 + self.node_id, struct.pack("<HB5x", code, register))

    def receive(self, message: can.Message) -> None:
        """Everything on the bus; what is damaged is dropped."""
        if message.is_extended_id or message.is_remote_frame:
            return
        identifier, data = message.arbitration_id, bytes(message.data)
        if identifier == NMT_ID:
            self._nmt(data)
        elif identifier == SYNC_ID:
            self._sync()
        elif self._watch_heartbeat(identifier):
            return
        elif not self._take_process_data(identifier, data) and identifier == 0x600 + self.node_id:
            self._serve_object(data)

    def tick(self, now_ns: int) -> None:
        """Heartbeats to send and to miss, and process data on timers."""
        elapsed_ns, self._now_ns = now_ns - (self._now_ns or now_ns), now_ns
        self._network.periodic = [frame for frame in self._network.periodic if not frame.stopped]
        for frame in self._network.periodic:
            if now_ns >= frame.due_ns:
                frame.due_ns = now_ns + frame.period_ns
                self._network.send_message(frame.identifier, frame.data)
        if self._heartbeat_left_ns > 0:
            self._heartbeat_left_ns -= elapsed_ns
            if self._heartbeat_left_ns <= 0:
                self.emergency(0x8130, 0x11)
                self.on_connection_lost(0x8130)
                self._leave_operational()
        if self.is_operational:
            for pdo in self._transmit:
                if pdo.transmission >= 254 and pdo.event_period_ns and now_ns >= pdo.due_ns:
                    pdo.due_ns = now_ns + pdo.event_period_ns
                    self._send_process_data(pdo)

    def _leave_operational(self) -> None:
        """What 1029 says of an error in communication: pre-operational (0), no change (1) or stopped (2)."""
        behaviour = self.stored(0x1029, 1)
        if self.is_operational and behaviour in (0, 2):
            self._node.nmt._state = PRE_OPERATIONAL if behaviour == 0 else STOPPED

    def power_cycle(self) -> None:
        """Switch off and on: everything as delivered, a boot-up message, pre-operational."""
        self._boot()
        self.on_reset()
        self.announce()

    def announce(self) -> None:
        """Send the boot-up message and enter pre-operational."""
        self._node.nmt.state = "INITIALISING"
        self._node.nmt.state = "PRE-OPERATIONAL"

    # -- inside ---------------------------------------------------------------------------------------

    def _boot(self) -> None:
        self._network = SimulatedNetwork(lambda identifier, data: self.send(identifier, data, False))
        self._node = canopen.LocalNode(self.node_id, str(EDS))
        self._network[self.node_id] = self._node
        self._node.nmt._state = PRE_OPERATIONAL
        node: Any = self._node
        node.add_write_callback(self._written)
        node.add_read_callback(self._asked)
        self._errors, self._heartbeat_left_ns = [], 0
        self._receive: list[ProcessData] = []
        self._transmit: list[ProcessData] = []

    def _variable(self, index: int, subindex: int) -> Any:
        found = self._node.object_dictionary[index]
        return found if isinstance(found, canopen.objectdictionary.ODVariable) else found[subindex]

    def _asked(self, *, index: int, subindex: int, **_: object) -> int | None:
        if index == 0x1003:
            return len(self._errors) if subindex == 0 else (self._errors + [0] * 8)[subindex - 1]
        return self.object_value(index, subindex)

    def _written(self, *, index: int, subindex: int, od: Any, data: bytes) -> None:
        if od.data_type not in canopen.objectdictionary.datatypes.INTEGER_TYPES:
            return
        value = _decode(data, od)
        if 0x1400 <= index < 0x1C00:
            self._check_cob_id(index, subindex, value)
            self._check_mapping(index, subindex, value)
        self.on_object_written(index, subindex, value)
        if index == 0x1016:
            self._heartbeat_left_ns = 0

    def _check_cob_id(self, index: int, subindex: int, value: int) -> None:
        """Bits 29 and 30 stay as they are, and the identifier while the PDO is valid [cia301]."""
        if index & 0x200 or subindex != 1:
            return
        kept = self.stored(index, 1)
        if (value ^ kept) & KEPT_BITS:
            raise SdoAbortedError(INVALID_VALUE)
        if not (kept | value) & INVALID and (value ^ kept) & 0x7FF:
            raise SdoAbortedError(INVALID_VALUE)

    def _check_mapping(self, index: int, subindex: int, value: int) -> None:
        """A PDO is mapped while it is invalid, its count is zero, and with what exists."""
        is_mapping = bool(index & 0x200)
        if not is_mapping:
            return
        if self.is_operational:  # an enabled drive is
            raise SdoAbortedError(WRONG_STATE)
        if not self.stored(index - 0x200, 1) & INVALID:
            raise SdoAbortedError(WRONG_STATE)
        if subindex and self.stored(index, 0):
            raise SdoAbortedError(WRONG_STATE)
        entries = [value] if subindex else [self.stored(index, k) for k in range(1, value + 1)] if value <= 8 else []
        if not subindex and value > 8:
            raise SdoAbortedError(TOO_LONG)
        for entry in entries:
            self._check_mappable(entry)
        if not subindex and sum(entry & 0xFF for entry in entries) > 64:
            raise SdoAbortedError(TOO_LONG)

    def _check_mappable(self, entry: int) -> None:
        index, subindex, bits = entry >> 16, entry >> 8 & 0xFF, entry & 0xFF
        try:
            variable = self._variable(index, subindex)
        except KeyError:
            raise SdoAbortedError(NOT_MAPPABLE) from None
        if not variable.pdo_mappable or len(variable) != bits:
            raise SdoAbortedError(NOT_MAPPABLE)

    def _serve_object(self, data: bytes) -> None:
        """SDO; the package's server fails on a segment without a transfer, which is answered with an abort here."""
        if len(data) != 8 or self._node.nmt._state == STOPPED:
            return
        try:
            self._network.notify(0x600 + self.node_id, bytearray(data), 0.0)
        except (struct.error, TypeError, ValueError, LookupError, AttributeError):
            self._network.send_message(0x580 + self.node_id, struct.pack("<BHBL", 0x80, 0, 0, UNKNOWN_COMMAND))

    def _nmt(self, data: bytes) -> None:
        if len(data) != 2 or data[1] not in (0, self.node_id):
            return
        was_operational = self.is_operational
        if data[0] in (RESET_NODE, RESET_COMMUNICATION):
            self.power_cycle()
            return
        self._network.notify(NMT_ID, bytearray(data), 0.0)
        if self.is_operational and not was_operational:
            self._configure_process_data()
        elif was_operational and not self.is_operational:
            self.on_connection_lost(0)

    def _configure_process_data(self) -> None:
        self._receive = [pdo for k in range(PDO_COUNT) if (pdo := self._process_data(0x1400 + k)) is not None]
        self._transmit = [pdo for k in range(PDO_COUNT) if (pdo := self._process_data(0x1800 + k)) is not None]

    def _process_data(self, index: int) -> ProcessData | None:
        cob = self.stored(index, 1)
        count = self.stored(index + 0x200, 0)
        if cob & INVALID or not count:
            return None
        pdo = ProcessData(cob & 0x7FF, self.stored(index, 2))
        for k in range(1, count + 1):
            entry = self.stored(index + 0x200, k)
            pdo.entries.append((entry >> 16, entry >> 8 & 0xFF, entry & 0xFF))
        if index >= 0x1800:
            pdo.event_period_ns = self.stored(index, 5) * 1_000_000
        return pdo

    def _watch_heartbeat(self, identifier: int) -> bool:
        watched = self.stored(0x1016, 1)
        producer, period_ms = watched >> 16 & 0x7F, watched & 0xFFFF
        if not (period_ms and producer and identifier == 0x700 + producer):
            return False
        self._heartbeat_left_ns = period_ms * 1_000_000
        return True

    def _take_process_data(self, identifier: int, data: bytes) -> bool:
        for pdo in self._receive:
            if pdo.identifier == identifier:
                if self.is_operational and len(data) >= pdo.size:
                    pdo.pending = data
                    if pdo.transmission >= 254:
                        self._apply(pdo)
                return True
        return False

    def _sync(self) -> None:
        if not self.is_operational:
            return
        for pdo in self._receive:
            if pdo.transmission <= 240:
                self._apply(pdo)
        for pdo in self._transmit:
            if 1 <= pdo.transmission <= 240:
                pdo.syncs += 1
                if pdo.syncs >= pdo.transmission:
                    pdo.syncs = 0
                    self._send_process_data(pdo)

    def _apply(self, pdo: ProcessData) -> None:
        data, pdo.pending = pdo.pending, None
        if data is None:
            return
        at = 0
        for index, subindex, bits in pdo.entries:
            raw = data[at : at + bits // 8]
            at += bits // 8
            try:
                self._node.set_data(index, subindex, raw)
            except SdoAbortedError:
                continue  # refused, as by SDO, but a process data object has no answer

    def _send_process_data(self, pdo: ProcessData) -> None:
        data = b"".join(self._node.get_data(index, subindex) for index, subindex, _ in pdo.entries)
        self._network.send_message(pdo.identifier, data)


def _decode(data: bytes, variable: Any) -> int:
    value = variable.decode_raw(data)
    return value if isinstance(value, int) else 0

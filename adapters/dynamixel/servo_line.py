"""Servos that take turns with the host on one wire: single items of their tables, and who may speak when."""

from abc import abstractmethod
from collections.abc import Callable

from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import Clock

from ..bus_budget import serial_time
from ..holding import POLL_INTERVAL_NS
from ..link import SerialLink
from ..serial_adapter import SerialAdapter
from .configuration import DynamixelConfiguration
from .control_table import Item
from .packet import StatusPacket, read_packet, write_packet
from .packet_buffer import PacketBuffer

__all__ = ["ServoLine"]

ERROR_MASK = 0x7F
# How much later than reckoned a burst may leave the host, through the frames of USB: only where waiting is allowed.
HOST_DELAY_NS = 2_000_000


class ServoLine(SerialAdapter):
    """Half duplex: whatever is sent while servos answer destroys the answers, and is destroyed itself.

    Args:
        configuration: Port and servos.
        open_link: Makes the link; pyserial as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(
        self,
        configuration: DynamixelConfiguration,
        open_link: Callable[[], SerialLink] | None,
        clock: Clock | None,
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock)
        self._configuration = configuration
        self._servos = bytes(joint.id for joint in configuration.joints)
        self._joint_of = {servo: joint for joint, servo in enumerate(self._servos)}
        self._buffer = PacketBuffer()
        self._awaited: tuple[int, int] | None = None
        self._answer: StatusPacket | None = None
        self._silent_from_ns = 0
        self._requested_ns = 0

    @abstractmethod
    def _take_report(self, joint: int, packet: StatusPacket) -> bool:
        """Take what a servo reports; whether the packet was a report."""

    def _on_bytes(self, data: bytes) -> None:
        joint_of, last = self._joint_of, len(self._servos) - 1
        for packet in self._buffer.take(data):
            joint = joint_of.get(packet.identifier)
            if joint is None:
                continue
            if self._take_report(joint, packet):
                if joint == last:  # they answer in the order of the request
                    self._silent_from_ns = 0
            elif self._awaited is not None and self._is_awaited(packet, *self._awaited):
                self._awaited, self._answer = None, packet

    def _is_awaited(self, packet: StatusPacket, servo: int, n_bytes: int) -> bool:
        """A refusal comes without data; reports that were asked for before have another length."""
        refused = packet.error & ERROR_MASK and not packet.data
        return packet.identifier == servo and (len(packet.data) == n_bytes or bool(refused))

    # -- whose turn it is -------------------------------------------------------------------------------------

    def _is_taken(self) -> bool:
        """Whether an earlier burst, or the answers to it, may still be on the wire."""
        if self._silent_from_ns:
            self._pump()  # the last answer may lie here; taken later, it would seem to be the next request's
        return self.clock.now_ns() < self._silent_from_ns

    def _take_turn(self, n_bytes: int) -> None:
        """Note that so many bytes, answers included, are on the wire from now."""
        self._requested_ns = self.clock.now_ns()
        self._silent_from_ns = self._requested_ns + self._wire_ns(n_bytes)

    def _wire_ns(self, n_bytes: int) -> int:
        return round(serial_time(n_bytes, self._configuration.serial.baudrate) * 1e9)

    def _wait_for_silence(self) -> None:
        while self._silent_from_ns and self.clock.now_ns() < self._silent_from_ns + HOST_DELAY_NS:
            self.clock.sleep_until(self.clock.now_ns() + POLL_INTERVAL_NS)
            self._pump()

    # -- single items -----------------------------------------------------------------------------------------

    def _exchange(self, servo: int, packet: bytes, n_bytes: int, what: str) -> bytes:
        """Send an instruction and wait for the status with so many bytes.

        Raises:
            AdapterTimeout: None comes.
            AdapterError: It tells an error.
        """
        self._wait_for_silence()
        self._awaited, self._answer = (servo, n_bytes), None
        try:
            self._send(packet)
            timeout = self._response_timeout
            self._wait(lambda: self._answer is not None, timeout, f"servo {servo} did not answer to {what}")
        finally:
            self._awaited = None
        answer = self._answer or StatusPacket(servo, 0, b"")
        if answer.error & ERROR_MASK:
            raise AdapterError(f"servo {servo} refuses {what}: error {answer.error & ERROR_MASK}")
        return answer.data

    def _read_bytes(self, servo: int, item: Item) -> bytes:
        return self._exchange(servo, read_packet(servo, *item), item.size, f"reading address {item.address}")

    def _read_item(self, servo: int, item: Item) -> int:
        return int.from_bytes(self._read_bytes(servo, item), "little")

    def _write_item(self, servo: int, item: Item, value: int) -> None:
        packet = write_packet(servo, item.address, value.to_bytes(item.size, "little"))
        self._exchange(servo, packet, 0, f"writing {_shown(value, item)} to address {item.address}")

    def _write_confirmed(self, servo: int, item: Item, value: int) -> None:
        """Write and read back.

        Raises:
            AdapterConfigurationError: The servo keeps something else.
        """
        self._write_item(servo, item, value)
        found = self._read_item(servo, item)
        if found != value:
            raise AdapterConfigurationError(
                f"servo {servo} keeps {_shown(found, item)} at address {item.address} "
                f"where {_shown(value, item)} was written"
            )

    def _ensure_item(self, servo: int, item: Item, value: int) -> None:
        """Write only what differs: much of the table lies in an EEPROM, which wears."""
        if self._read_item(servo, item) != value:
            self._write_confirmed(servo, item, value)


def _shown(value: int, item: Item) -> str:
    return str(value) if item.size <= 4 else value.to_bytes(item.size, "little").hex()

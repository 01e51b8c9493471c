"""A whole adapter to begin yours with: drives of an invented kind on one serial port, in torque mode.

Replace what the manual of your drive says otherwise: the frames, and what is asked and confirmed. The conformance suite
runs on it in tests/adapters/test_skeleton.py, with drives in memory in place of the hardware.
"""

from __future__ import annotations

from binascii import crc_hqx
from collections.abc import Callable, Sequence
from dataclasses import replace
from enum import IntEnum
from struct import Struct

from fricomp.adapters import SerialAdapter
from fricomp.adapters.bus_budget import BusBudget, serial_time
from fricomp.adapters.configuration import JointConfiguration, SerialAdapterConfiguration
from fricomp.adapters.link import SerialLink
from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import Capabilities, Clock, CommandMode, JointCapabilities, JointCommand, Watchdog

# -- The protocol, to be replaced by that of your drive: every request is answered with the drive's state ------------

START = 0xA5
REQUEST = Struct("<BBBh")  # start, address, operation, value; then a CRC
ANSWER = Struct("<BBB?BHffh")  # start, address, operation, energised, fault, watchdog [ms], rad, rad/s, torque; CRC
ANSWER_SIZE, CYCLE_SIZE = ANSWER.size + 2, REQUEST.size + ANSWER.size + 4  # [byte]
LARGEST = 0x7FFF  # value of a request
TORQUE_STEP, LARGEST_TORQUE = 0.001, 0.001 * LARGEST  # [N·m]
SILENCE, HEAT, DROPPED_OUT = 0x01, 0x02, 0x100  # fault codes; the last is the adapter's own
FAULT_WORDS = {
    SILENCE: "no torque was commanded for as long as its watchdog waits",
    HEAT: "it is too hot",
    DROPPED_OUT: "it is not energised any more: its power failed, or somebody else has stopped it",
}


class Operation(IntEnum):
    """What a request asks for. ENABLE begins at zero torque; nothing but ENABLE and TORQUE feeds the watchdog."""

    STATE, WATCHDOG, ENABLE, TORQUE, STOP, CLEAR = range(6)


def add_crc(frame: bytes) -> bytes:
    """A frame as it goes over the line."""
    return frame + crc_hqx(frame, 0xFFFF).to_bytes(2, "little")


# -- The adapter: on the drive's side of the transmission, in SI ------------------------------------------------------


class PlainConfiguration(SerialAdapterConfiguration, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What the configuration file says. Keys of your own are fields here; `id` of a joint is its drive's address."""

    joints: tuple[JointConfiguration, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        for joint in self.joints:
            if not 1 <= joint.id <= 255:
                raise ValueError(f"joint {joint.name!r}: drives have addresses 1 to 255, got {joint.id}")


class PlainAdapter(SerialAdapter):
    """Drives on one serial port; `open_link` and `clock` are given by tests."""

    configuration_type = PlainConfiguration
    watchdog_faults = frozenset({SILENCE})

    def __init__(
        self,
        configuration: PlainConfiguration,
        open_link: Callable[[], SerialLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock)
        self._configuration, self._addresses = configuration, [joint.id for joint in configuration.joints]
        self._zeros = [0] * len(self._addresses)
        self._buffer = bytearray()
        self._answered: list[int | None] = [None] * len(self._addresses)  # the operation that each answered last
        self._energised = [False] * len(self._addresses)
        self._watchdogs = [0] * len(self._addresses)  # as read back [ms]

    def _on_bytes(self, data: bytes) -> None:
        self._buffer += data  # frames come in any pieces
        while len(self._buffer) >= ANSWER_SIZE:
            frame = bytes(self._buffer[: ANSWER.size])
            is_whole = frame[0] == START and self._buffer.startswith(add_crc(frame))
            if is_whole:
                self._take(frame)
            del self._buffer[: ANSWER_SIZE if is_whole else 1]  # inside a damaged one the next may begin

    def _take(self, frame: bytes) -> None:
        _, address, operation, energised, fault, watchdog, position, velocity, torque = ANSWER.unpack(frame)
        if address not in self._addresses:
            return
        joint, reported = self._addresses.index(address), self._reported
        reported.position[joint], reported.velocity[joint] = position, velocity
        reported.torque[joint] = torque * TORQUE_STEP
        reported.fault[joint] = fault or (DROPPED_OUT if self._running and not energised else 0)
        self._answered[joint], self._energised[joint], self._watchdogs[joint] = operation, energised, watchdog
        self._arrivals.mark(joint)

    def _open(self) -> Capabilities:
        self._connect()
        self._ask(Operation.STATE)  # and limits and scaling, where a drive tells them; nothing is written yet
        plain = JointCapabilities(
            "", torque_quantum=TORQUE_STEP, torque_limit=LARGEST_TORQUE, reports_temperature=False
        )
        joints = tuple(replace(plain, name=name) for name in self._names)
        cycle = serial_time(CYCLE_SIZE, self._configuration.serial.baudrate)
        return Capabilities(joints, ("torque",), BusBudget([cycle] * len(joints)).highest_rate, watchdog=None)

    def _find_energised(self) -> Sequence[bool | None]:
        self._ask(Operation.STATE)
        return self._energised

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._set_watchdog()  # and the mode, where there is more than one: written and read back

    def _set_watchdog(self) -> None:
        wanted = round(1e3 * self._configuration.watchdog)
        self._ask(Operation.WATCHDOG, wanted)
        if any(found != wanted for found in self._watchdogs):
            raise AdapterConfigurationError(f"watchdogs of {wanted} ms were read back as {self._watchdogs} ms")
        self._watchdog = Watchdog(1e-3 * self._watchdogs[0], confirmed=True)

    def _enable(self) -> None:
        self._set_watchdog()  # once more: a drive that was power cycled has forgotten it
        self._raise_on_fault()
        self._raise_if_stopped()
        self._ask(Operation.ENABLE)  # a drive that takes its time is waited for with `_wait`
        if not all(self._energised):
            raise AdapterError(f"drives {self._addresses} are energised: {self._energised}")
        self._running = True

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        # Rounded, never cut off. The gate lets through finite torques within limits, which are within LARGEST_TORQUE.
        self._request(Operation.TORQUE, [round(torque / TORQUE_STEP) for torque in command.torque])

    def _ask_state(self) -> None:
        self._request(Operation.STATE, self._zeros)

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        for _ in range(2):  # the first may join the rest of a frame that was cut by discarding it
            self._request(Operation.STOP, self._zeros)

    def _clear_faults(self) -> None:
        self._ask(Operation.CLEAR)  # a drive whose fault comes back only after a while is asked once more then
        self._raise_on_fault()

    def _describe_fault(self, joint: int, code: int) -> str:
        return FAULT_WORDS.get(code, "")

    def _request(self, operation: Operation, values: Sequence[int]) -> None:
        requests = zip(self._addresses, values, strict=True)
        self._send(b"".join(add_crc(REQUEST.pack(START, address, operation, value)) for address, value in requests))

    def _ask(self, operation: Operation, value: int = 0) -> None:
        """Send one request to all drives, and wait until each has answered it."""
        self._pump()  # what came before is no answer
        self._answered = [None] * len(self._addresses)
        self._request(operation, [value] * len(self._addresses))
        complaint = f"not all of drives {self._addresses} answered to {operation.name}"
        self._wait(lambda: all(one == operation for one in self._answered), self._response_timeout, complaint)

"""Dynamixel X servos as joints: goals for all in one packet, states of all in answer to one, every cycle."""

from __future__ import annotations

import struct
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Self

from fricomp.errors import AdapterConfigurationError, AdapterError, AdapterTimeout, AdapterValueError, DriveFault
from fricomp.joint import Capabilities, Clock, CommandMode, JointCapabilities, JointCommand, Watchdog

from ..bus_budget import BusBudget, serial_time
from ..configuration import convert
from ..driver import HOW_TO_CLEAR
from ..link import SerialLink
from ..serial_adapter import SerialAdapter
from .configuration import DynamixelConfiguration
from .control_table import (
    BUS_WATCHDOG,
    CONDITION,
    CURRENT_LIMIT,
    GOALS,
    HARDWARE_ERROR,
    MODEL_NUMBER,
    MODES,
    OPERATING_MODE,
    POSITION_COUNT,
    RETURN_DELAY,
    STATE,
    STATUS_RETURN_LEVEL,
    TORQUE_ENABLE,
    VELOCITY_COUNT,
    WARMTH,
    WATCHDOG_COUNT,
    Item,
    Model,
    models,
)
from .packet import (
    Instruction,
    StatusPacket,
    SyncWriter,
    encode_packet,
    read_packet,
    sync_read_packet,
    sync_write_packet,
    write_packet,
)
from .packet_buffer import PacketBuffer

__all__ = ["DynamixelAdapter"]

ALERT, ERROR_MASK = 0x80, 0x7F
FAULT_NOT_ENABLED = 0x100

CONDITION_PERIOD_NS = 50_000_000
REBOOT_TIME = 0.5  # until a servo answers again [s]
STATE_LAYOUT = struct.Struct("<hii")
LARGEST_GOAL = {2: 0x7FFF, 4: 0x7FFFFFFF}
# Of a status packet beside its data, and of the one that asks for it.
STATUS_BYTES = 11


class DynamixelAdapter(SerialAdapter):
    """Dynamixel X servos on one line.

    Args:
        configuration: Port and servos.
        open_link: Makes the link; pyserial as configured unless given.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(
        self,
        configuration: DynamixelConfiguration,
        open_link: Callable[[], SerialLink] | None = None,
        clock: Clock | None = None,
    ) -> None:
        super().__init__(configuration, configuration.joints, open_link, clock)
        self._configuration = configuration
        self._servos = bytes(joint.id for joint in configuration.joints)
        self._joint_of = {servo: joint for joint, servo in enumerate(self._servos)}
        self._torque_counts = [1.0] * len(self._servos)
        self._current_counts = [1.0] * len(self._servos)
        self._state_request = sync_read_packet(*STATE, self._servos)
        self._condition_request = b"".join(sync_read_packet(*item, self._servos) for item in (CONDITION, WARMTH))
        self._goal_counts: dict[CommandMode, Sequence[float]] = {
            "torque": self._torque_counts,
            "velocity": [VELOCITY_COUNT] * len(self._servos),
            "position": [POSITION_COUNT] * len(self._servos),
        }
        self._writers = {mode: SyncWriter(*goal, self._servos) for mode, goal in GOALS.items()}
        self._buffer = PacketBuffer()
        self._awaited: tuple[int, int] | None = None
        self._answer: StatusPacket | None = None
        self._hardware_errors = [0] * len(self._servos)
        self._watchdog: Watchdog | None = None
        self._mode_in_use: CommandMode = "torque"
        self._running = False
        self._condition_ns = 0

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make the adapter from what stands in the configuration file."""
        return cls(convert(configuration, DynamixelConfiguration))

    # -- receiving ------------------------------------------------------------------------------------------

    def _on_bytes(self, data: bytes) -> None:
        joint_of, n_state = self._joint_of, STATE.size
        for packet in self._buffer.take(data):
            identifier, error, content = packet
            joint = joint_of.get(identifier)
            if joint is None:
                continue
            if len(content) == n_state:
                self._take_state(joint, error, content)
            elif self._awaited is not None and self._is_awaited(packet, *self._awaited):
                self._awaited, self._answer = None, packet
            elif len(content) == CONDITION.size:
                self._take_condition(joint, packet)
            elif len(content) == WARMTH.size:
                self._reported.temperature[joint] = float(content[-1])

    def _is_awaited(self, packet: StatusPacket, servo: int, n_bytes: int) -> bool:
        """A refusal comes without data; states that were asked for before have another length."""
        refused = packet.error & ERROR_MASK and not packet.data
        return packet.identifier == servo and (len(packet.data) == n_bytes or bool(refused))

    def _take_state(self, joint: int, error: int, data: bytes) -> None:
        current, velocity, position = STATE_LAYOUT.unpack(data)
        reported = self._reported
        reported.torque[joint] = current * self._torque_counts[joint]
        reported.current[joint] = current * self._current_counts[joint]
        reported.velocity[joint] = velocity * VELOCITY_COUNT
        reported.position[joint] = position * POSITION_COUNT
        if error & ALERT:
            reported.fault[joint] = self._hardware_errors[joint] or ALERT
        self._arrivals.mark(joint)

    def _take_condition(self, joint: int, packet: StatusPacket) -> None:
        energised, self._hardware_errors[joint] = bool(packet.data[0]), packet.data[-1]
        missing = self._running and not energised
        self._reported.fault[joint] = self._hardware_errors[joint] or (FAULT_NOT_ENABLED if missing else 0)

    # -- single items -----------------------------------------------------------------------------------------

    def _exchange(self, servo: int, packet: bytes, n_bytes: int, what: str) -> bytes:
        """Send an instruction and wait for the status with so many bytes.

        Raises:
            AdapterTimeout: None comes.
            AdapterError: It tells an error.
        """
        self._awaited, self._answer = (servo, n_bytes), None
        try:
            self._send(packet)
            timeout = self._configuration.response_timeout
            self._wait(lambda: self._answer is not None, timeout, f"servo {servo} did not answer to {what}")
        finally:
            self._awaited = None
        answer = self._answer or StatusPacket(servo, 0, b"")
        if answer.error & ERROR_MASK:
            raise AdapterError(f"servo {servo} refuses {what}: error {answer.error & ERROR_MASK}")
        return answer.data

    def _read_item(self, servo: int, item: Item) -> int:
        what = f"reading address {item.address}"
        return int.from_bytes(self._exchange(servo, read_packet(servo, *item), item.size, what), "little")

    def _write_item(self, servo: int, item: Item, value: int) -> None:
        packet = write_packet(servo, item.address, value.to_bytes(item.size, "little"))
        self._exchange(servo, packet, 0, f"writing {value} to address {item.address}")

    def _ensure_item(self, servo: int, item: Item, value: int) -> None:
        """Write only what differs: much of the table lies in an EEPROM, which wears."""
        if self._read_item(servo, item) != value:
            self._write_item(servo, item, value)
            found = self._read_item(servo, item)
            if found != value:
                raise AdapterConfigurationError(
                    f"servo {servo} keeps {found} at address {item.address} where {value} was written"
                )

    # -- opening and configuring ------------------------------------------------------------------------------

    def _open(self) -> Capabilities:
        self._connect()
        joints = tuple(self._inspect(joint) for joint in range(len(self._servos)))
        rates = {mode: self._rate_in(mode) for mode in MODES}
        return Capabilities(joints, tuple(MODES), max(rates.values()), None, mode_rates=rates)

    def _inspect(self, joint: int) -> JointCapabilities:
        """What one servo can do.

        Raises:
            AdapterConfigurationError: It cannot control current.
        """
        servo, named = self._servos[joint], self._configuration.joints[joint]
        number = self._read_item(servo, MODEL_NUMBER)
        model = models().get(number, Model(f"model {number}"))
        if model.current_count is None:
            able = ", ".join(known.name for known in models().values() if known.current_count)
            raise AdapterConfigurationError(
                f"joint {named.name!r}: servo {servo} is a {model.name}, which cannot control current; able are {able}"
            )
        self._current_counts[joint] = model.current_count
        self._torque_counts[joint] = count = model.current_count * (named.torque_constant or 1.0)
        return JointCapabilities(
            named.name,
            torque_unit="N·m" if named.torque_constant else "A",
            position_quantum=POSITION_COUNT,
            velocity_quantum=VELOCITY_COUNT,
            velocity_command_quantum=VELOCITY_COUNT,
            torque_quantum=count,
            torque_limit=self._read_item(servo, CURRENT_LIMIT) * count,
        )

    def _rate_in(self, mode: CommandMode) -> float:
        """Highest rate in a mode: goals, the request for the states, and all states [Hz]."""
        baudrate, n_joints = self._configuration.serial.baudrate, len(self._servos)
        goals = self._writers[mode].encode([0] * n_joints)
        cycle = len(goals) + len(self._state_request) + n_joints * (STATE.size + STATUS_BYTES)
        slow = len(self._condition_request) + n_joints * (CONDITION.size + WARMTH.size + 2 * STATUS_BYTES)
        load = serial_time(slow, baudrate) / (CONDITION_PERIOD_NS * 1e-9)
        return BusBudget([serial_time(cycle, baudrate)], load).highest_rate

    def _configure(self, mode: CommandMode, period: float) -> None:
        self._mode_in_use, self._running = mode, False
        for servo in self._servos:
            self._ensure_item(servo, STATUS_RETURN_LEVEL, 2)
            self._ensure_item(servo, TORQUE_ENABLE, 0)
            self._ensure_item(servo, RETURN_DELAY, 0)
            self._ensure_item(servo, OPERATING_MODE, MODES[mode])
            self._arm_watchdog(servo)
        self._watchdog = Watchdog(self._watchdog_counts * WATCHDOG_COUNT, confirmed=True, fed_by_reads=True)

    @property
    def _watchdog_counts(self) -> int:
        return max(1, round(self._configuration.watchdog / WATCHDOG_COUNT))

    def _arm_watchdog(self, servo: int) -> None:
        self._write_item(servo, BUS_WATCHDOG, 0)  # also forgets that it has fired
        self._ensure_item(servo, BUS_WATCHDOG, self._watchdog_counts)

    def _confirmed_watchdog(self) -> Watchdog | None:
        return self._watchdog

    # -- moving -----------------------------------------------------------------------------------------------

    def _enable(self) -> None:
        for servo in self._servos:
            self._raise_if_stopped()
            error = self._read_item(servo, HARDWARE_ERROR)
            if error:
                raise DriveFault(f"servo {servo} reports hardware error {error:#x}: {HOW_TO_CLEAR}")
            self._ensure_item(servo, OPERATING_MODE, MODES[self._mode_in_use])
            self._arm_watchdog(servo)
        for servo in self._servos:
            self._raise_if_stopped()
            self._write_item(servo, TORQUE_ENABLE, 1)  # goals become zero, or the present position, by themselves
        for servo in self._servos:
            if self._read_item(servo, TORQUE_ENABLE) != 1:
                raise AdapterError(f"servo {servo} does not switch its torque on")
        self._running = True

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        counts = encode_goals(getattr(command, mode), self._goal_counts[mode], GOALS[mode].size)
        self._send(self._writers[mode].encode(counts) + self._state_request)
        self._ask_condition()

    def _ask_condition(self) -> None:
        """Ask for the condition of the servos when it is due."""
        now = self.clock.now_ns()
        if now - self._condition_ns >= CONDITION_PERIOD_NS:
            self._condition_ns = now
            self._send(self._condition_request)

    def _ask_state(self) -> None:
        self._send(self._state_request)
        self._ask_condition()

    # -- stopping -----------------------------------------------------------------------------------------------

    def _stop(self) -> None:
        self._running = False
        self._discard_output()
        idle = sync_write_packet(GOALS["torque"].address, dict.fromkeys(self._servos, bytes(2)))
        off = sync_write_packet(TORQUE_ENABLE.address, dict.fromkeys(self._servos, b"\0"))
        # Several times: the rest of a packet that was cut by discarding it would swallow the first.
        self._send((idle + off) * 3)

    def _clear_faults(self) -> None:
        for servo in self._servos:
            if self._read_item(servo, HARDWARE_ERROR):
                self._reboot(servo)
        self._reported.fault[:] = [0] * len(self._servos)
        self._hardware_errors = [self._read_item(servo, HARDWARE_ERROR) for servo in self._servos]
        if any(self._hardware_errors):
            raise DriveFault(f"the servos report hardware errors {self._hardware_errors} after a reboot")
        for servo in self._servos:
            self._ensure_item(servo, STATUS_RETURN_LEVEL, 2)

    def _reboot(self, servo: int) -> None:
        """The only way out of a hardware error; the servo stays de-energised."""
        self._exchange(servo, encode_packet(servo, Instruction.REBOOT), 0, "a reboot")
        deadline = self.clock.now_ns() + round(4e9 * REBOOT_TIME)
        while True:
            self.clock.sleep_until(self.clock.now_ns() + 50_000_000)
            try:
                self._read_item(servo, HARDWARE_ERROR)
                return
            except AdapterTimeout:
                if self.clock.now_ns() > deadline:
                    raise

    def _health(self) -> dict[str, float | str]:
        return {"damaged_packets": float(self._buffer.n_damaged)}


def encode_goals(values: Sequence[float], counts: Sequence[float], n_bytes: int) -> list[int]:
    """Values in the nearest whole numbers of their counts; what is beyond the bytes of a goal gets their edge.

    Raises:
        AdapterValueError: A value is not finite.
    """
    try:
        goals = [round(value / count) for value, count in zip(values, counts, strict=True)]
    except (ValueError, OverflowError) as error:
        raise AdapterValueError(f"{list(values)} cannot be sent to servos: {error}") from error
    bound = LARGEST_GOAL[n_bytes]
    if max(goals) > bound or min(goals) < -bound:
        return [min(max(goal, -bound), bound) for goal in goals]
    return goals

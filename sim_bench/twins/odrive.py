"""An ODrive node speaking CANSimple, firmware 0.6 or 0.5, from the vendor's protocol page.

Standard identifiers: node << 5 | command; little endian; turns, turns/s and N·m at the motor. The heartbeat of
firmware 0.5 carries error flags where 0.6 carries the result of the last procedure. The watchdog is off as
delivered; when on, 0.6 is fed by set-point messages, 0.5 by any message to the node.
"""

import struct
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from math import inf, isfinite, pi
from typing import Any

import can

from fricomp.errors import ParameterError

from ..stand_in.servo import ServoMode
from .axis import DriveAxis
from .can_twin import CanDevice

__all__ = ["ODriveNode", "ODriveSettings", "flat_endpoints"]

TURN = 2.0 * pi


class Command(IntEnum):
    """The lower five bits of an identifier."""

    GET_VERSION = 0x00
    HEARTBEAT = 0x01
    ESTOP = 0x02
    GET_ERROR = 0x03
    RX_SDO = 0x04
    TX_SDO = 0x05
    SET_AXIS_STATE = 0x07
    GET_ENCODER_ESTIMATES = 0x09
    SET_CONTROLLER_MODE = 0x0B
    SET_INPUT_POS = 0x0C
    SET_INPUT_VEL = 0x0D
    SET_INPUT_TORQUE = 0x0E
    SET_LIMITS = 0x0F
    GET_IQ = 0x14
    GET_TEMPERATURE = 0x15
    REBOOT = 0x16
    GET_BUS_VOLTAGE_CURRENT = 0x17
    CLEAR_ERRORS = 0x18
    GET_TORQUES = 0x1C


class AxisState(IntEnum):
    """Axis states that the twin has."""

    IDLE = 1
    CLOSED_LOOP_CONTROL = 8


CONTROL_MODES: dict[int, ServoMode] = {1: "torque", 2: "velocity", 3: "position"}
PASSTHROUGH = 1
INPUT_MODES = (0, 1, 2, 3, 5, 6)
WATCHDOG_EXPIRED = {5: 0x0000_0800, 6: 0x0100_0000}
ESTOP_REQUESTED = {5: 0x0000_4000, 6: 0x0000_1000}
SETPOINTS = (Command.SET_INPUT_POS, Command.SET_INPUT_VEL, Command.SET_INPUT_TORQUE)

# Endpoints of the twin's firmware: name and type; `flat_endpoints` writes them as the vendor does.
ENABLE_WATCHDOG, WATCHDOG_TIMEOUT, TORQUE_CONSTANT, VELOCITY_LIMIT, CONTROL_MODE, INPUT_MODE = range(1, 7)
TORQUE_SOFT_MIN, TORQUE_SOFT_MAX = 7, 8
ENDPOINTS: dict[int, tuple[str, str]] = {
    ENABLE_WATCHDOG: ("axis0.config.enable_watchdog", "bool"),
    WATCHDOG_TIMEOUT: ("axis0.config.watchdog_timeout", "float"),
    TORQUE_CONSTANT: ("axis0.config.motor.torque_constant", "float"),
    VELOCITY_LIMIT: ("axis0.controller.config.vel_limit", "float"),
    CONTROL_MODE: ("axis0.controller.config.control_mode", "uint8"),
    INPUT_MODE: ("axis0.controller.config.input_mode", "uint8"),
    TORQUE_SOFT_MIN: ("axis0.config.torque_soft_min", "float"),
    TORQUE_SOFT_MAX: ("axis0.config.torque_soft_max", "float"),
}
FORMATS = {"bool": "<?", "float": "<f", "uint8": "<B"}
SDO_READ, SDO_WRITE = 0, 1


@dataclass(frozen=True)
class ODriveSettings:
    """What is stored in a node.

    Attributes:
        node: 0 to 62.
        firmware: 6 for 0.6.x, 5 for 0.5.x.
        torque_constant: [N·m/A].
        torque_soft_limit: Bound of all torque, whatever the mode, both ways [N·m]; none as delivered.
        watchdog: Time without feeding after which the axis disarms [s]; 0 switches it off, as delivered.
        heartbeat_period: [s]; 0 for none.
        encoder_period: Period of the encoder estimates [s]; 0 for none.
        torques_period: Period of the torques [s]; 0 for none, as delivered.
        iq_period: Period of the currents [s]; 0 for none, as delivered.
    """

    node: int = 0
    firmware: int = 6
    torque_constant: float = 0.05
    torque_soft_limit: float = inf
    watchdog: float = 0.0
    heartbeat_period: float = 0.1
    encoder_period: float = 0.01
    torques_period: float = 0.0
    iq_period: float = 0.0

    def __post_init__(self) -> None:
        if not 0 <= self.node < 0x3F:
            raise ParameterError(f"node must be from 0 to 62, got {self.node!r}")
        if self.firmware not in (5, 6):
            raise ParameterError(f"firmware must be 5 (0.5.x) or 6 (0.6.x), got {self.firmware!r}")
        if not self.torque_soft_limit >= 0.0:
            raise ParameterError(f"torque_soft_limit must not be negative, got {self.torque_soft_limit!r}")

    @property
    def ranges(self) -> tuple[float, float]:
        """Largest torque [N·m] and velocity [rad/s] that the protocol's numbers carry, at the motor."""
        return inf, inf

    def adapter_entry(self) -> dict[str, Any]:
        """What the adapter's configuration says of such a drive."""
        return {"id": self.node, "torque_constant": self.torque_constant}


def flat_endpoints() -> dict[str, object]:
    """What the vendor's `flat_endpoints.json` for the twin's firmware would hold."""
    endpoints = {name: {"id": number, "type": kind} for number, (name, kind) in ENDPOINTS.items()}
    return {"fw_version": "0.6.9", "hw_version": "4.4.58", "endpoints": endpoints}


class ODriveNode(CanDevice):
    """One axis.

    Args:
        axis: The joint behind it.
        settings: What is stored in it.
    """

    def __init__(self, axis: DriveAxis, settings: ODriveSettings = ODriveSettings()) -> None:
        self.axis, self.settings = axis, settings
        self._firmware = settings.firmware
        self._readers: dict[int, Callable[[], bytes]] = {
            Command.GET_VERSION: self._version,
            Command.HEARTBEAT: self._heartbeat,
            Command.GET_ERROR: lambda: struct.pack("<II", self.errors, self.disarm_reason),
            Command.GET_ENCODER_ESTIMATES: lambda: struct.pack("<ff", axis.position / TURN, axis.velocity / TURN),
            Command.GET_IQ: lambda: struct.pack("<ff", self._setpoint / self._constant, axis.torque / self._constant),
            Command.GET_TEMPERATURE: lambda: struct.pack("<ff", axis.temperature, axis.temperature),
            Command.GET_BUS_VOLTAGE_CURRENT: lambda: struct.pack("<ff", 24.0, 0.1),
            Command.GET_TORQUES: lambda: struct.pack("<ff", self._setpoint, axis.torque),
        }
        if self._firmware == 5:
            for unknown in (Command.GET_VERSION, Command.GET_TORQUES):
                del self._readers[unknown]
        self.power_cycle()

    def power_cycle(self) -> None:
        """Idle, as stored."""
        s = self.settings
        self.state, self.errors, self.disarm_reason = AxisState.IDLE, 0, 0
        self.endpoints: dict[int, float] = {
            ENABLE_WATCHDOG: s.watchdog > 0.0,
            WATCHDOG_TIMEOUT: s.watchdog,
            TORQUE_CONSTANT: s.torque_constant,
            VELOCITY_LIMIT: self.axis.velocity_limit / TURN,
            CONTROL_MODE: 3,
            INPUT_MODE: PASSTHROUGH,
            TORQUE_SOFT_MIN: -s.torque_soft_limit,
            TORQUE_SOFT_MAX: s.torque_soft_limit,
        }
        self._setpoint = 0.0
        self._silence_ns = self._now_ns = 0
        self._due = {
            Command.HEARTBEAT: (s.heartbeat_period, 0),
            Command.GET_ENCODER_ESTIMATES: (s.encoder_period, 0),
            Command.GET_TORQUES: (s.torques_period if s.firmware == 6 else 0.0, 0),
            Command.GET_IQ: (s.iq_period, 0),
        }
        self.axis.disable()

    @property
    def control_mode(self) -> int:
        """1 torque, 2 velocity, 3 position."""
        return int(self.endpoints[CONTROL_MODE])

    @property
    def _constant(self) -> float:
        return self.endpoints[TORQUE_CONSTANT]

    def fail(self, error: int) -> None:
        """Disarm with an error, which stays until it is cleared."""
        self.errors |= error
        self.disarm_reason = error
        self.state = AxisState.IDLE
        self.axis.disable()

    def receive(self, message: can.Message) -> None:
        """Requests (remote frames) and commands to this node."""
        if message.is_extended_id or message.arbitration_id >> 5 != self.settings.node:
            return
        command = message.arbitration_id & 0x1F
        if self._firmware == 5 or command in SETPOINTS:
            self._silence_ns = 0
        if message.is_remote_frame or (command in self._readers and not message.data):
            self._report(command)
            return
        try:
            self._obey(command, bytes(message.data))
        except struct.error:
            return  # too short: the firmware drops it

    def tick(self, now_ns: int) -> None:
        """Watchdog and periodic reports."""
        if self._now_ns:
            self._silence_ns += now_ns - self._now_ns
        self._now_ns = now_ns
        is_armed = self.state == AxisState.CLOSED_LOOP_CONTROL
        if self.endpoints[ENABLE_WATCHDOG] and is_armed and self._silence_ns > self.endpoints[WATCHDOG_TIMEOUT] * 1e9:
            self.fail(WATCHDOG_EXPIRED[self._firmware])
        for command, (period, due) in self._due.items():
            if period > 0.0 and now_ns >= due:
                self._due[command] = (period, now_ns + round(period * 1e9))
                self._report(command)

    def _report(self, command: int) -> None:
        reader = self._readers.get(command)
        if reader is not None:
            self.send(self.settings.node << 5 | command, reader(), False)

    def _obey(self, command: int, data: bytes) -> None:
        if command in SETPOINTS:
            self._set_point(command, data)
        elif command == Command.SET_AXIS_STATE:
            self._set_state(*struct.unpack_from("<I", data))
        elif command == Command.SET_CONTROLLER_MODE:
            self._set_mode(*struct.unpack_from("<II", data))
        elif command == Command.SET_LIMITS:
            velocity, _current = struct.unpack_from("<ff", data)
            if velocity > 0.0:
                self.endpoints[VELOCITY_LIMIT] = velocity
        elif command == Command.ESTOP:
            self.fail(ESTOP_REQUESTED[self._firmware])
        elif command == Command.CLEAR_ERRORS:
            self.errors = 0
            self._silence_ns = 0
        elif command == Command.REBOOT:
            self.power_cycle()
        elif command == Command.RX_SDO and self._firmware == 6:
            self._sdo(data)

    def _set_state(self, state: int) -> None:
        if state == AxisState.IDLE:
            self.state = AxisState.IDLE
            self.axis.disable()
        elif state == AxisState.CLOSED_LOOP_CONTROL and not self.errors and self.control_mode in CONTROL_MODES:
            self.state = AxisState.CLOSED_LOOP_CONTROL
            self._setpoint, self._silence_ns = 0.0, 0
            self._energise()

    def _set_mode(self, control: int, inputs: int) -> None:
        if control not in CONTROL_MODES or inputs not in INPUT_MODES:
            return
        is_new = control != self.control_mode
        self.endpoints |= {CONTROL_MODE: control, INPUT_MODE: inputs}
        if is_new and self.state == AxisState.CLOSED_LOOP_CONTROL:
            self._energise()

    def _energise(self) -> None:
        self.axis.enable(CONTROL_MODES[self.control_mode])
        self._limit_torque()

    def _limit_torque(self) -> None:
        """The twin's axis has one bound for both ways: the nearer of the two that the drive keeps."""
        self.axis.limit_torque(max(min(self.endpoints[TORQUE_SOFT_MAX], -self.endpoints[TORQUE_SOFT_MIN]), 0.0))

    def _set_point(self, command: int, data: bytes) -> None:
        position = velocity = torque = 0.0
        if command == Command.SET_INPUT_POS:
            position, speed, feed_forward = struct.unpack_from("<fhh", data)
            velocity, torque = speed * 1e-3, feed_forward * 1e-3
        elif command == Command.SET_INPUT_VEL:
            velocity, torque = struct.unpack_from("<ff", data)
        else:
            (torque,) = struct.unpack_from("<f", data)
        if not (isfinite(position) and isfinite(velocity) and isfinite(torque)):
            return
        if self.endpoints[INPUT_MODE] != PASSTHROUGH and command != Command.SET_INPUT_TORQUE:
            torque = 0.0  # the feed-forward is taken in passthrough only
        self._setpoint = torque
        limit = self.endpoints[VELOCITY_LIMIT] * TURN
        self.axis.command(torque, max(-limit, min(limit, velocity * TURN)), position * TURN)

    def _sdo(self, data: bytes) -> None:
        operation, endpoint = struct.unpack_from("<BH", data)
        if endpoint not in ENDPOINTS:
            return
        layout = FORMATS[ENDPOINTS[endpoint][1]]
        if operation == SDO_WRITE:
            (value,) = struct.unpack_from(layout, data, 4)
            self._store(endpoint, value)
            self._silence_ns = 0
        elif operation == SDO_READ:
            head = struct.pack("<BHB", SDO_READ, endpoint, 0)
            value = self.endpoints[endpoint]
            raw = struct.pack(layout, value if layout == "<f" else int(value))
            self.send(self.settings.node << 5 | Command.TX_SDO, head + raw, False)

    def _store(self, endpoint: int, value: float) -> None:
        if endpoint == CONTROL_MODE:
            self._set_mode(int(value), int(self.endpoints[INPUT_MODE]))
        elif endpoint == INPUT_MODE:
            self._set_mode(self.control_mode, int(value))
        else:
            self.endpoints[endpoint] = value
        if endpoint in (TORQUE_SOFT_MIN, TORQUE_SOFT_MAX):
            self._limit_torque()

    def _version(self) -> bytes:
        # Protocol 2, hardware 4.4.58, firmware 0.6.9, released.
        return bytes([2, 4, 4, 58, 0, 6, 9, 0])

    def _heartbeat(self) -> bytes:
        if self._firmware == 6:
            return struct.pack("<IBBBx", self.errors, self.state, 0, 0)
        flag = 1 if self.errors else 0
        return struct.pack("<IBBBB", self.errors, self.state, flag, 0, 0)

"""CANSimple: identifier node << 5 | command, little endian, in turns and N·m at the motor [odrive2024].

Frames have the lengths of the vendor's DBC; the firmware would take shorter ones, too.
"""

import struct
from enum import IntEnum
from math import isfinite, nan, tau
from typing import NamedTuple

from fricomp.errors import AdapterValueError
from fricomp.joint import CommandMode

from ..link import CanFrame

__all__ = [
    "AxisState",
    "Command",
    "Heartbeat",
    "axis_state_frame",
    "controller_mode_frame",
    "decode_heartbeat",
    "decode_pair",
    "decode_temperature",
    "input_frame",
    "plain_frame",
    "request_frame",
]


class Command(IntEnum):
    """The five bits of an identifier that say what a frame is."""

    VERSION = 0x00
    HEARTBEAT = 0x01
    WRITE_ENDPOINT = 0x04
    ENDPOINT_ANSWER = 0x05
    AXIS_STATE = 0x07
    ENCODER_ESTIMATES = 0x09
    CONTROLLER_MODE = 0x0B
    INPUT_POSITION = 0x0C
    INPUT_VELOCITY = 0x0D
    INPUT_TORQUE = 0x0E
    CURRENT = 0x14
    TEMPERATURE = 0x15
    CLEAR_ERRORS = 0x18
    TORQUES = 0x1C


class AxisState(IntEnum):
    """States that the adapter asks for, and the one of an axis that has just started; all others energise the motor."""

    UNDEFINED = 0
    IDLE = 1
    CLOSED_LOOP = 8


CONTROL_MODES: dict[CommandMode, int] = {"torque": 1, "velocity": 2, "position": 3}
PASSTHROUGH = 1  # the only input mode in which torque feed-forward is applied

# Feed-forward beside a position is counted in thousandths, in 16 bits.
FEED_FORWARD_COUNT = 1e-3
INT16 = 0x7FFF
HIGHEST_FLOAT32 = 3.4028234e38


class Heartbeat(NamedTuple):
    """What every node says about itself.

    Attributes:
        error: Error bits of the axis.
        state: State of the axis.
        flags: On firmware 0.5 whether motor, encoder or controller have errors of their own; 0 on 0.6.
    """

    error: int
    state: int
    flags: int


def _frame(node: int, command: Command, data: bytes, remote: bool = False) -> CanFrame:
    return CanFrame(node << 5 | command, data, False, remote)


def request_frame(node: int, command: Command) -> CanFrame:
    """Ask for a report, by a remote frame."""
    return _frame(node, command, b"", remote=True)


def plain_frame(node: int, command: Command, data: bytes = b"") -> CanFrame:
    """A command with its bytes."""
    return _frame(node, command, data)


def axis_state_frame(node: int, state: AxisState) -> CanFrame:
    """Ask for a state of the axis."""
    return _frame(node, Command.AXIS_STATE, struct.pack("<I4x", state))


def controller_mode_frame(node: int, mode: CommandMode) -> CanFrame:
    """Ask for a control mode, its input passed through."""
    return _frame(node, Command.CONTROLLER_MODE, struct.pack("<II", CONTROL_MODES[mode], PASSTHROUGH))


def input_frame(node: int, mode: CommandMode, torque: float, velocity: float, position: float) -> CanFrame:
    """A set-point: torque [N·m], or velocity [rad/s] or position [rad] with torque as feed-forward.

    Raises:
        AdapterValueError: A value is not finite, or beyond a 32 bit float.
    """
    if not (abs(torque) < HIGHEST_FLOAT32 and abs(velocity) < HIGHEST_FLOAT32 and abs(position) < HIGHEST_FLOAT32):
        raise AdapterValueError(f"torque {torque}, velocity {velocity}, position {position} cannot be sent to a drive")
    if mode == "torque":
        return _frame(node, Command.INPUT_TORQUE, struct.pack("<f4x", torque))
    if mode == "velocity":
        return _frame(node, Command.INPUT_VELOCITY, struct.pack("<ff", velocity / tau, torque))
    forward = round(min(max(torque / FEED_FORWARD_COUNT, -INT16), INT16))
    return _frame(node, Command.INPUT_POSITION, struct.pack("<fhh", position / tau, 0, forward))


def decode_heartbeat(data: bytes, firmware_minor: int) -> Heartbeat | None:
    """A heartbeat of firmware 0.5 or 0.6; None if it is cut short."""
    if len(data) < 8:
        return None
    error, state, motor, encoder, controller = struct.unpack("<IBBBB", data)
    return Heartbeat(error, state, (motor & 1 | encoder & 1 | controller & 1) if firmware_minor == 5 else 0)


def decode_pair(data: bytes) -> tuple[float, float] | None:
    """The two floats of most reports; None if they are cut short or not finite."""
    if len(data) != 8:
        return None
    first, second = struct.unpack("<ff", data)
    return (first, second) if isfinite(first) and isfinite(second) else None


def decode_temperature(data: bytes) -> float | None:
    """The hotter of inverter and motor [°C], NaN if neither is measured; None if the report is cut short.

    A motor without a thermistor is no reason to lose the inverter's temperature.
    """
    if len(data) != 8:
        return None
    known = [value for value in struct.unpack("<ff", data) if isfinite(value)]
    return max(known) if known else nan

"""The register protocol of moteus: subframes that write, read and answer [mjbots2024].

A position command is mode 10 with its references in registers 0x20 to 0x27; NaN stands for "none" and is a command
like any other, so that values of ours are checked to be finite and the one NaN here is a constant.
"""

import struct
from math import nan, tau
from typing import NamedTuple

from fricomp.errors import AdapterValueError
from fricomp.joint import CommandMode

__all__ = ["QUERY", "STOP", "MoteusState", "decode_state", "decode_text", "encode_command", "encode_text", "pad"]

WRITE_INT8, WRITE_FLOAT = 0x00, 0x0C
READ_INT8, READ_FLOAT = 0x10, 0x1C
ANSWER_TO_TEXT, SEND_TEXT, POLL_TEXT, NO_OPERATION = 0x41, 0x40, 0x42, 0x50
TEXT_CHANNEL = 1
LONGEST_TEXT = 48

MODE_STOPPED, MODE_FAULT, MODE_POSITION, MODE_TIMEOUT = 0, 1, 10, 11
REGISTER_MODE, REGISTER_POSITION, REGISTER_VOLTAGE, REGISTER_TARGET, REGISTER_TIMEOUT = 0x00, 0x01, 0x0D, 0x20, 0x27

STATE_REGISTERS = {0x00, 0x01, 0x02, 0x03, 0x0D, 0x0E, 0x0F}

# Mode, then position, velocity, torque, then voltage, temperature, fault.
QUERY = bytes((READ_INT8 | 1, REGISTER_MODE, READ_FLOAT | 3, REGISTER_POSITION, READ_INT8 | 3, REGISTER_VOLTAGE))
STOP = bytes((WRITE_INT8 | 1, REGISTER_MODE, MODE_STOPPED)) + QUERY
POSITION_HEAD = bytes((WRITE_INT8 | 1, REGISTER_MODE, MODE_POSITION, WRITE_FLOAT, 6, REGISTER_TARGET))
TIMEOUT_HEAD = bytes((WRITE_FLOAT | 1, REGISTER_TIMEOUT))

REFERENCES = struct.Struct("<3f")
FD_LENGTHS = (*range(9), 12, 16, 20, 24, 32, 48, 64)
HIGHEST_FLOAT32 = 3.4028234e38
SIZES = {0: 1, 1: 2, 2: 4, 3: 4}
FORMATS = {0: "<b", 1: "<h", 2: "<i", 3: "<f"}


class MoteusState(NamedTuple):
    """What a query answers.

    Attributes:
        mode: 0 stopped, 1 fault, 10 position, 11 position timeout.
        position: [rad].
        velocity: [rad/s].
        torque: [N·m].
        temperature: [°C].
        fault: Fault code; 0 for none.
    """

    mode: int
    position: float
    velocity: float
    torque: float
    temperature: float
    fault: int


def pad(data: bytes) -> bytes:
    """Fill up with no-operations to a length that a CAN-FD frame can have."""
    length = next(length for length in FD_LENGTHS if length >= len(data))
    return data.ljust(length, bytes((NO_OPERATION,)))


def encode_command(mode: CommandMode, torque: float, reference: float, highest_torque: float, timeout: float) -> bytes:
    """A command that lapses by itself.

    Args:
        mode: Torque alone switches the position loop's gains off; else it is its feed-forward.
        torque: [N·m].
        reference: Velocity [rad/s] or position [rad]; of no effect in torque mode.
        highest_torque: Bound on all that the loop commands [N·m].
        timeout: Time after which the command lapses [s].

    Raises:
        AdapterValueError: A value is not finite, or beyond a 32 bit float.
    """
    gain = 0.0 if mode == "torque" else 1.0
    values = encode_references(mode, torque, reference, highest_torque)
    bounds = struct.pack("<3f", gain, gain, highest_torque)
    return POSITION_HEAD + values + bounds + TIMEOUT_HEAD + struct.pack("<f", timeout) + QUERY


def encode_references(mode: CommandMode, torque: float, reference: float, highest_torque: float) -> bytes:
    """Position, velocity and torque of a command; see `encode_command`.

    Raises:
        AdapterValueError: A value is not finite, or beyond a 32 bit float.
    """
    if not (abs(torque) < HIGHEST_FLOAT32 and abs(reference) < HIGHEST_FLOAT32):  # false for NaN, too
        raise AdapterValueError(f"torque {torque}, reference {reference} cannot be sent to a drive")
    if torque > highest_torque or torque < -highest_torque:
        torque = highest_torque if torque > 0.0 else -highest_torque
    position = reference / tau if mode == "position" else nan
    velocity = reference / tau if mode == "velocity" else 0.0
    return REFERENCES.pack(position, velocity, torque)


def encode_text(text: bytes) -> bytes:
    """A line for the diagnostic channel, or a request for what it has to say if empty."""
    if text:
        return bytes((SEND_TEXT, TEXT_CHANNEL, len(text))) + text
    return bytes((POLL_TEXT, TEXT_CHANNEL, LONGEST_TEXT))


# The two shapes that the answer to QUERY has: registers one by one, or grouped as they were asked for.
SINGLE = struct.Struct("<2sb2sf2sf2sf2sb2sb2sb")
SINGLE_HEADS = (b"\x21\x00", b"\x2d\x01", b"\x2d\x02", b"\x2d\x03", b"\x21\x0d", b"\x21\x0e", b"\x21\x0f")
GROUPED = struct.Struct("<2sb2s3f2s3b")
GROUPED_HEADS = (b"\x21\x00", b"\x2f\x01", b"\x23\x0d")


def decode_state(data: bytes) -> MoteusState | None:
    """The answer to a query; None if it is something else, or damaged."""
    if len(data) >= SINGLE.size:
        fields = SINGLE.unpack_from(data)
        if fields[0::2] == SINGLE_HEADS:
            _, mode, _, position, _, velocity, _, torque, _, _, _, temperature, _, fault = fields
            return MoteusState(mode, position * tau, velocity * tau, torque, temperature, fault)
    if len(data) >= GROUPED.size:
        fields = GROUPED.unpack_from(data)
        if (fields[0], fields[2], fields[6]) == GROUPED_HEADS:
            _, mode, _, position, velocity, torque, _, _, temperature, fault = fields
            return MoteusState(mode, position * tau, velocity * tau, torque, temperature, fault)
    found = _decode_registers(data)
    if not found.keys() >= STATE_REGISTERS:
        return None
    mode, position, velocity, torque, _, temperature, fault = (found[register] for register in sorted(STATE_REGISTERS))
    return MoteusState(int(mode), position * tau, velocity * tau, torque, temperature, int(fault))


def decode_text(data: bytes) -> bytes | None:
    """A piece of text from the diagnostic channel; None if it is something else, or damaged."""
    if data[:2] != bytes((ANSWER_TO_TEXT, TEXT_CHANNEL)) or len(data) < 3 or len(data) < 3 + data[2]:
        return None
    return data[3 : 3 + data[2]]


def _decode_registers(data: bytes) -> dict[int, float]:
    """Values of all registers answered in a frame; an unknown or cut subframe ends it."""
    values: dict[int, float] = {}
    at = 0
    while at < len(data):
        head = data[at]
        if head == NO_OPERATION:
            at += 1
            continue
        if head & 0xF0 != 0x20 or at + 1 >= len(data):
            break
        kind, count = head >> 2 & 0x3, head & 0x3
        at += 1
        if count == 0:
            count = data[at]
            at += 1
        if at >= len(data) or at + 1 + count * SIZES[kind] > len(data):
            break
        register = data[at]
        at += 1
        for offset in range(count):
            values[register + offset] = float(struct.unpack_from(FORMATS[kind], data, at)[0])
            at += SIZES[kind]
    return values

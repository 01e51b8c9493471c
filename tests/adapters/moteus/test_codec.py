"""Subframes of moteus, byte by byte as the vendor's reference lays them out [mjbots2024]."""

import struct
from math import inf, nan, tau

import pytest

from fricomp.adapters.moteus.codec import (
    MODE_FAULT,
    MODE_POSITION,
    MODE_STOPPED,
    MODE_TIMEOUT,
    QUERY,
    STOP,
    MoteusState,
    decode_state,
    decode_text,
    encode_command,
    encode_text,
    pad,
)
from fricomp.errors import AdapterValueError
from fricomp.joint import CommandMode

STATE = MoteusState(10, 0.25 * tau, -0.5 * tau, 1.5, 41, 33)


def floats(*values: float) -> bytes:
    return struct.pack(f"<{len(values)}f", *values)


def test_a_query_asks_for_mode_motion_and_health() -> None:
    assert bytes.fromhex("1100 1f01 130d") == QUERY
    assert bytes.fromhex("010000") + QUERY == STOP


@pytest.mark.parametrize(
    ("mode", "position", "velocity", "gain"),
    [("torque", nan, 0.0, 0.0), ("velocity", nan, 0.5, 1.0), ("position", 0.5, 0.0, 1.0)],
)
def test_a_command_is_six_references_a_timeout_and_a_query(
    mode: CommandMode, position: float, velocity: float, gain: float
) -> None:
    expected = bytes.fromhex("01000a 0c0620") + floats(position, velocity, -0.25, gain, gain, 2.0)
    expected += bytes.fromhex("0d27") + floats(0.1) + QUERY
    assert encode_command(mode, -0.25, 0.5 * tau, 2.0, 0.1) == expected


@pytest.mark.parametrize(("torque", "sent"), [(3.0, 2.0), (-3.0, -2.0), (2.0, 2.0), (-2.0, -2.0), (1.5, 1.5)])
def test_torque_is_within_what_the_loop_may_command(torque: float, sent: float) -> None:
    assert encode_command("torque", torque, 0.0, 2.0, 0.1)[14:18] == floats(sent)
    assert encode_command("torque", 0.25 * torque, 0.0, 0.5, 0.1)[14:18] == floats(0.25 * sent)


@pytest.mark.parametrize("bad", [nan, inf, -inf, 3.5e38])
def test_no_value_that_is_no_float_is_sent(bad: float) -> None:
    for torque, reference in ((bad, 0.0), (0.0, bad)):
        with pytest.raises(AdapterValueError, match="cannot be sent"):
            encode_command("velocity", torque, reference, 2.0, 0.1)


def test_modes_have_the_numbers_of_the_vendor_s_package() -> None:
    mode = pytest.importorskip("moteus").Mode
    ours = (MODE_STOPPED, MODE_FAULT, MODE_POSITION, MODE_TIMEOUT)
    assert ours == (mode.STOPPED, mode.FAULT, mode.POSITION, mode.TIMEOUT)


def test_a_frame_is_filled_up_to_a_length_of_can_fd() -> None:
    lengths = [len(pad(bytes(n))) for n in (0, 1, 8, 9, 12, 13, 17, 21, 25, 33, 49, 64)]
    assert lengths == [0, 1, 8, 12, 12, 16, 20, 24, 32, 48, 64, 64]
    assert pad(b"\x01" * 9) == b"\x01" * 9 + b"\x50" * 3


def answers() -> list[bytes]:
    """The same state in the shapes that a controller may choose: one by one, grouped, and in other widths."""
    motion = floats(0.25, -0.5, 1.5)
    single = bytes.fromhex("21000a") + b"".join(
        bytes((0x2D, register)) + motion[4 * k : 4 * k + 4] for k, register in enumerate((1, 2, 3))
    )
    single += bytes.fromhex("210d30 210e29 210f21")
    grouped = bytes.fromhex("21000a 2f01") + motion + bytes.fromhex("230d 302921")
    wide = (
        bytes.fromhex("25000a00") + bytes.fromhex("2c0301") + motion + bytes.fromhex("29 0d 30000000 26 0e 2900 2100")
    )
    other_order = bytes.fromhex("230d 302921 2f01") + motion + bytes.fromhex("50 50 21000a")
    return [single, grouped, wide, other_order]


@pytest.mark.parametrize("answer", answers())
def test_an_answer_says_the_same_in_every_shape(answer: bytes) -> None:
    assert decode_state(answer) == STATE
    assert decode_state(answer + b"\x50\x50") == STATE
    assert all(decode_state(answer[:cut]) is None for cut in range(len(answer)))


def test_an_unknown_subframe_ends_an_answer() -> None:
    grouped = answers()[1]
    assert decode_state(b"\x31\x00" + grouped) is None
    assert decode_state(grouped + b"\x31\x00") == STATE
    assert decode_state(grouped + b"\x20") == STATE, "a count that is cut off"


def test_negative_bytes_are_negative_numbers() -> None:
    cold = decode_state(bytes.fromhex("21000a 2f01") + floats(0.0, 0.0, 0.0) + bytes.fromhex("230d 30f600"))
    assert cold is not None
    assert cold.temperature == -10


def test_text_goes_through_the_diagnostic_channel() -> None:
    assert encode_text(b"tel") == bytes.fromhex("40 01 03") + b"tel"
    assert encode_text(b"") == bytes.fromhex("42 01 30")
    assert decode_text(bytes.fromhex("41 01 03") + b"OK\n\x50\x50") == b"OK\n"
    assert decode_text(bytes.fromhex("41 01 00")) == b""
    for damaged in (b"", b"\x41\x01", b"\x41\x02\x00", b"\x40\x01\x00", b"\x41\x01\x03OK"):
        assert decode_text(damaged) is None

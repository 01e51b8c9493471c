"""Lines of slcan, against the examples of its manual [lawicel2013] and at the edges of what a frame can be."""

import pytest

from fricomp.adapters.link import CanFrame
from fricomp.adapters.slcan.codec import decode_line, encode_frame

LINES = [
    (b"t10021133", CanFrame(0x100, b"\x11\x33")),
    (b"T0000010021133", CanFrame(0x100, b"\x11\x33", extended=True)),
    (b"t7FF0", CanFrame(0x7FF)),
    (b"T1FFFFFFF80011223344556677", CanFrame(0x1FFFFFFF, bytes.fromhex("0011223344556677"), extended=True)),
    (b"r1000", CanFrame(0x100, remote=True)),
    (b"R000001000", CanFrame(0x100, extended=True, remote=True)),
]


@pytest.mark.parametrize(("line", "frame"), LINES)
def test_a_line_says_what_its_frame_is(line: bytes, frame: CanFrame) -> None:
    assert encode_frame(frame) == line + b"\r"
    assert decode_line(line) == frame
    assert decode_line(line[:1] + line[1:].lower()) == frame, "digits may be small letters"


@pytest.mark.parametrize("line", [line for line, _ in LINES])
def test_four_digits_of_time_stamp_may_follow_and_nothing_else(line: bytes) -> None:
    assert decode_line(line + b"1A2B") == decode_line(line)
    assert all(decode_line(line + digits) is None for digits in (b"1", b"1A2", b"1A2B3", b"1A2B1A2B"))
    assert decode_line(line[:-1]) is None


def test_a_remote_request_has_a_length_and_no_data() -> None:
    assert decode_line(b"r1008") == CanFrame(0x100, remote=True)
    assert decode_line(b"r1002AABB") == CanFrame(0x100, remote=True), "two bytes look like a time stamp"
    assert decode_line(b"r1001AA") is None


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"t",
        b"x10021133",
        b"t8000",
        b"T200000000",
        b"t1009112233445566778899",
        b"t100A",
        b"t100-2AA",
        b"t-020",
        b"t+020",
        b"t 020",
        b"t10021_3",
    ],
)
def test_what_is_no_frame_is_none(line: bytes) -> None:
    assert decode_line(line) is None

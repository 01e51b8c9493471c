"""The chunked slcan bus: its text, over a pseudo-terminal, against python-can's own, and under garbage."""

from __future__ import annotations

import os
import random
import tty
from collections.abc import Iterator

import can
import pytest

from fricomp.adapters.can_bus import open_can_link
from fricomp.adapters.configuration import CanBusConfiguration
from fricomp.adapters.link import CanFrame
from fricomp.adapters.slcan import ChunkedSlcanBus
from fricomp.adapters.slcan.codec import decode_line, encode_frame
from fricomp.errors import AdapterConnectionError


class Terminal:
    """Both ends of a pseudo-terminal."""

    def __init__(self) -> None:
        self.device, self.user = os.openpty()
        tty.setraw(self.user)
        self.path = os.ttyname(self.user)

    def read(self) -> bytes:
        return os.read(self.device, 65536)

    def write(self, data: bytes) -> None:
        os.write(self.device, data)

    def close(self) -> None:
        os.close(self.device)
        os.close(self.user)


@pytest.fixture
def terminal() -> Iterator[Terminal]:
    made = Terminal()
    yield made
    made.close()


def random_frame(rng: random.Random) -> CanFrame:
    extended = rng.random() < 0.5
    identifier = rng.randrange(1 << (29 if extended else 11))
    return CanFrame(identifier, rng.randbytes(rng.randrange(9)), extended, False)


def test_text_and_frame_are_the_same_thing() -> None:
    rng = random.Random(3)
    for _ in range(500):
        frame = random_frame(rng)
        line = encode_frame(frame)
        assert line.endswith(b"\r")
        assert decode_line(line[:-1]) == frame


@pytest.mark.parametrize(
    ("frame", "line"),
    [
        (CanFrame(0x10, b"\x11\x22\x33\x44"), b"t0104" + b"11223344\r"),
        (CanFrame(0x100, b"\x01\x02", True), b"T00000100" + b"20102\r"),
        (CanFrame(0x7FF, b"", False, True), b"r7FF0\r"),
    ],
)
def test_golden_lines_of_the_lawicel_manual(frame: CanFrame, line: bytes) -> None:
    assert encode_frame(frame) == line


@pytest.mark.parametrize(
    "line",
    [
        b"",
        b"t",
        b"t12",
        b"t1238",
        b"t12381122",
        b"t123911",
        b"tXYZ0",
        b"t8FF0",
        b"T200000000",
        b"q1230",
        b"t1231G1",
        b"t+1212 1",
        b"t1_21AA",
        b"t 121AA",
        b"t1231 A",
    ],
)
def test_damaged_and_cut_lines_are_no_frames(line: bytes) -> None:
    """Among them a length of 8 with two bytes, which python-can's own bus accepts."""
    assert decode_line(line) is None


def test_what_one_bus_sends_the_other_understands(terminal: Terminal) -> None:
    bus = ChunkedSlcanBus(terminal.path)
    terminal.read()
    rng = random.Random(1)
    frames = [random_frame(rng) for _ in range(50)]
    for frame in frames:
        bus.send(can.Message(arbitration_id=frame.identifier, data=frame.data, is_extended_id=frame.extended))
    sent = b""
    while sent.count(b"\r") < len(frames):
        sent += terminal.read()
    terminal.write(sent)
    received = [bus.recv(1.0) for _ in frames]
    assert [(m.arbitration_id, bytes(m.data), m.is_extended_id) for m in received if m is not None] == [
        (frame.identifier, frame.data, frame.extended) for frame in frames
    ]
    bus.shutdown()


def test_python_cans_own_bus_reads_the_same(terminal: Terminal) -> None:
    frames = [random_frame(random.Random(seed)) for seed in range(20)]
    own = can.Bus(interface="slcan", channel=terminal.path, bitrate=1_000_000, sleep_after_open=0.0)
    terminal.write(b"".join(encode_frame(frame) for frame in frames))
    for frame in frames:
        message = own.recv(1.0)
        assert message is not None
        assert (message.arbitration_id, bytes(message.data)) == (frame.identifier, frame.data)
    own.shutdown()


def test_the_channel_is_opened_and_closed_with_its_bit_rate(terminal: Terminal) -> None:
    bus = ChunkedSlcanBus(terminal.path, bitrate=500_000)
    assert terminal.read() == b"\rC\rS6\rO\r"
    bus.shutdown()
    assert terminal.read() == b"C\r"


def test_a_bit_rate_that_slcan_does_not_have_is_refused(terminal: Terminal) -> None:
    configuration = CanBusConfiguration(interface="slcan-chunked", channel=terminal.path, bitrate=123_456)
    with pytest.raises(AdapterConnectionError, match="123456"):
        open_can_link(configuration)


def test_garbage_is_counted_and_never_raises(terminal: Terminal) -> None:
    bus = ChunkedSlcanBus(terminal.path)
    rng = random.Random(9)
    good = encode_frame(CanFrame(0x123, b"\x01\x02"))
    n_found = 0
    for _ in range(200):
        terminal.write(rng.randbytes(rng.randrange(40)) + b"\r" + good)
        while (message := bus.recv(0.05)) is not None and message.arbitration_id != 0x123:
            pass
        n_found += message is not None
    assert n_found == 200
    assert bus.n_damaged > 0
    bus.shutdown()


def test_garbage_without_an_end_of_line_does_not_pile_up(terminal: Terminal) -> None:
    bus = ChunkedSlcanBus(terminal.path)
    for _ in range(100):
        terminal.write(b"x" * 1000)
        assert bus.recv(0.0) is None
    assert len(bus._buffer) <= 64
    bus.shutdown()


def test_a_line_that_is_gone_is_an_error_of_ours() -> None:
    terminal = Terminal()
    link = open_can_link(CanBusConfiguration(interface="slcan-chunked", channel=terminal.path))
    terminal.close()
    with pytest.raises(AdapterConnectionError):
        link.receive()
    link.close()

"""No twin falls over, whatever comes in; none moves a joint that nobody enabled."""

from __future__ import annotations

import random

import can
import pytest

from fricomp.sim_bench.stand_in import default_joint
from fricomp.sim_bench.twins import DriveAxis, DriveTwin, twin_stand_in
from fricomp.sim_bench.twins.can_twin import CanTwin
from fricomp.sim_bench.twins.configuration import CAN_PROTOCOLS, make_twin
from fricomp.sim_bench.twins.moteus.bus import MoteusController, MoteusTwin
from fricomp.sim_bench.twins.slcan import SlcanPort

from .moteus.test_moteus import Line

FRAMES = 3000


class RandomPort:
    """A bus full of nonsense."""

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.left = 0

    def recv(self, timeout: float | None = None) -> can.Message | None:
        if self.left == 0:
            return None
        self.left -= 1
        draw = self.random
        length = draw.choice([8, 8, 8, 8, draw.randrange(9)])
        identifier = draw.choice([draw.randrange(0x800), 0x001, 0x021, 0x027, 0x02E, 0x080, 0x201, 0x601, 0x7FF])
        return can.Message(
            arbitration_id=identifier,
            is_extended_id=draw.random() < 0.05,
            is_remote_frame=draw.random() < 0.05,
            data=draw.randbytes(length),
        )

    def send(self, msg: can.Message) -> None:
        assert msg.dlc == len(msg.data)

    def shutdown(self) -> None:
        pass


@pytest.mark.parametrize("protocol", CAN_PROTOCOLS)
@pytest.mark.parametrize("seed", [0, 1])
def test_random_frames_do_no_harm(protocol: str, seed: int) -> None:
    with make_twin(protocol) as made:
        assert isinstance(made, CanTwin)
        port = RandomPort(seed)
        made.port.shutdown()
        made.port = port
        for _ in range(FRAMES // 10):
            port.left = 10
            made.step()
            assert abs(made.stand_in.torque[0]) <= 5.0


@pytest.mark.parametrize("protocol", ["moteus", "dynamixel"])
def test_random_bytes_do_no_harm(protocol: str) -> None:
    generator = random.Random(2)
    with make_twin(protocol) as made:
        line = Line()
        made.port.close()  # type: ignore[attr-defined]
        made.port = line  # type: ignore[attr-defined]
        headers = [b"\xff\xff\xfd\x00\x01", b"can send 8001 ", b"\n", b"*", b""]
        for _ in range(FRAMES // 4):
            line.incoming = generator.choice(headers) + generator.randbytes(generator.randrange(40))
            made.step()
            assert made.stand_in.torque == [0.0]


def test_random_frames_inside_good_lines_do_no_harm() -> None:
    generator = random.Random(3)
    stand_in = twin_stand_in(default_joint())
    line = Line()
    twin: DriveTwin = MoteusTwin(line, stand_in, [MoteusController(DriveAxis(stand_in))])
    for _ in range(FRAMES):
        line.incoming = b"can send 8001 " + generator.randbytes(generator.randrange(64)).hex().encode() + b"\n"
        twin.step()
        assert abs(stand_in.torque[0]) <= 5.0


def test_slcan_passes_frames_both_ways_and_refuses_damaged_ones() -> None:
    line = Line()
    port = SlcanPort(line)
    line.incoming = b"t1232AABB\r"
    assert port.recv() is None
    assert line.outgoing == b"\a", "the channel is closed"
    line.outgoing, line.incoming = b"", b"S8\rO\rt1232AA"
    assert port.recv() is None
    line.incoming = b"BB\rT000012341FF\rr0010\rt12\rtXYZ1AA\rt1232AA\r\xff\r"
    found = []
    while (message := port.recv()) is not None:
        found.append((message.arbitration_id, message.is_extended_id, message.is_remote_frame, bytes(message.data)))
    assert found == [(0x123, False, False, b"\xaa\xbb"), (0x1234, True, False, b"\xff"), (1, False, True, b"")]
    assert line.outgoing == b"\r\rz\rZ\rz\r" + b"\a" * 4
    line.outgoing = b""
    port.send(can.Message(arbitration_id=0x7A, data=b"\x01\x02", is_extended_id=False))
    assert line.outgoing == b"t07A20102\r"

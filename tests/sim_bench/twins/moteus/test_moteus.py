"""The moteus controller: frames by hand from the reference manual, and the moteus package as an independent master."""

from __future__ import annotations

import asyncio
import struct
from math import nan, pi

import pytest

from fricomp.errors import ParameterError
from fricomp.sim_bench.stand_in import StandIn
from fricomp.sim_bench.twins import DriveAxis, PtyPort, TwinServer, twin_stand_in
from fricomp.sim_bench.twins.moteus.bus import MoteusController, MoteusSettings, MoteusTwin, crc8

from ..rig import ideal_joint

TURN = 2.0 * pi


class Line:
    """A byte port whose other end is the test."""

    address = "test"

    def __init__(self) -> None:
        self.incoming, self.outgoing = b"", b""

    def read(self) -> bytes:
        data, self.incoming = self.incoming, b""
        return data

    def write(self, data: bytes) -> None:
        self.outgoing += data

    def close(self) -> None:
        pass


class Rig:
    def __init__(self, settings: MoteusSettings) -> None:
        self.stand_in: StandIn = twin_stand_in(ideal_joint())
        self.line = Line()
        self.controller = MoteusController(DriveAxis(self.stand_in), settings)
        self.twin = MoteusTwin(self.line, self.stand_in, [self.controller])

    def say(self, text: str) -> list[str]:
        self.line.outgoing = b""
        self.line.incoming = text.encode() + b"\n"
        self.twin.pump()
        return self.line.outgoing.decode().splitlines()

    def frame(self, data: bytes, identifier: int = 0x8001) -> bytes:
        """The data that came back."""
        for line in self.say(f"can send {identifier:04x} {data.hex()}"):
            if line.startswith("rcv"):
                return bytes.fromhex(line.split()[2])
        return b""

    def steps(self, number: int) -> None:
        for _ in range(number):
            self.twin.step()


@pytest.fixture
def rig() -> Rig:
    return Rig(MoteusSettings(timeout_mode=0))


def position_command(**registers: float) -> bytes:
    """Mode 10 and float registers of the position command."""
    numbers = {"position": 0x20, "velocity": 0x21, "torque": 0x22, "kp": 0x23, "kd": 0x24, "most": 0x25, "time": 0x27}
    body = bytes([0x01, 0x00, 10])
    for name, value in registers.items():
        body += bytes([0x0D, numbers[name]]) + struct.pack("<f", value)
    return body


QUERY_MODE = bytes([0x11, 0x00])
STOP = bytes([0x01, 0x00, 0])


def test_answers_registers_in_the_resolution_asked_for(rig: Rig) -> None:
    assert rig.frame(bytes([0x1D, 0x01])) == bytes([0x2D, 0x01]) + struct.pack("<f", 0.25 / TURN)
    assert rig.frame(bytes([0x15, 0x01])) == bytes([0x25, 0x01]) + struct.pack("<h", int(0.25 / TURN / 0.0001))
    assert rig.frame(bytes([0x11, 0x01])) == bytes([0x21, 0x01, int(0.25 / TURN / 0.01)])


def test_feed_forward_torque_with_zero_gains_is_pure_torque(rig: Rig) -> None:
    rig.frame(position_command(position=nan, torque=1.25, kp=0.0, kd=0.0))
    rig.steps(1)
    assert rig.stand_in.torque == [1.25]
    rig.frame(position_command(position=nan, torque=1.25, kp=0.0, kd=0.0, most=0.5))
    rig.steps(1)
    assert rig.stand_in.torque == [0.5]


def test_a_frame_without_a_mode_commands_nothing(rig: Rig) -> None:
    rig.frame(bytes([0x0D, 0x22]) + struct.pack("<f", 1.0))
    rig.steps(2)
    assert rig.stand_in.torque == [0.0]


def test_velocity_command_slides_in_turns_per_second(rig: Rig) -> None:
    for _ in range(1000):
        rig.frame(position_command(position=nan, velocity=0.03))
        rig.steps(1)
    assert rig.stand_in.plant.velocity(0) == pytest.approx(0.03 * TURN, rel=0.02)


def test_a_command_lapses_and_only_a_stop_leaves_the_timeout(rig: Rig) -> None:
    command = position_command(position=nan, torque=1.0, kp=0.0, kd=0.0)
    rig.frame(command)
    rig.steps(99)
    assert rig.stand_in.torque == [1.0]
    rig.steps(3)
    assert rig.stand_in.torque == [0.0]
    assert rig.frame(QUERY_MODE) == bytes([0x21, 0x00, 11])
    rig.frame(command)
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    rig.frame(STOP)
    rig.frame(command)
    rig.steps(1)
    assert rig.stand_in.torque == [1.0]


def test_a_timeout_can_be_given_with_the_command(rig: Rig) -> None:
    rig.frame(position_command(position=nan, torque=1.0, kp=0.0, kd=0.0, time=0.01))
    rig.steps(12)
    assert rig.stand_in.torque == [0.0]


def test_a_fault_lasts_until_a_stop(rig: Rig) -> None:
    rig.frame(position_command(position=nan, torque=1.0))
    rig.controller.fail(33)
    assert rig.frame(bytes([0x11, 0x0F])) == bytes([0x21, 0x0F, 33])
    rig.frame(position_command(position=nan, torque=1.0))
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    rig.frame(STOP)
    assert rig.frame(QUERY_MODE) == bytes([0x21, 0x00, 0])


def test_integer_and_float_not_a_number_mean_not_given(rig: Rig) -> None:
    rig.frame(bytes([0x01, 0x00, 10, 0x05, 0x20]) + struct.pack("<h", -32768) + bytes([0x0D, 0x22]) + b"\0\0\xc0\x7f")
    rig.steps(1)
    assert rig.stand_in.torque[0] == pytest.approx(0.0, abs=1e-9)


def mode_command(mode: int, **registers: float) -> bytes:
    """A mode and float registers by their number, as `r1c=...`."""
    body = bytes([0x01, 0x00, mode])
    for name, value in registers.items():
        body += bytes([0x0D, int(name[1:], 16)]) + struct.pack("<f", value)
    return body


def test_a_current_is_a_torque_that_does_not_lapse(rig: Rig) -> None:
    rig.frame(mode_command(9, r1c=5.0, r1d=0.0))
    rig.steps(500)  # five times the timeout of a position
    assert rig.stand_in.torque[0] == pytest.approx(0.5)
    assert rig.frame(QUERY_MODE) == bytes([0x21, 0x00, 9])
    rig.frame(STOP)
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]


def test_a_brake_takes_the_speed_away_and_holds_nothing(rig: Rig) -> None:
    rig.frame(mode_command(9, r1c=20.0))
    rig.steps(300)
    fast = rig.stand_in.plant.velocity(0)
    rig.frame(mode_command(15))
    rig.steps(1)
    assert rig.stand_in.torque[0] < 0.0 < fast
    rig.steps(1000)
    assert abs(rig.stand_in.plant.velocity(0)) < 0.05 * fast
    assert rig.controller.axis.energised


def test_staying_within_pushes_beyond_its_bounds_only_and_lapses(rig: Rig) -> None:
    here = rig.stand_in.plant.position(0) / TURN
    rig.frame(mode_command(13, r40=here - 0.1, r41=here + 0.1, r42=0.0))
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    rig.frame(mode_command(13, r40=here + 0.05, r41=here + 0.1, r45=0.7))
    rig.steps(1)
    assert rig.stand_in.torque == pytest.approx([0.7])
    rig.steps(110)
    assert rig.frame(QUERY_MODE) == bytes([0x21, 0x00, 11])
    assert rig.stand_in.torque == [0.0]


def test_unknown_registers_are_reported(rig: Rig) -> None:
    assert rig.frame(bytes([0x11, 0xFF, 0x0F])) == bytes([0x31, 0xFF, 0x0F, 0x01])


def test_lines_with_a_checksum_are_checked_and_answered_with_one(rig: Rig) -> None:
    body = f"can send 8001 {QUERY_MODE.hex()} "
    answers = rig.say(f"{body}*{crc8(body.encode()):02X}")
    assert [answer[:3] for answer in answers] == ["OK ", "rcv"]
    for answer in answers:
        content, _, check = answer.rpartition("*")
        assert int(check, 16) == crc8(content.encode())
    assert rig.say(f"{body}*00") in ([f"ERR checksum mismatch *{crc8(b'ERR checksum mismatch '):02X}"],)


@pytest.mark.parametrize("line", ["", "can send", "can send zz 00", "can send 8001 0", "hello", "can send 8001 08"])
def test_damaged_lines_do_no_harm(rig: Rig, line: str) -> None:
    assert all(answer[:2] in ("OK", "ER") for answer in rig.say(line))
    assert rig.frame(QUERY_MODE) == bytes([0x21, 0x00, 0])


def test_the_moteus_package_drives_the_twin_unmodified() -> None:
    moteus = pytest.importorskip("moteus", reason="moteus is not installed")
    stand_in = twin_stand_in(ideal_joint())
    port = PtyPort()
    controller = MoteusController(DriveAxis(stand_in))

    async def converse(twin: MoteusTwin) -> None:
        device = moteus.fdcanusb_device.FdcanusbDevice(port.address, command_timeout=5.0, response_timeout=5.0)
        peer = moteus.Controller(id=1, transport=moteus.transport.Transport([device]))
        register = moteus.Register
        stopped = await peer.set_stop(query=True)
        assert stopped.values[register.MODE] == 0
        for _ in range(300):
            moving = await peer.set_position(position=nan, velocity=0.05, query=True)
            twin.step()
        assert moving.values[register.MODE] == 10
        assert moving.values[register.POSITION] == pytest.approx(stand_in.plant.position(0) / TURN, abs=1e-4)
        assert moving.values[register.VELOCITY] == pytest.approx(0.05, rel=0.05)
        assert moving.values[register.TORQUE] == pytest.approx(stand_in.torque[0], rel=0.2)
        stream = moteus.Stream(peer)
        kp = await stream.command(b"conf get servo.pid_position.kp", allow_any_response=True)
        assert float(kp) == pytest.approx(controller.configuration["servo.pid_position.kp"])
        for mode, command in (
            (9, peer.set_current(q_A=1.0, d_A=0.0)),
            (13, peer.set_stay_within(lower_bound=-0.1, upper_bound=0.2)),
            (15, peer.set_brake()),
            (10, peer.set_position(position=nan)),
        ):
            await command
            assert (await peer.query()).values[register.MODE] == mode
        for _ in range(110):
            twin.step()
        lapsed = await peer.query()
        assert lapsed.values[register.MODE] == 11
        device.close()

    with MoteusTwin(port, stand_in, [controller]) as twin, TwinServer(twin) as server:
        asyncio.run(converse(twin))
        assert server.error is None


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ParameterError, match="identifier"):
        MoteusSettings(identifier=127)

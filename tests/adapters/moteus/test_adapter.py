"""moteus controllers through the whole conformance suite, and what is special about them."""

from __future__ import annotations

import struct
import warnings
from collections.abc import Sequence
from dataclasses import replace
from math import nan
from typing import Any, cast

import pytest

from fricomp.adapters.configuration import convert
from fricomp.adapters.moteus import MoteusAdapter
from fricomp.adapters.moteus.adapter import MoteusConfiguration
from fricomp.adapters.moteus.codec import decode_state, encode_command
from fricomp.adapters.moteus.fdcanusb import LineBuffer, decode_line
from fricomp.errors import AdapterConfigurationError, AdapterValueError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.stand_in import StandIn, default_joint
from fricomp.sim_bench.studies.adapters.hand_held import HandHeldAxis
from fricomp.sim_bench.twins.memory import MemorySerialLine
from fricomp.sim_bench.twins.moteus.bus import MoteusController, MoteusSettings, MoteusTwin
from fricomp.sim_bench.twins.moteus.frame import StreamWrite, Write, parse_frame
from fricomp.testing import AdapterRig, FaultyLink, GoldenCommand, VirtualClock
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, start
from tests.adapters.peers.rig import joint_tables

GEARS = (1.0, -2.0)


class Controller(MoteusController):
    """The twin's controller, with faults on demand."""

    failing = refuses_position = False

    def tick(self, now_ns: int) -> None:
        if self.failing:
            self.fail(33)
        super().tick(now_ns)

    def _enter(self, mode: int) -> None:
        if not (self.refuses_position and mode == 10):
            super()._enter(mode)


def configuration(**changes: Any) -> dict[str, Any]:
    joints = joint_tables(2, torque=4.0, velocity=20.0)
    joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
    return {"serial": {"port": "loop://"}, "joints": joints, "ramp_time": 0.0} | changes


class MoteusRig(AdapterRig):
    def __init__(self, **changes: Any) -> None:
        self.torque_limit = 4.0
        self.clock = VirtualClock()
        self.axes = [HandHeldAxis(), HandHeldAxis()]
        settings = [MoteusSettings(identifier) for identifier in (1, 2)]
        self.controllers = [
            Controller(cast(Any, axis), setting) for axis, setting in zip(self.axes, settings, strict=True)
        ]
        line = MemorySerialLine()
        line.on_sent = MoteusTwin(line, StandIn(default_joint()), self.controllers).pump
        self.clock.follow(self._tick)
        self.link = FaultyLink(line.link)
        made = convert(configuration(**changes), MoteusConfiguration)
        self.adapter = MoteusAdapter(made, lambda: self.link, self.clock)

    def _tick(self, now_ns: int) -> None:
        for controller in self.controllers:
            controller.tick(now_ns)

    def applied_torque(self) -> list[float]:
        return [axis.torque * gear for axis, gear in zip(self.axes, GEARS, strict=True)]

    def energised(self) -> list[bool]:
        return [axis.energised for axis in self.axes]

    def move(self, joint: int, position: float, velocity: float) -> None:
        self.axes[joint].position, self.axes[joint].velocity = position * GEARS[joint], velocity * GEARS[joint]

    def fail(self, joint: int) -> None:
        self.controllers[joint].failing = True

    def heal(self, joint: int) -> None:
        self.controllers[joint].failing = False

    def power_cycle(self, joint: int) -> None:
        self.controllers[joint].power_cycle()

    def refuse_mode(self) -> None:
        for controller in self.controllers:
            controller.refuses_position = True

    def hold(self, joint: int) -> None:
        controller = self.controllers[joint]
        endless = struct.pack("<f", 1e9)
        controller.frame(bytes((0x01, 0x00, 10, 0x0D, 0x22)) + struct.pack("<f", 1.0) + bytes((0x0D, 0x27)) + endless)

    def is_read(self, traffic: bytes) -> bool:
        """Lines whose subframes read registers or ask for a setting."""
        frames = [bytes.fromhex(line.split()[3].decode()) for line in traffic.split(b"\n") if line.strip()]
        parts = [part for frame in frames for part in parse_frame(frame)]
        texts = [part.data for part in parts if isinstance(part, StreamWrite)]
        return all(text.startswith(b"conf get") for text in texts) and not any(isinstance(p, Write) for p in parts)

    def golden(self) -> Sequence[GoldenCommand]:
        """Both controllers' lines as the vendor's package makes them."""
        return [
            GoldenCommand((torque, 0.0), vendor_line(1, torque, 4.0) + vendor_line(2, -0.0, 2.0))
            for torque in (0.25, -3.0)
        ]


def vendor_line(address: int, torque: float, highest: float) -> bytes:
    """A command for torque alone, made by the vendor's package and padded as its fdcanusb device does."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import moteus

    made = moteus.Controller(id=address).make_position(
        position=nan,
        velocity=0.0,
        feedforward_torque=torque,
        kp_scale=0.0,
        kd_scale=0.0,
        maximum_torque=highest,
        watchdog_timeout=0.1,
        query=True,
    )
    data = made.data.ljust(48, b"\x50")
    return b"can send 80%02x %s\n" % (address, data.hex().encode())


class TestMoteusConforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return MoteusRig()


@pytest.mark.parametrize("value", [nan, float("inf"), 1e39])
@pytest.mark.parametrize("mode", ["torque", "velocity", "position"])
def test_no_value_of_ours_is_ever_sent_as_nan(value: float, mode: Any) -> None:
    """To a moteus NaN is a command: no position, or no limit."""
    with pytest.raises(AdapterValueError):
        encode_command(mode, value, 0.0, 1.0, 0.1)
    with pytest.raises(AdapterValueError):
        encode_command(mode, 0.0, value, 1.0, 0.1)


def test_the_drive_stops_instead_of_braking_when_commands_cease() -> None:
    rig = MoteusRig()
    rig.adapter.open()
    rig.adapter.configure("torque", 0.002)
    for controller in rig.controllers:
        assert controller.configuration["servo.timeout_mode"] == 0.0
        assert controller.configuration["servo.default_timeout_s"] == pytest.approx(0.1)


def test_a_controller_that_was_power_cycled_is_told_again_to_stop_before_it_is_energised() -> None:
    rig = MoteusRig()
    rig.adapter.open()
    rig.adapter.configure("torque", 0.002)
    rig.power_cycle(1)
    assert rig.controllers[1].configuration["servo.timeout_mode"] == 12
    rig.adapter.enable()
    assert all(controller.configuration["servo.timeout_mode"] == 0.0 for controller in rig.controllers)


@pytest.mark.parametrize("mode", ["velocity", "position"])
def test_the_drives_own_loop_is_bounded_by_the_limit_too(mode: Any) -> None:
    rig = stiff_rig()
    rig.adapter.open()
    rig.adapter.configure(mode, 0.002)
    rig.adapter.enable()
    command = JointCommand(2)
    command.velocity[:], command.position[:] = [20.0, -20.0], [3.0, -3.0]
    for _ in range(100):  # blocked joints
        rig.clock.advance(0.002)
        rig.adapter.read_into(JointFeedback(2))
        assert rig.adapter.write(command)
    assert [axis.largest_torque for axis in rig.axes] == pytest.approx([4.0, 2.0])


@pytest.mark.parametrize("mode", ["torque", "velocity", "position"])
def test_every_command_carries_the_highest_torque_and_enabling_holds_still(mode: Any) -> None:
    rig = stiff_rig()
    rig.adapter.open()
    rig.adapter.configure(mode, 0.002)
    for joint, position in enumerate((1.2, -0.7)):  # moved by hand after it was last looked at
        rig.move(joint, position, 0.0)
    rig.link.recording = True
    rig.adapter.enable()
    assert [axis.largest_torque for axis in rig.axes] == pytest.approx([0.0, 0.0], abs=1e-3)
    rig.clock.advance(0.002)
    run(rig, 3)
    commands = sent_commands(rig.link.sent)
    assert len(commands) >= 8
    assert {(address, highest) for address, highest in commands} == {(1, 4.0), (2, 2.0)}


def test_a_joint_that_moves_until_it_is_energised_is_held_where_it_is_then(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = stiff_rig()
    rig.adapter.open()
    rig.adapter.configure("position", 0.002)
    assert isinstance(rig.adapter, MoteusAdapter)
    prepare = rig.adapter._set_timeouts

    def prepare_while_it_falls() -> None:
        prepare()
        rig.move(0, -0.3, 0.0)

    monkeypatch.setattr(rig.adapter, "_set_timeouts", prepare_while_it_falls)
    rig.adapter.enable()
    assert rig.axes[0].largest_torque == pytest.approx(0.0, abs=1e-3)


def test_limits_cut_down_after_opening_count_for_the_drives_own_loop() -> None:
    rig = stiff_rig()
    rig.adapter.open()
    assert isinstance(rig.adapter, MoteusAdapter)
    options = rig.adapter.options
    rig.adapter.options = replace(options, limits=tuple(replace(limit, torque=0.25) for limit in options.limits))
    rig.adapter.configure("position", 0.002)
    rig.link.recording = True
    rig.adapter.enable()
    assert set(sent_commands(rig.link.sent)) == {(1, 0.25), (2, 0.125)}


def stiff_rig() -> MoteusRig:
    rig = MoteusRig()
    for controller in rig.controllers:
        controller.configuration |= {"servo.pid_position.kp": 4000.0, "servo.pid_position.kd": 100.0}
    return rig


def sent_commands(traffic: Sequence[bytes]) -> list[tuple[int, float]]:
    """Address and highest torque of every command of mode 10 that was sent, taken apart by the twin's own parser."""
    found = []
    for line in b"".join(traffic).splitlines():
        if not line.startswith(b"can send"):
            continue
        _, _, address, data = line.split()
        parts = parse_frame(bytes.fromhex(data.decode()))
        writes = {part.register: part.value for part in parts if isinstance(part, Write)}
        if writes.get(0x000) == 10:
            found.append((int(address, 16) & 0x7F, writes[0x025]))
    return found


def test_a_controller_that_is_not_there_is_named() -> None:
    rig = MoteusRig()
    rig.controllers[1].settings = MoteusSettings(9)
    with pytest.raises(Exception, match=r"\[1, 2\]"):
        rig.adapter.open()


def test_lines_come_in_any_pieces() -> None:
    buffer = LineBuffer()
    assert buffer.take(b"OK\nrcv 0100 21") == [b"OK"]
    assert buffer.take(b"000a E\n") == [b"rcv 0100 21000a E"]
    assert buffer.take(b"x" * 300) == []
    assert buffer.n_dropped == 1


@pytest.mark.parametrize("line", [b"", b"rcv", b"rcv 100 zz", b"rcv gg 00", b"OK", b"rcv 100 \xff\xff", b"rcv 100 123"])
def test_damaged_lines_are_no_frames(line: bytes) -> None:
    assert decode_line(line) is None


@pytest.mark.parametrize("length", range(22))
def test_an_answer_that_is_cut_short_is_no_state(length: int) -> None:
    whole = bytes.fromhex("21000a2f010000803f0000003f0000803e230d301e00")
    assert decode_state(whole) is not None
    assert decode_state(whole[:length]) is None


def test_controller_numbers_beyond_the_protocol_are_refused() -> None:
    bad = configuration()
    bad["joints"][0]["id"] = 127
    with pytest.raises(AdapterConfigurationError, match="1 to 126"):
        convert(bad, MoteusConfiguration)


def test_a_timeout_of_the_drive_stops_all_joints() -> None:
    rig = MoteusRig()
    rig.adapter.open()
    start(rig)
    run(rig, 3, torque=1.0)
    rig.clock.advance(0.2)
    assert rig.controllers[0].mode == 11
    assert not rig.adapter.write(JointCommand(2))


def test_a_setting_that_is_not_kept_is_named_with_its_controller(monkeypatch: pytest.MonkeyPatch) -> None:
    rig = MoteusRig()
    rig.adapter.open()
    assert isinstance(rig.adapter, MoteusAdapter)
    converse = rig.adapter._converse

    def forget_the_timeout(joint: int, line: str) -> str:
        answer = converse(joint, line)
        return "0.5" if joint == 1 and line == "conf get servo.default_timeout_s" else answer

    monkeypatch.setattr(rig.adapter, "_converse", forget_the_timeout)
    with pytest.raises(AdapterConfigurationError, match=r"controller 2 .*default_timeout_s = 0.1: read back '0.5'"):
        rig.adapter.configure("torque", 0.002)

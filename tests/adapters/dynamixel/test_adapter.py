"""Dynamixel servos through the whole conformance suite, and what is special about them."""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any, cast

import pytest
from dynamixel_sdk import Protocol2PacketHandler

from fricomp.adapters.configuration import convert
from fricomp.adapters.dynamixel import DynamixelAdapter
from fricomp.adapters.dynamixel.adapter import encode_goals
from fricomp.adapters.dynamixel.checksum import compute_crc
from fricomp.adapters.dynamixel.configuration import DynamixelConfiguration
from fricomp.adapters.dynamixel.packet import (
    SyncWriter,
    encode_packet,
    read_packet,
    sync_read_packet,
    sync_write_packet,
)
from fricomp.adapters.dynamixel.packet_buffer import PacketBuffer
from fricomp.errors import AdapterConfigurationError, AdapterTimeout, AdapterValueError
from fricomp.joint import JointFeedback
from fricomp.sim_bench.adapter_bench.hand_held import HandHeldAxis, SerialBus
from fricomp.sim_bench.twins.dynamixel import DynamixelServo, DynamixelSettings, DynamixelTwin
from fricomp.sim_bench.twins.dynamixel_packet import PacketReader
from fricomp.testing import AdapterRig, FaultyLink, GoldenCommand, VirtualClock
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, start
from tests.adapters.peers.rig import joint_tables

# A gear turns positions and velocities; of a torque counted in amperes only the sign.
GEARS, SIGNS = (1.0, -2.0), (1.0, -1.0)
GOAL_CURRENT, OPERATING_MODE, HARDWARE_ERROR = 102, 11, 70


class Servo(DynamixelServo):
    """The twin's servo, with faults on demand."""

    failing = keeps_mode = False

    def tick(self, now_ns: int) -> None:
        if self.failing:
            self.fail()
        super().tick(now_ns)

    def write(self, address: int, data: bytes) -> int:
        return 0 if self.keeps_mode and address == OPERATING_MODE else super().write(address, data)


def configuration(**changes: Any) -> dict[str, Any]:
    joints = joint_tables(2, torque=1.0, velocity=20.0)
    joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
    return {"serial": {"port": "loop://"}, "joints": joints, "ramp_time": 0.0} | changes


class DynamixelRig(AdapterRig):
    def __init__(self, **changes: Any) -> None:
        self.torque_limit, self.period = 1.0, 0.004
        self.clock = VirtualClock()
        self.axes = [HandHeldAxis(), HandHeldAxis()]
        settings = [DynamixelSettings(identifier, torque_constant=1.0) for identifier in (1, 2)]
        self.servos = [Servo(cast(Any, axis), setting) for axis, setting in zip(self.axes, settings, strict=True)]
        bus = SerialBus()
        bus.twin = DynamixelTwin(cast(Any, bus), cast(Any, None), self.servos)
        self.clock.follow(self._tick)
        self.link = FaultyLink(bus)
        made = convert(configuration(**changes), DynamixelConfiguration)
        self.adapter = DynamixelAdapter(made, lambda: self.link, self.clock)

    def _tick(self, now_ns: int) -> None:
        for servo in self.servos:
            servo.tick(now_ns)

    def applied_torque(self) -> list[float]:
        return [axis.torque * sign for axis, sign in zip(self.axes, SIGNS, strict=True)]

    def energised(self) -> list[bool]:
        return [axis.energised for axis in self.axes]

    def move(self, joint: int, position: float, velocity: float) -> None:
        self.axes[joint].position, self.axes[joint].velocity = position * GEARS[joint], velocity * GEARS[joint]

    def fail(self, joint: int) -> None:
        self.servos[joint].failing = True

    def heal(self, joint: int) -> None:
        self.servos[joint].failing = False

    def power_cycle(self, joint: int) -> None:
        self.servos[joint].power_cycle()

    def refuse_mode(self) -> None:
        for servo in self.servos:
            servo.keeps_mode = True

    def golden(self) -> Sequence[GoldenCommand]:
        """The goals of both servos and the request for their states, as the vendor's package makes them."""
        sdk = SdkPort()
        golden = []
        for count in (100, -37):
            data = [1, *count.to_bytes(2, "little", signed=True), 2, 0, 0]
            goals = sdk.sync_write(GOAL_CURRENT, 2, data)
            golden.append(GoldenCommand((count * 2.69e-3, 0.0), goals + sdk.sync_read(126, 10, [1, 2])))
        return golden


class SdkPort:
    """Catches what the vendor's package sends."""

    is_using = False

    def __init__(self) -> None:
        self.sent = b""

    def clearPort(self) -> None:  # noqa: N802
        """Nothing to clear."""

    def writePort(self, packet: Sequence[int]) -> int:  # noqa: N802
        self.sent += bytes(packet)
        return len(packet)

    def setPacketTimeout(self, length: int) -> None:  # noqa: N802
        """Nothing is received."""

    def _catch(self) -> bytes:
        sent, self.sent, self.is_using = self.sent, b"", False
        return sent

    def sync_write(self, address: int, n_bytes: int, data: Sequence[int]) -> bytes:
        Protocol2PacketHandler().syncWriteTxOnly(self, address, n_bytes, list(data), len(data))
        return self._catch()

    def sync_read(self, address: int, n_bytes: int, servos: Sequence[int]) -> bytes:
        Protocol2PacketHandler().syncReadTx(self, address, n_bytes, list(servos), len(servos), False)
        return self._catch()


class TestDynamixelConforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return DynamixelRig()


def test_packets_and_checksums_are_the_vendors() -> None:
    """Where nothing has to be stuffed: dynamixel-sdk 4.1 throws the result of its own stuffing away."""
    sdk, rng = SdkPort(), random.Random(5)
    for _ in range(300):
        data = bytes(rng.choice((0xFF, 0xFD, 0x00, rng.randrange(256))) for _ in range(8))
        vendor = sdk.sync_write(116, 4, [1, *data[:4], 2, *data[4:]])
        assert b"\xff\xff\xfd" in data or sync_write_packet(116, {1: data[:4], 2: data[4:]}) == vendor
        assert sync_read_packet(126, 21, b"\x01\x02") == sdk.sync_read(126, 21, [1, 2])


@pytest.mark.parametrize(("n_bytes", "top"), [(2, 0x7FFF), (4, 0x7FFFFFFF)])
def test_a_prepared_packet_is_the_one_encoded_from_scratch(n_bytes: int, top: int) -> None:
    """Also where the values look like a header and have to be stuffed: -1 and -3 side by side make FF FF FD."""
    writer, rng = SyncWriter(116, n_bytes, b"\x01\xfd"), random.Random(8)
    for _ in range(300):
        counts = [rng.choice((-1, -3, 0xFD, top, -top, rng.randint(-top, top))) for _ in range(2)]
        values = {i: c.to_bytes(n_bytes, "little", signed=True) for i, c in zip((1, 0xFD), counts, strict=True)}
        assert writer.encode(counts) == sync_write_packet(116, values)


def test_many_servos_fit_into_one_prepared_packet() -> None:
    servos, counts = bytes(range(1, 41)), list(range(-20, 20))
    values = {servo: count.to_bytes(4, "little", signed=True) for servo, count in zip(servos, counts, strict=True)}
    assert SyncWriter(116, 4, servos).encode(counts) == sync_write_packet(116, values)


def test_the_temperature_is_told_before_enabling() -> None:
    rig = DynamixelRig()
    rig.adapter.open()
    rig.adapter.configure("torque", 0.004)
    feedback = JointFeedback(2)
    for _ in range(5):
        rig.clock.advance(0.02)
        rig.adapter.read_into(feedback)
    assert feedback.temperature == [30.0, 30.0]


def test_the_published_examples_come_out_to_the_byte() -> None:
    """Ping and read of the e-Manual's pages on protocol 2.0."""
    assert encode_packet(1, 0x01) == bytes.fromhex("fffffd0001030001194e")
    assert read_packet(1, 132, 4) == bytes.fromhex("fffffd0001070002840004001d15")


def test_the_tabled_checksum_is_the_bytewise_one() -> None:
    rng = random.Random(4)
    for n_bytes in range(100):
        data, crc = rng.randbytes(n_bytes), 0
        for bit in (byte >> place & 1 for byte in data for place in range(7, -1, -1)):
            crc = (crc << 1 ^ (0x8005 if (crc >> 15) ^ bit else 0)) & 0xFFFF
        assert compute_crc(data) == crc


def test_stuffed_packets_are_what_an_independent_reader_takes_for_them() -> None:
    rng, reader = random.Random(6), PacketReader()
    for _ in range(300):
        data = bytes(rng.choice((0xFF, 0xFD, 0x00)) for _ in range(8))
        assert [(1, 3, data)] == [tuple(packet) for packet in reader.feed(encode_packet(1, 3, data))]


def test_packets_are_found_in_any_pieces_and_after_garbage() -> None:
    rng = random.Random(2)
    whole = b"".join(encode_packet(servo, 0x55, b"\0" + bytes([0xFF, 0xFF, 0xFD, servo])) for servo in (1, 2, 3))
    stream = b"\xff\xff\xfd" + whole[:9] + b"\xff\xff\xfd\x00\x01\xff\xff" + whole
    buffer, found, at = PacketBuffer(), [], 0
    while at < len(stream):
        step = rng.randint(1, 5)
        found += buffer.take(stream[at : at + step])
        at += step
    assert [packet.identifier for packet in found] == [1, 2, 3]
    assert all(packet.data == bytes([0xFF, 0xFF, 0xFD, packet.identifier]) for packet in found)


def test_a_servo_that_cannot_control_current_is_refused_by_name() -> None:
    rig = DynamixelRig()
    rig.servos[1].table[0:2] = (1060).to_bytes(2, "little")
    with pytest.raises(AdapterConfigurationError, match=r"XL430-W250, which cannot control current.*XM430"):
        rig.adapter.open()


def test_torque_stays_in_amperes_without_a_torque_constant() -> None:
    rig = DynamixelRig()
    joint = rig.adapter.open().joints[0]
    assert joint.torque_unit == "A"
    assert joint.torque_quantum == pytest.approx(2.69e-3)
    assert joint.torque_limit == pytest.approx(1193 * 2.69e-3)


def test_a_torque_constant_turns_all_into_newton_metres() -> None:
    joints = joint_tables(2, torque=1.78, velocity=20.0, torque_constant=1.78)
    rig = DynamixelRig(joints=joints)
    rig.adapter.open()
    assert rig.adapter.capabilities.joints[0].torque_unit == "N·m"
    start(rig)
    run(rig, 2, torque=1.78)
    assert rig.axes[0].torque == pytest.approx(1.0, abs=2.69e-3)


def test_the_watchdog_is_rounded_to_counts_of_20_ms_and_declares_what_feeds_it() -> None:
    rig = DynamixelRig(watchdog=0.05)
    rig.adapter.open()
    rig.adapter.configure("torque", 0.004)
    watchdog = rig.adapter.capabilities.watchdog
    assert watchdog is not None
    assert watchdog.timeout == pytest.approx(0.04)
    assert watchdog.fed_by_reads
    assert rig.servos[0].table[98] == 2


def test_the_eeprom_is_written_only_where_it_differs() -> None:
    rig = DynamixelRig()
    rig.adapter.open()
    rig.adapter.configure("torque", 0.004)
    rig.adapter.close()
    rig.adapter.open()
    written: list[int] = []
    for servo in rig.servos:
        servo.write = lambda address, data, write=servo.write: written.append(address) or write(address, data)  # type: ignore[method-assign, func-returns-value, misc]
    rig.adapter.configure("torque", 0.004)
    assert all(address >= 64 for address in written)


def test_a_servo_that_is_not_there_is_named() -> None:
    rig = DynamixelRig()
    rig.servos[1].table[7] = 9
    with pytest.raises(AdapterTimeout, match="servo 2"):
        rig.adapter.open()


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_a_goal_that_is_not_finite_is_never_encoded(value: float) -> None:
    with pytest.raises(AdapterValueError):
        encode_goals([0.0, value], [1e-3, 1e-3], 2)


@pytest.mark.parametrize(("value", "count"), [(0.0014, 1), (-0.0014, -1), (1e9, 32767), (-1e9, -32767)])
def test_goals_are_rounded_and_saturate(value: float, count: int) -> None:
    assert encode_goals([0.0, value], [2.69e-3, 2.69e-3], 2) == [0, count]

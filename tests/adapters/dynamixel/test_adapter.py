"""Dynamixel servos through the whole conformance suite, and what is special about them."""

from __future__ import annotations

import random

import pytest

from fricomp.adapters.dynamixel.checksum import compute_crc
from fricomp.adapters.dynamixel.goals import encode_goals
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
from fricomp.sim_bench.twins.dynamixel.packet import PacketReader
from fricomp.testing import AdapterRig
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, start
from tests.adapters.dynamixel.rig import DynamixelRig, SdkPort
from tests.adapters.peers.rig import joint_tables


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
    joints = joint_tables(2, torque=1.78, velocity=9.0, torque_constant=1.78)
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
        encode_goals([0.0, value], [1e-3, 1e-3], [1193, 1193])


@pytest.mark.parametrize(("value", "count"), [(0.0014, 1), (-0.0014, -1), (1e9, 1193), (-1e9, -1193)])
def test_goals_are_rounded_and_saturate(value: float, count: int) -> None:
    assert encode_goals([0.0, value], [2.69e-3, 2.69e-3], [0, 1193]) == [0, count]


def test_a_velocity_limit_beyond_the_servos_own_is_refused() -> None:
    rig = DynamixelRig(joints=joint_tables(2, torque=1.0, velocity=25.0))
    with pytest.raises(AdapterConfigurationError, match="velocity limit 25 is beyond"):
        rig.adapter.open()


def test_a_current_limit_behind_a_gear_is_the_servos_own() -> None:
    joints = joint_tables(2, torque=3.2, velocity=2.0)
    joints[1] |= {"transmission": {"gear_ratio": 5.0}, "limits": joints[1]["limits"] | {"torque": 3.3}}
    with pytest.raises(AdapterConfigurationError, match=r"torque limit 3\.3 is beyond"):
        DynamixelRig(joints=joints).adapter.open()

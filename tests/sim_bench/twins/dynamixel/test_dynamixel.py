"""The Dynamixel servo: packets from the vendor's manual, and dynamixel-sdk as an independent master."""

from __future__ import annotations

from collections.abc import Iterator
from math import pi
from typing import Any

import pytest

from fricomp.errors import ParameterError
from fricomp.sim_bench.twins import DriveAxis, PtyPort, TwinServer, twin_stand_in
from fricomp.sim_bench.twins.dynamixel.line import DynamixelServo, DynamixelSettings, DynamixelTwin
from fricomp.sim_bench.twins.dynamixel.packet import PacketReader, crc16, fast_status, status_packet

from ..rig import ideal_joint

MODE, ENABLE, ERROR, WATCHDOG, GOAL_CURRENT, CURRENT, VELOCITY, POSITION = 11, 64, 70, 98, 102, 126, 128, 132
ACCESS, RANGE, LIMIT = 7, 4, 6


class Rig:
    """The official library on one end of a pseudo-terminal, the twin on the other."""

    def __init__(self, sdk: Any) -> None:
        self.stand_in = twin_stand_in(ideal_joint())
        line = PtyPort()
        self.servo = DynamixelServo(DriveAxis(self.stand_in))
        self.twin = DynamixelTwin(line, self.stand_in, [self.servo])
        self.sdk, self.port, self.packets = sdk, sdk.PortHandler(line.address), sdk.PacketHandler(2.0)
        assert self.port.openPort()

    def write(self, address: int, size: int, value: int) -> int:
        """Error of the status packet."""
        send = {1: self.packets.write1ByteTxRx, 2: self.packets.write2ByteTxRx, 4: self.packets.write4ByteTxRx}[size]
        outcome, error = send(self.port, 1, address, value)
        assert outcome == self.sdk.COMM_SUCCESS
        return int(error) & 0x7F

    def read(self, address: int, size: int) -> int:
        ask = {1: self.packets.read1ByteTxRx, 2: self.packets.read2ByteTxRx, 4: self.packets.read4ByteTxRx}[size]
        value, outcome, _ = ask(self.port, 1, address)
        assert outcome == self.sdk.COMM_SUCCESS
        return int(value)

    def steps(self, number: int) -> None:
        for _ in range(number):
            self.twin.step()


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Iterator[Rig]:
    sdk = pytest.importorskip("dynamixel_sdk", reason="dynamixel-sdk is not installed")
    # Milliseconds that the library allows the operating system; a busy machine takes more than its 16.
    monkeypatch.setattr("dynamixel_sdk.port_handler.LATENCY_TIMER", 2000)
    made = Rig(sdk)
    with made.twin, TwinServer(made.twin) as server:
        yield made
        made.port.closePort()
        assert server.error is None


def test_the_manuals_ping_is_answered_as_the_manual_says() -> None:
    """Ping of id 1 and its status, e-manual of protocol 2.0 (model 1030, firmware 38)."""
    ping = bytes.fromhex("FFFFFD00010300 01 194E".replace(" ", ""))
    assert list(PacketReader().feed(ping)) == [(1, 1, b"")]
    status = bytes.fromhex("FFFFFD000107005500060426655D")
    assert status_packet(1, 0, bytes.fromhex("060426")) == status
    assert crc16(status[:-2]) == 0x5D65


def test_packets_are_found_in_noise_and_in_pieces() -> None:
    reader, ping = PacketReader(), bytes.fromhex("FFFFFD00010300 01 194E".replace(" ", ""))
    found = []
    for byte in b"\xff\xff\x00\xfd" + ping[:5] + b"\x99" + ping + ping[:-1] + b"\x00" + ping:
        found += list(reader.feed(bytes([byte])))
    assert found == [(1, 1, b"")] * 2


def test_the_official_library_finds_and_reads_the_servo(rig: Rig) -> None:
    assert rig.packets.ping(rig.port, 1)[:2] == (1020, rig.sdk.COMM_SUCCESS)
    assert rig.read(POSITION, 4) == round(0.25 / (2.0 * pi / 4096))


def test_current_mode_turns_amperes_into_torque(rig: Rig) -> None:
    assert rig.write(MODE, 1, 0) == 0
    assert rig.write(ENABLE, 1, 1) == 0
    assert rig.write(GOAL_CURRENT, 2, 300) == 0
    rig.steps(1)
    assert rig.stand_in.torque == pytest.approx([300 * 2.69e-3 * 1.78])
    rig.steps(50)
    assert rig.read(CURRENT, 2) == 300
    assert rig.read(VELOCITY, 4) == pytest.approx(rig.stand_in.plant.velocity(0) / (0.229 * 2 * pi / 60), abs=0.51)
    assert rig.write(GOAL_CURRENT, 2, -300 & 0xFFFF) == 0
    rig.steps(1)
    assert rig.stand_in.torque == pytest.approx([-300 * 2.69e-3 * 1.78])


def test_goals_beyond_the_limit_and_locked_memory_are_refused(rig: Rig) -> None:
    rig.write(MODE, 1, 0)
    rig.write(ENABLE, 1, 1)
    assert rig.write(GOAL_CURRENT, 2, 1200) == LIMIT
    assert rig.write(MODE, 1, 3) == ACCESS
    assert rig.write(CURRENT, 2, 1) == ACCESS


def test_a_new_mode_makes_goal_current_the_limit_and_enabling_keeps_it(rig: Rig) -> None:
    rig.write(GOAL_CURRENT, 2, 500)
    rig.write(MODE, 1, 0)
    assert rig.read(GOAL_CURRENT, 2) == 1193
    rig.write(GOAL_CURRENT, 2, 300)
    rig.write(ENABLE, 1, 1)
    rig.steps(1)
    assert rig.stand_in.torque == pytest.approx([300 * 2.69e-3 * 1.78])


def test_goal_current_bounds_current_based_position_and_no_other_loop(rig: Rig) -> None:
    for mode, bounded in ((5, True), (4, False)):
        rig.write(ENABLE, 1, 0)
        rig.write(MODE, 1, mode)
        rig.write(GOAL_CURRENT, 2, 100)
        rig.write(116, 4, 4000)
        rig.write(ENABLE, 1, 1)
        largest = 0.0
        for _ in range(50):
            rig.steps(1)
            largest = max(largest, abs(rig.stand_in.torque[0]))
        assert (largest <= 100 * 2.69e-3 * 1.78 + 1e-9) is bounded


def test_indirect_data_show_what_their_addresses_name(rig: Rig) -> None:
    assert rig.read(224, 1) == 0
    assert rig.write(168, 2, POSITION) == 0
    assert rig.write(170, 2, POSITION + 1) == 0
    assert rig.read(224, 2) == rig.read(POSITION, 4) & 0xFFFF
    rig.twin.power_cycle()
    assert rig.read(224, 2) == 0


def test_bus_watchdog_zeroes_the_goal_and_refuses_goals_until_cleared(rig: Rig) -> None:
    rig.write(MODE, 1, 0)
    rig.write(WATCHDOG, 1, 5)
    rig.write(ENABLE, 1, 1)
    rig.write(GOAL_CURRENT, 2, 200)
    rig.steps(95)
    assert rig.stand_in.torque[0] > 0.9
    rig.steps(10)
    assert rig.stand_in.torque == [0.0]
    assert rig.read(WATCHDOG, 1) == 255
    assert rig.write(GOAL_CURRENT, 2, 200) == RANGE
    assert rig.write(WATCHDOG, 1, 0) == 0
    assert rig.write(GOAL_CURRENT, 2, 200) == 0


def test_bus_watchdog_is_fed_by_reads(rig: Rig) -> None:
    rig.write(MODE, 1, 0)
    rig.write(WATCHDOG, 1, 5)
    rig.write(ENABLE, 1, 1)
    rig.write(GOAL_CURRENT, 2, 200)
    for _ in range(4):
        rig.steps(50)
        rig.read(POSITION, 4)
    assert rig.stand_in.torque[0] > 0.9


def test_a_hardware_error_needs_a_reboot(rig: Rig) -> None:
    rig.write(MODE, 1, 0)
    rig.write(ENABLE, 1, 1)
    rig.servo.fail()
    assert rig.read(ENABLE, 1) == 0
    assert rig.read(ERROR, 1) == 0x20
    assert rig.write(ENABLE, 1, 1) == ACCESS
    assert rig.packets.reboot(rig.port, 1)[0] == rig.sdk.COMM_SUCCESS
    assert rig.read(ERROR, 1) == 0
    assert rig.read(MODE, 1) == 0, "the EEPROM keeps its contents"
    assert rig.write(ENABLE, 1, 1) == 0


def test_group_access_reads_and_writes_several_items(rig: Rig) -> None:
    rig.write(MODE, 1, 0)
    rig.write(ENABLE, 1, 1)
    writer = rig.sdk.GroupSyncWrite(rig.port, rig.packets, GOAL_CURRENT, 2)
    writer.addParam(1, [100, 0])
    assert writer.txPacket() == rig.sdk.COMM_SUCCESS
    reader = rig.sdk.GroupSyncRead(rig.port, rig.packets, CURRENT, 10)
    reader.addParam(1)
    assert reader.txRxPacket() == rig.sdk.COMM_SUCCESS
    rig.steps(2)
    assert rig.stand_in.torque == pytest.approx([100 * 2.69e-3 * 1.78])
    assert reader.getData(1, POSITION, 4) == round(0.25 / (2.0 * pi / 4096))


def test_position_mode_reaches_its_goal(rig: Rig) -> None:
    rig.write(ENABLE, 1, 1)
    rig.write(116, 4, 512)
    rig.steps(1500)
    assert rig.read(POSITION, 4) == pytest.approx(512, abs=1)


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ParameterError, match="operating_mode"):
        DynamixelSettings(operating_mode=2)


def test_a_fast_sync_read_is_answered_as_the_manual_says() -> None:
    """Three positions in one packet, e-manual of protocol 2.0: without stuffing, with the CRC so far of each."""
    parts = [(3, 0, bytes.fromhex("a6000000")), (7, 0, bytes.fromhex("1f080000")), (4, 0, bytes.fromhex("ff030000"))]
    packet = fast_status(parts)
    assert packet[:16] == bytes.fromhex("fffffd00fe19005500 03a60000008408".replace(" ", ""))
    assert packet[16:24] == bytes.fromhex("00071f08000016ca")
    assert packet[24:30] == bytes.fromhex("0004ff030000")
    assert packet[4:7] == bytes((0xFE, len(packet) - 7, 0))
    assert b"\xff\xff\xfd\xff" in fast_status([(1, 0, b"\xff\xff\xfd\xff")])


def test_the_official_library_reads_fast(rig: Rig) -> None:
    reader = rig.sdk.GroupSyncRead(rig.port, rig.packets, CURRENT, 10)
    reader.addParam(1)
    assert reader.fastSyncRead() == rig.sdk.COMM_SUCCESS
    assert reader.getData(1, POSITION, 4) == round(0.25 / (2.0 * pi / 4096))
    bulk = rig.sdk.GroupBulkRead(rig.port, rig.packets)
    bulk.addParam(1, POSITION, 4)
    assert bulk.fastBulkRead() == rig.sdk.COMM_SUCCESS
    assert bulk.getData(1, POSITION, 4) == round(0.25 / (2.0 * pi / 4096))


def test_bulk_and_broadcast_writes_are_obeyed_and_not_answered(rig: Rig) -> None:
    rig.write(MODE, 1, 0)
    bulk = rig.sdk.GroupBulkWrite(rig.port, rig.packets)
    bulk.addParam(1, GOAL_CURRENT, 2, [100, 0])
    assert bulk.txPacket() == rig.sdk.COMM_SUCCESS
    assert rig.packets.write1ByteTxOnly(rig.port, 0xFE, ENABLE, 1) == rig.sdk.COMM_SUCCESS
    assert rig.read(ENABLE, 1) == 1  # the first answer that comes is to this
    assert rig.read(GOAL_CURRENT, 2) == 100
    assert rig.packets.write1ByteTxOnly(rig.port, 0xFE, MODE, 3) == rig.sdk.COMM_SUCCESS
    assert rig.read(MODE, 1) == 0, "the EEPROM is locked while the torque is on, for everybody"


def test_a_new_id_is_used_from_the_next_packet_on_and_kept(rig: Rig) -> None:
    assert rig.write(7, 1, 9) == 0  # answered under the old one
    assert rig.packets.ping(rig.port, 9)[:2] == (1020, rig.sdk.COMM_SUCCESS)
    rig.twin.power_cycle()
    assert rig.servo.identifier == 9


def test_an_id_is_not_changed_while_the_torque_is_on(rig: Rig) -> None:
    rig.write(ENABLE, 1, 1)
    assert rig.write(7, 1, 9) == ACCESS
    assert rig.servo.identifier == 1


@pytest.mark.parametrize(("option", "identifier"), [(0xFF, 1), (1, 9), (2, 9)])
def test_a_factory_reset_keeps_what_it_says(rig: Rig, option: int, identifier: int) -> None:
    rig.write(7, 1, 9)
    rig.servo.write(MODE, b"\0")
    assert rig.packets.factoryReset(rig.port, 9, option)[0] == rig.sdk.COMM_SUCCESS
    assert rig.servo.identifier == identifier
    assert rig.servo.table[MODE] == 3
    assert not rig.stand_in.servos[0].enabled


def test_a_factory_reset_of_all_servos_at_once_is_not_carried_out(rig: Rig) -> None:
    rig.write(7, 1, 9)
    rig.twin._broadcast(6, b"\xff")
    assert rig.servo.identifier == 9
    assert rig.servo.reset(7) == RANGE


def test_turns_are_cleared_at_standstill_only(rig: Rig) -> None:
    rig.servo._turns = -2  # as after two turns backwards
    rig.write(MODE, 1, 4)
    rig.write(116, 4, 2 * 4096 + 1000)
    rig.write(ENABLE, 1, 1)
    rig.steps(100)
    assert rig.packets.clearMultiTurn(rig.port, 1)[1] & 0x7F == 1  # it moves
    rig.steps(2000)
    assert rig.read(POSITION, 4) == pytest.approx(2 * 4096 + 1000, abs=1)
    rig.write(ENABLE, 1, 0)
    rig.steps(500)
    assert rig.packets.clearMultiTurn(rig.port, 1)[0] == rig.sdk.COMM_SUCCESS
    assert rig.read(POSITION, 4) == pytest.approx(1000, abs=2)


def test_the_position_goes_on_at_the_other_end_of_its_32_bits(rig: Rig) -> None:
    rig.servo._turns = -(2**31) // 4096
    shown = rig.read(POSITION, 4)
    assert shown == 2**31 + round(0.25 / (2.0 * pi / 4096))  # the library reads it without its sign

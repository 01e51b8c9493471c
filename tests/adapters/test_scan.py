"""Looking for drives: every protocol's twin is found by reading alone, and one that somebody holds is shown as held."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import can
import pytest

from fricomp.adapters.asking import FoundDrive
from fricomp.adapters.link import CanFrame
from fricomp.adapters.moteus.codec import encode_command
from fricomp.adapters.scan import find_on_can, find_on_serial, is_slcan
from fricomp.sim_bench.twins import DriveTwin, TwinClock
from fricomp.sim_bench.twins.can_twin import CanTwin
from fricomp.sim_bench.twins.configuration import make_twin
from fricomp.sim_bench.twins.dynamixel.packet import PacketReader
from fricomp.sim_bench.twins.memory import MemoryCanLine, MemorySerialLine
from fricomp.sim_bench.twins.moteus.frame import Write, parse_frame
from fricomp.sim_bench.twins.slcan import SlcanPort

BAUDRATE = 1_000_000
TWO = {"sim": {"model": "two_link_arm"}}
CAN_TABLES: dict[str, dict[str, Any]] = {
    "canopen": {"drives": [{"node_id": 1}, {"node_id": 127}]},
    "mit": {"drives": [{"receive_id": 1}, {"receive_id": 0x7F, "feedback_id": 0x20}]},
    "cybergear": {"drives": [{"dialect": "cybergear", "motor_id": 1}, {"dialect": "cybergear", "motor_id": 0x7F}]},
    "odrive": {"drives": [{"node": 0}, {"node": 62}]},
    "odrive 0.5": {"drives": [{"node": 0, "firmware": 5}, {"node": 62, "firmware": 5}]},
}
SERIAL_TABLES: dict[str, dict[str, Any]] = {
    "dynamixel": {"drives": [{"identifier": 0}, {"identifier": 252}]},
    "moteus": {"drives": [{"identifier": 1}, {"identifier": 126}]},
}
ADDRESSES = {
    "canopen": [1, 127],
    "cybergear": [1, 127],
    "dynamixel": [0, 252],
    "mit": [1, 127],
    "moteus": [1, 126],
    "odrive": [0, 62],
    "odrive 0.5": [0, 62],
}
PROTOCOL = {"cybergear": "mit", "odrive 0.5": "odrive"}


def enable_cia402(drive: Any) -> None:
    drive.on_object_written(0x6060, 0, 10)
    for word in (6, 7, 15):
        drive.on_object_written(0x6040, 0, word)


def enable_odrive(node: Any) -> None:
    identifier = node.settings.node << 5 | 7
    node.receive(can.Message(arbitration_id=identifier, data=bytes((8, 0, 0, 0)), is_extended_id=False))


ENERGISE: dict[str, Callable[[Any], object]] = {
    "canopen": enable_cia402,
    "dynamixel": lambda servo: servo.write(64, b"\x01"),
    "mit": lambda motor: motor._command(0xFC),
    "moteus": lambda controller: controller.frame(encode_command("torque", 0.0, 0.0, 1.0, 60.0)),
    "odrive": enable_odrive,
}
"""What somebody else does to the second drive."""


class Wire:
    """A link that remembers what was sent."""

    def __init__(self, link: Any) -> None:
        self._link, self.sent = link, list[Any]()

    def send(self, traffic: Any) -> None:
        self.sent += [traffic] if isinstance(traffic, bytes) else traffic
        self._link.send(traffic)

    def receive(self) -> Any:
        return self._link.receive()


def make(name: str) -> tuple[DriveTwin, Wire]:
    protocol = PROTOCOL.get(name, name)
    line: Any = MemoryCanLine() if name in CAN_TABLES else MemorySerialLine()
    twin = make_twin(protocol, (CAN_TABLES | SERIAL_TABLES)[name] | TWO, line)
    line.on_sent = twin.pump
    return twin, Wire(line.link)


def scan(name: str, twin: DriveTwin, wire: Any) -> list[FoundDrive]:
    if name in CAN_TABLES:
        return find_on_can(wire, TwinClock(twin))
    return find_on_serial(wire, TwinClock(twin), BAUDRATE)


@pytest.mark.parametrize("name", sorted(ADDRESSES))
def test_every_drive_is_found_and_none_of_them_is_energised(name: str) -> None:
    twin, wire = make(name)
    found = scan(name, twin, wire)
    assert [(drive.protocol, drive.address) for drive in found] == [
        (PROTOCOL.get(name, name), address) for address in ADDRESSES[name]
    ]
    told = None if name == "cybergear" else False  # it tells its state to commands alone
    assert [drive.energised for drive in found] == [told, told]


@pytest.mark.parametrize("name", sorted(ENERGISE))
def test_a_drive_that_somebody_holds_is_shown_as_held_and_goes_on(name: str) -> None:
    twin, wire = make(name)
    drive = twin.drives[1]
    ENERGISE[name](drive)
    assert twin.stand_in.servos[1].enabled
    found = scan(name, twin, wire)
    assert [each.energised for each in found] == [False, True]
    assert twin.stand_in.servos[1].enabled


def is_question(traffic: Any) -> bool:
    """Whether a frame or some bytes can only read, on any of the protocols."""
    if isinstance(traffic, CanFrame):
        if traffic.extended:
            return traffic.identifier >> 24 == 17
        if traffic.identifier == 0x7FF:
            return traffic.data[2] in (0x33, 0xCC)
        return 0x600 < traffic.identifier < 0x680 and traffic.data[0] >> 5 == 2
    packets = list(PacketReader().feed(traffic))
    if packets:
        return all(packet[1] in (0x01, 0x02) for packet in packets)
    words = traffic.split()
    return words[:2] == [b"can", b"send"] and not any(
        isinstance(part, Write) for part in parse_frame(bytes.fromhex(words[3].decode()))
    )


@pytest.mark.parametrize("name", sorted(ADDRESSES))
def test_nothing_is_sent_but_questions(name: str) -> None:
    twin, wire = make(name)
    scan(name, twin, wire)
    assert all(map(is_question, wire.sent))
    assert bool(wire.sent) is (PROTOCOL.get(name, name) != "odrive")  # whose heartbeats tell all


def test_on_a_bus_with_odrives_nothing_is_sent_to_the_drives_of_others() -> None:
    """A question to CANopen's node 2 has the identifier of an emergency stop of ODrive's axis 48."""
    twin, wire = make("odrive")
    other, _ = make("canopen")
    assert isinstance(twin, CanTwin)
    assert isinstance(other, CanTwin)
    assert {drive.protocol for drive in scan("odrive", twin, wire)} == {"odrive"}
    assert wire.sent == []


def test_commands_to_an_mit_motor_are_no_heartbeats_of_an_odrive() -> None:
    twin, wire = make("mit")
    command = CanFrame(1, bytes.fromhex("7fff7ff0080007ff"))
    receive = wire.receive
    wire.receive = lambda: [command, *receive()]  # type: ignore[method-assign]
    assert {drive.protocol for drive in scan("mit", twin, wire)} == {"mit"}


def test_a_damiao_tells_what_its_configuration_needs() -> None:
    twin, wire = make("mit")
    assert scan("mit", twin, wire)[1].what == "Damiao, feedback_id 0x20, ranges [12.5, 30, 10]"


def test_a_node_that_nmt_has_stopped_is_heard() -> None:
    twin, wire = make("canopen")
    assert isinstance(twin, CanTwin)
    node: Any = twin.drives[0]
    node.store(0x1017, 0, 50)
    node._node.nmt._state = 4
    receive = wire.receive
    wire.receive = lambda: [CanFrame(0x701, b"\x04"), *receive()]  # type: ignore[method-assign]
    found = scan("canopen", twin, wire)
    assert found[0] == FoundDrive("canopen", 1, "CANopen node that answers nothing (stopped)", None)


def test_an_slcan_adapter_tells_what_it_is_and_stays_as_it_was() -> None:
    line = MemorySerialLine()
    port = SlcanPort(line)
    line.on_sent = lambda: [port.recv() for _ in range(4)]
    assert is_slcan(line.link, TwinClock(make("moteus")[0]), BAUDRATE)
    assert not port.is_open


@pytest.mark.parametrize("name", sorted(SERIAL_TABLES))
def test_drives_are_no_slcan_adapters(name: str) -> None:
    twin, wire = make(name)
    assert not is_slcan(wire, TwinClock(twin), BAUDRATE)  # type: ignore[arg-type]
    assert scan(name, twin, wire)  # and the question leaves nothing behind

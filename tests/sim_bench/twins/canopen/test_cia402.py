"""The CiA 402 drive, driven by the canopen package as an independent master."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from math import pi
from typing import Any

import canopen
import pytest
from canopen.sdo.exceptions import SdoAbortedError

from fricomp.errors import ParameterError
from fricomp.sim_bench.twins import TwinServer
from fricomp.sim_bench.twins.canopen.cia402 import Cia402Drive, Cia402Settings
from fricomp.sim_bench.twins.canopen.cia402_state import DriveState
from fricomp.sim_bench.twins.canopen.node import EDS

from ..rig import CanRig, can_rig, fresh_channel, wait_for

INCREMENTS = 2**18 / (2.0 * pi)
MASTER = 0x7F
SHUTDOWN, SWITCH_ON, ENABLE, DISABLE_VOLTAGE, QUICK_STOP, FAULT_RESET = 0x06, 0x07, 0x0F, 0x00, 0x02, 0x80


class Master:
    """A node of the canopen package, and process data sent by hand in lock step with the drive."""

    def __init__(self, rig: CanRig) -> None:
        self.rig = rig
        self.network = canopen.Network()
        self.network.NOTIFIER_CYCLE = 0.02  # how long it takes to disconnect
        self.network.connect(interface="virtual", channel=rig.channel)
        self.node: Any = self.network.add_node(canopen.RemoteNode(5, str(EDS)))
        self.node.sdo.RESPONSE_TIMEOUT = 5.0  # a busy machine takes longer than the 0.3 s it comes with

    def close(self) -> None:
        self.network.disconnect()

    def map_process_data(self) -> None:
        """RPDO 1: controlword, torque, offset; TPDO 1: statusword, position, torque; both on SYNC."""
        node = self.node
        node.rpdo.read()
        node.tpdo.read()
        for pdo, objects in ((node.rpdo[1], (0x6040, 0x6071, 0x60B2)), (node.tpdo[1], (0x6041, 0x6064, 0x6077))):
            pdo.clear()
            for index in objects:
                pdo.add_variable(index)
            pdo.trans_type, pdo.enabled = 1, True
            pdo.save()

    def operate(self, mode: int = 10, *, heartbeat_ms: int = 0) -> None:
        """From power-on to OPERATION ENABLED."""
        self.map_process_data()
        self.node.sdo[0x6060].raw = mode
        assert self.node.sdo[0x6061].raw == mode
        if heartbeat_ms:
            self.node.sdo[0x1016][1].raw = MASTER << 16 | heartbeat_ms
        self.node.nmt.state = "OPERATIONAL"
        wait_for(lambda: drive(self.rig).is_operational)
        for word in (SHUTDOWN, SWITCH_ON, ENABLE):
            self.cycle(word)
        assert drive(self.rig).state is DriveState.OPERATION_ENABLED

    def cycle(self, word: int = ENABLE, torque: int = 0, offset: int = 0, *, alive: bool = True) -> None:
        """One period: command, SYNC, heartbeat."""
        rig = self.rig
        rig.send(0x205, struct.pack("<Hhh", word, torque, offset))
        rig.send(0x080)
        if alive:
            rig.send(0x700 + MASTER, b"\x05")
        rig.steps(1)

    def reported(self) -> tuple[int, int, int]:
        """Statusword, position and torque of the newest TPDO."""
        frames = [data for identifier, data in self.rig.received() if identifier == 0x185]
        status, position, torque = struct.unpack("<Hih", frames[-1])
        return status, position, torque


def drive(rig: CanRig) -> Cia402Drive:
    (device,) = rig.twin.drives
    assert isinstance(device, Cia402Drive)
    return device


@pytest.fixture
def rig() -> Iterator[CanRig]:
    with can_rig(lambda axis: Cia402Drive(axis, Cia402Settings(node_id=5)), fresh_channel()) as made:
        with TwinServer(made.twin) as server:
            yield made
        assert server.error is None


@pytest.fixture
def master(rig: CanRig) -> Iterator[Master]:
    made = Master(rig)
    yield made
    made.close()


def test_scaling_is_read_from_the_drive(master: Master) -> None:
    sdo = master.node.sdo
    assert sdo[0x6076].raw == 1000
    assert sdo[0x6072].raw == 5000
    assert sdo[0x608F][1].raw / sdo[0x608F][2].raw == 2**18
    assert sdo[0x6091][1].raw / sdo[0x6091][2].raw == 1.0
    assert sdo[0x6064].raw == round(0.25 * INCREMENTS)
    assert sdo[0x6502].raw == 0x380


def test_cyclic_torque_and_its_offset_are_thousandths_of_the_rated_torque(master: Master, rig: CanRig) -> None:
    master.operate()
    master.cycle(torque=700, offset=250)
    assert rig.stand_in.torque == pytest.approx([0.95])
    master.cycle(torque=7000)
    assert rig.stand_in.torque == pytest.approx([5.0])
    master.cycle(torque=-7000)
    status, position, _ = master.reported()
    assert status == 0x1237
    assert position == pytest.approx(rig.stand_in.plant.position(0) * INCREMENTS, abs=200)


def test_cyclic_velocity_slides_in_increments_per_second(master: Master, rig: CanRig) -> None:
    master.operate(mode=9)
    for _ in range(1500):
        drive(rig).on_object_written(0x60FF, 0, round(0.2 * INCREMENTS))
        master.cycle()
    assert rig.stand_in.plant.velocity(0) == pytest.approx(0.2, rel=0.02)


def test_process_data_take_effect_on_sync_only_and_in_operational_only(master: Master, rig: CanRig) -> None:
    master.operate()
    rig.send(0x205, struct.pack("<Hhh", ENABLE, 800, 0))
    rig.steps(2)
    assert rig.stand_in.torque == [0.0]
    rig.send(0x080)
    rig.steps(1)
    assert rig.stand_in.torque == pytest.approx([0.8])
    master.node.nmt.state = "PRE-OPERATIONAL"
    wait_for(lambda: not drive(rig).is_operational)
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    assert drive(rig).state is DriveState.FAULT


TABLE = [
    (DriveState.SWITCH_ON_DISABLED, ENABLE, DriveState.SWITCH_ON_DISABLED),
    (DriveState.SWITCH_ON_DISABLED, SHUTDOWN, DriveState.READY_TO_SWITCH_ON),
    (DriveState.READY_TO_SWITCH_ON, QUICK_STOP, DriveState.SWITCH_ON_DISABLED),
    (DriveState.SWITCHED_ON, SHUTDOWN, DriveState.READY_TO_SWITCH_ON),
    (DriveState.SWITCHED_ON, DISABLE_VOLTAGE, DriveState.SWITCH_ON_DISABLED),
    (DriveState.OPERATION_ENABLED, SWITCH_ON, DriveState.SWITCHED_ON),
    (DriveState.OPERATION_ENABLED, SHUTDOWN, DriveState.READY_TO_SWITCH_ON),
    (DriveState.OPERATION_ENABLED, QUICK_STOP, DriveState.QUICK_STOP_ACTIVE),
    (DriveState.QUICK_STOP_ACTIVE, DISABLE_VOLTAGE, DriveState.SWITCH_ON_DISABLED),
    (DriveState.FAULT, ENABLE, DriveState.FAULT),
    (DriveState.FAULT, FAULT_RESET, DriveState.SWITCH_ON_DISABLED),
]


@pytest.mark.parametrize(("state", "word", "after"), TABLE, ids=lambda value: getattr(value, "name", None))
def test_the_state_machine_is_the_profiles(state: DriveState, word: int, after: DriveState, rig: CanRig) -> None:
    device = drive(rig)
    device._set_mode(10)
    device._enter(state)
    device.on_object_written(0x6040, 0, word)
    assert device.state is after
    assert device.axis.energised == (after in (DriveState.OPERATION_ENABLED, DriveState.QUICK_STOP_ACTIVE))


def test_a_fault_reset_needs_a_rising_edge(rig: CanRig) -> None:
    device = drive(rig)
    device.on_object_written(0x6040, 0, FAULT_RESET)
    device.fail(0x2310)
    states = []
    for word in (FAULT_RESET, 0, FAULT_RESET):
        device.on_object_written(0x6040, 0, word)
        states.append(device.state)
    assert states == [DriveState.FAULT, DriveState.FAULT, DriveState.SWITCH_ON_DISABLED]


@pytest.mark.parametrize(
    ("option", "state"),
    [(1, DriveState.FAULT), (2, DriveState.SWITCH_ON_DISABLED), (0, DriveState.OPERATION_ENABLED)],
)
def test_a_lost_master_heartbeat_does_what_6007_says(
    master: Master, rig: CanRig, option: int, state: DriveState
) -> None:
    master.node.sdo[0x6007].raw = option
    master.operate(heartbeat_ms=50)
    for _ in range(49):
        master.cycle(torque=900, alive=False)
    assert rig.stand_in.torque == pytest.approx([0.9])
    master.cycle(torque=900, alive=False)
    master.cycle(torque=900, alive=False)
    rig.steps(1)
    assert drive(rig).state is state
    assert rig.stand_in.torque == pytest.approx([0.9 if option == 0 else 0.0])
    wait_for(lambda: bool(master.node.emcy.log))
    assert master.node.emcy.log[-1].code == 0x8130
    assert master.node.sdo[0x1003][1].raw == 0x8130


def test_a_quick_stop_brakes_and_then_lets_go(master: Master, rig: CanRig) -> None:
    master.operate()
    for _ in range(150):
        master.cycle(torque=1500)
    assert rig.stand_in.plant.velocity(0) > 1.0
    for _ in range(5):
        master.cycle(word=QUICK_STOP)
    assert rig.stand_in.torque[0] < 0.0
    rig.steps(300)
    assert drive(rig).state is DriveState.SWITCH_ON_DISABLED
    assert abs(rig.stand_in.plant.velocity(0)) < 0.05


def test_an_unsupported_mode_is_not_displayed(master: Master) -> None:
    master.node.sdo[0x6060].raw = 10
    master.node.sdo[0x6060].raw = 1
    assert master.node.sdo[0x6061].raw == 10


def test_mapping_follows_the_rules_and_abort_codes(master: Master) -> None:
    sdo = master.node.sdo

    def abort(index: int, subindex: int, value: int) -> int:
        with pytest.raises(SdoAbortedError) as refused:
            sdo[index][subindex].raw = value
        return int(refused.value.code)

    assert abort(0x1600, 1, 0x1234_0010) == 0x06040041
    assert abort(0x1600, 1, 0x6040_0008) == 0x06040041
    for entry in (1, 2, 3):
        sdo[0x1600][entry].raw = 0x607A_0020
    assert abort(0x1600, 0, 3) == 0x06040042
    sdo[0x1600][0].raw = 2
    assert abort(0x1600, 1, 0x6040_0010) == 0x08000022
    sdo[0x1400][1].raw = 0x205
    assert abort(0x1600, 0, 0) == 0x08000022


def test_a_reset_node_boots_again_de_energised_and_unmapped(master: Master, rig: CanRig) -> None:
    master.operate()
    master.cycle(torque=900)
    rig.received()
    rig.send(0x000, b"\x81\x05")
    rig.steps(1)
    assert (0x705, b"\x00") in rig.received()
    assert drive(rig).state is DriveState.SWITCH_ON_DISABLED
    assert rig.stand_in.torque == [0.0]
    assert master.node.sdo[0x1600][0].raw == 0


def test_heartbeats_are_sent_in_simulated_time(master: Master, rig: CanRig) -> None:
    master.node.sdo[0x1017].raw = 20
    rig.received()
    rig.steps(100)
    beats = [data for identifier, data in rig.received() if identifier == 0x705]
    assert beats == [b"\x7f"] * 5


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ParameterError, match="node_id"):
        Cia402Settings(node_id=128)

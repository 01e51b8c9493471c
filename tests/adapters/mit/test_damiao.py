"""Damiao motors through the whole conformance suite, and what is special about them."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import pytest
from damiao_motor.core.motor import DaMiaoMotor

from fricomp.adapters import open_adapter
from fricomp.adapters.configuration import convert
from fricomp.adapters.link import CanFrame
from fricomp.adapters.mit import MitAdapter
from fricomp.adapters.mit.configuration import MitConfiguration
from fricomp.errors import AdapterConfigurationError, AdapterError, AdapterTimeout
from fricomp.testing import AdapterRig, GoldenCommand
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, stopped
from tests.adapters.peers.damiao import DamiaoPeer
from tests.adapters.peers.rig import PeerRig, joint_tables

RANGES = (12.5, 30.0, 10.0)


def configuration(**changes: Any) -> dict[str, Any]:
    joints = joint_tables(2, torque=4.0, velocity=20.0, model="damiao/DM4310")
    joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
    joints[1]["limits"]["velocity"] = 10.0
    base = {"bus": {"interface": "virtual"}, "joints": joints, "ramp_time": 0.0}
    return base | changes


class DamiaoRig(PeerRig):
    def __init__(self, **changes: Any) -> None:
        peers = [DamiaoPeer(1, 0x11, RANGES), DamiaoPeer(2, 0x12, RANGES)]
        made = convert(configuration(**changes), MitConfiguration)
        super().__init__(lambda link, clock: MitAdapter(made, link, clock), peers, 4.0, gears=(1.0, -2.0))

    def is_read(self, traffic: CanFrame) -> bool:
        """Reading a register, and asking for the state."""
        return traffic.identifier == 0x7FF and traffic.data[2] in (0x33, 0xCC)

    def golden(self) -> Sequence[GoldenCommand]:
        """Torques whose code `damiao-motor` finds without its truncation mattering."""
        golden = []
        for code in (1300, 2000, 2048, 2800):
            torque = -10.0 + 20.0 * (code + 1e-6) / 4095.0
            if abs(torque) > 4.0:
                continue
            # Zero lies between two codes; a hair above it, truncation and rounding agree on the upper one.
            position, velocity = 0.51 * 25.0 / 65535.0, 0.51 * 60.0 / 4095.0
            wire = DaMiaoMotor(1, 0x11, None, motor_type="4310").encode_cmd_msg(position, velocity, torque, 0.0, 0.0)
            golden.append(GoldenCommand((torque, 0.0), CanFrame(1, wire)))
        return golden


class Forgetful(dict[int, Any]):
    """Registers of a motor that does not keep its watchdog."""

    def __setitem__(self, number: int, value: Any) -> None:
        if number != 9:
            super().__setitem__(number, value)


class TestDamiaoConforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return DamiaoRig()


def opened_rig(**changes: Any) -> DamiaoRig:
    rig = DamiaoRig(**changes)
    rig.adapter.open()
    return rig


@pytest.mark.parametrize(("register", "name"), [(21, "position"), (22, "velocity"), (23, "torque")])
def test_a_range_that_is_not_the_motors_own_is_refused(register: int, name: str) -> None:
    rig = DamiaoRig()
    peer = rig.peers[1]
    assert isinstance(peer, DamiaoPeer)
    peer.registers[register] = struct.pack("<f", 7.5)
    with pytest.raises(AdapterConfigurationError, match=f"{name} range is 7.5"):
        rig.adapter.open()


def test_a_motor_that_is_not_there_is_named() -> None:
    rig = DamiaoRig()
    peer = rig.peers[1]
    assert isinstance(peer, DamiaoPeer)
    peer.address = 9
    with pytest.raises(AdapterTimeout, match="joint 1"):
        rig.adapter.open()


def test_two_motors_on_one_feedback_id_are_refused_by_name() -> None:
    table = configuration()
    for joint in table["joints"]:
        joint["feedback_id"] = 0x11
    with pytest.raises(AdapterConfigurationError, match="joints 'joint 0', 'joint 1' have one feedback_id, 0x11"):
        MitAdapter(convert(table, MitConfiguration))


def test_the_watchdog_is_written_in_counts_of_50_microseconds() -> None:
    rig = opened_rig(watchdog=0.04)
    rig.adapter.configure("torque", 0.002)
    for peer in rig.peers:
        assert isinstance(peer, DamiaoPeer)
        assert struct.unpack("<I", peer.registers[9])[0] == 800


def test_a_motor_that_was_power_cycled_gets_mode_and_watchdog_again_before_it_is_energised() -> None:
    rig = opened_rig(watchdog=0.04)
    rig.adapter.configure("torque", 0.002)
    rig.power_cycle(1)
    peer = rig.peers[1]
    assert isinstance(peer, DamiaoPeer)
    assert struct.unpack("<I", peer.registers[9])[0] == 0
    rig.adapter.enable()
    assert (struct.unpack("<I", peer.registers[9])[0], struct.unpack("<I", peer.registers[10])[0]) == (800, 1)
    assert all(rig.energised())


def test_seven_motors_at_one_megabit_fit_529_times_a_second() -> None:
    tables = joint_tables(7, torque=4.0, velocity=20.0, model="damiao/DM4310")
    made = convert({"bus": {"interface": "virtual"}, "joints": tables}, MitConfiguration)
    assert MitAdapter(made)._highest_rate() == pytest.approx(529.0, abs=0.2)


def test_a_state_at_the_edge_of_its_code_stops_the_joints() -> None:
    rig = opened_rig()
    rig.adapter.configure("torque", 0.002)
    rig.adapter.enable()
    rig.peers[0].position = 20.0
    run(rig, 3)
    assert stopped(rig)


def test_unknown_keys_and_models_are_refused_by_name() -> None:
    with pytest.raises(AdapterConfigurationError, match="wachdog"):
        open_adapter("mit", configuration(wachdog=0.1))
    bad = configuration()
    bad["joints"][0]["model"] = "damiao/DM9999"
    with pytest.raises(AdapterConfigurationError, match=r"DM9999.*DM4310"):
        open_adapter("mit", bad)


def test_a_motor_that_keeps_no_watchdog_takes_none_from_the_others() -> None:
    rig = opened_rig(allow_no_watchdog=True)
    forgetful, other = rig.peers
    assert isinstance(forgetful, DamiaoPeer)
    assert isinstance(other, DamiaoPeer)
    forgetful.registers = Forgetful(forgetful.registers)
    rig.adapter.configure("torque", 0.002)
    watchdog = rig.adapter.capabilities.watchdog
    assert watchdog is not None
    assert not watchdog.confirmed
    assert struct.unpack("<I", other.registers[9])[0] == 2000
    rig.power_cycle(1)
    rig.adapter.enable()
    assert struct.unpack("<I", other.registers[9])[0] == 2000


def test_a_motor_without_watchdog_needs_the_users_word() -> None:
    tables = joint_tables(1, torque=4.0, velocity=20.0, model="tmotor/AK80-9")
    made = convert({"bus": {"interface": "virtual"}, "joints": tables}, MitConfiguration)
    assert MitAdapter(made)._set_watchdogs() is None
    with pytest.raises(AdapterError):
        MitAdapter(made).configure("torque", 0.002)

"""The ODrive node: frames through the vendor's DBC (cantools), and odrive-can as an independent master."""

from __future__ import annotations

import asyncio
import json
import struct
from collections.abc import Iterator
from math import pi
from pathlib import Path
from typing import Any

import can
import pytest

from fricomp.errors import ParameterError
from fricomp.sim_bench.twins import TwinServer
from fricomp.sim_bench.twins.odrive import AxisState, ODriveNode, ODriveSettings, flat_endpoints

from .rig import CanRig, can_rig, fresh_channel

TURN = 2.0 * pi


@pytest.fixture
def rig() -> Iterator[CanRig]:
    settings = ODriveSettings(node=3, heartbeat_period=0.0, encoder_period=0.0)
    with can_rig(lambda axis: ODriveNode(axis, settings)) as made:
        yield made


def node(rig: CanRig) -> ODriveNode:
    (device,) = rig.twin.drives
    assert isinstance(device, ODriveNode)
    return device


def order(rig: CanRig, command: int, data: bytes) -> None:
    rig.send(3 << 5 | command, data)
    rig.twin.pump()


def close_loop(rig: CanRig, control_mode: int) -> None:
    order(rig, 0x0B, struct.pack("<II", control_mode, 1))
    order(rig, 0x07, struct.pack("<I", 8))
    assert node(rig).state == AxisState.CLOSED_LOOP_CONTROL


def test_torque_mode_applies_the_commanded_torque_in_closed_loop_only(rig: CanRig) -> None:
    order(rig, 0x0B, struct.pack("<II", 1, 1))
    order(rig, 0x0E, struct.pack("<f", 1.5))
    rig.steps(2)
    assert rig.stand_in.torque == [0.0]
    order(rig, 0x07, struct.pack("<I", 8))
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    order(rig, 0x0E, struct.pack("<f", 1.5))
    rig.steps(1)
    assert rig.stand_in.torque == [1.5]
    order(rig, 0x07, struct.pack("<I", 1))
    rig.steps(1)
    assert rig.stand_in.torque == [0.0]


def test_velocity_is_in_turns_and_torque_feed_forward_counts_in_passthrough_only(rig: CanRig) -> None:
    close_loop(rig, 2)
    for _ in range(1500):
        order(rig, 0x0D, struct.pack("<ff", 0.02, 0.0))
        rig.steps(1)
    assert rig.stand_in.plant.velocity(0) == pytest.approx(0.02 * TURN, rel=0.02)
    order(rig, 0x0B, struct.pack("<II", 2, 2))
    before = node(rig)._setpoint
    order(rig, 0x0D, struct.pack("<ff", 0.02, 1.0))
    assert (before, node(rig)._setpoint) == (0.0, 0.0)


def test_position_feed_forwards_are_thousandths(rig: CanRig) -> None:
    close_loop(rig, 3)
    order(rig, 0x0C, struct.pack("<fhh", 0.25 / TURN, 0, 1500))
    rig.steps(1)
    assert rig.stand_in.torque[0] == pytest.approx(1.5, abs=1e-3)


def test_reports_are_sent_on_request(rig: CanRig) -> None:
    ((identifier, data),) = rig.ask(3 << 5 | 0x09, remote=True)
    assert identifier == 3 << 5 | 0x09
    assert struct.unpack("<ff", data) == pytest.approx((0.25 / TURN, 0.0))
    assert rig.ask(2 << 5 | 0x09, remote=True) == [], "another node's"


def test_watchdog_of_0_6_is_fed_by_set_points_and_not_by_reads(rig: CanRig) -> None:
    order(rig, 0x04, struct.pack("<BHBf", 1, 2, 0, 0.05))
    order(rig, 0x04, struct.pack("<BHB?3x", 1, 1, 0, True))
    close_loop(rig, 1)
    order(rig, 0x0E, struct.pack("<f", 1.0))
    for _ in range(55):
        rig.ask(3 << 5 | 0x09, remote=True)
        rig.steps(1)
    assert rig.stand_in.torque == [0.0]
    assert node(rig).errors == 0x01000000
    order(rig, 0x07, struct.pack("<I", 8))
    assert node(rig).state == AxisState.IDLE, "errors must be cleared first"
    order(rig, 0x18, b"\0")
    order(rig, 0x07, struct.pack("<I", 8))
    assert node(rig).state == AxisState.CLOSED_LOOP_CONTROL


def test_watchdog_of_0_5_is_fed_by_reads_too() -> None:
    settings = ODriveSettings(node=3, firmware=5, watchdog=0.05, heartbeat_period=0.0, encoder_period=0.0)
    with can_rig(lambda axis: ODriveNode(axis, settings)) as rig:
        close_loop(rig, 1)
        order(rig, 0x0E, struct.pack("<f", 1.0))
        for _ in range(100):
            rig.ask(3 << 5 | 0x09, remote=True)
            rig.steps(1)
        assert rig.stand_in.torque == [1.0]
        rig.steps(60)
        assert rig.stand_in.torque == [0.0]
        assert node(rig).errors == 0x800


def test_parameters_are_read_and_written_through_endpoints(rig: CanRig, tmp_path: Path) -> None:
    path = tmp_path / "flat_endpoints.json"
    path.write_text(json.dumps(flat_endpoints()))
    table = json.loads(path.read_text())["endpoints"]["axis0.config.watchdog_timeout"]
    assert table["type"] == "float"
    order(rig, 0x04, struct.pack("<BHBf", 1, table["id"], 0, 0.125))
    ((identifier, data),) = rig.ask(3 << 5 | 0x04, struct.pack("<BHB", 0, table["id"], 0))
    assert identifier == 3 << 5 | 0x05
    assert struct.unpack("<BHBf", data) == (0, table["id"], 0, 0.125)


@pytest.mark.parametrize("value", [float("nan"), float("inf")])
def test_set_points_that_are_not_finite_change_nothing(rig: CanRig, value: float) -> None:
    close_loop(rig, 1)
    order(rig, 0x0E, struct.pack("<f", 0.5))
    order(rig, 0x0E, struct.pack("<f", value))
    rig.steps(1)
    assert rig.stand_in.torque == [0.5]


@pytest.mark.parametrize(("firmware", "name"), [(6, "odrive-cansimple-0.6.10"), (5, "odrive-cansimple-0.5.6")])
def test_heartbeat_and_estimates_decode_with_the_vendors_dbc(firmware: int, name: str) -> None:
    cantools = pytest.importorskip("cantools", reason="cantools is not installed")
    odrive_can = pytest.importorskip("odrive_can", reason="odrive-can is not installed")
    folder = Path(odrive_can.__file__).parent / "dbc"
    dbc: Any = cantools.database.load_file(folder / f"{name}.dbc")
    settings = ODriveSettings(node=0, firmware=firmware, heartbeat_period=0.1, encoder_period=0.01)
    with can_rig(lambda axis: ODriveNode(axis, settings)) as rig:
        data = dbc.get_message_by_name("Axis0_Set_Axis_State").encode({"Axis_Requested_State": 8})
        rig.send(0x07, data)
        rig.steps(201)
        frames = rig.received()
    beats = [dbc.decode_message(i, d) for i, d in frames if i == 0x01]
    estimates = [dbc.decode_message(i, d) for i, d in frames if i == 0x09]
    assert (len(beats), len(estimates)) == (3, 21)
    assert str(beats[-1]["Axis_State"]) == "CLOSED_LOOP_CONTROL"
    assert estimates[-1]["Pos_Estimate"] == pytest.approx(0.25 / TURN)


def test_odrive_can_drives_the_twin_unmodified() -> None:
    odrive_can = pytest.importorskip("odrive_can", reason="odrive-can is not installed")
    channel = fresh_channel()

    async def converse(rig: CanRig) -> None:
        peer = odrive_can.ODriveCAN(axis_id=0, can_bus=can.Bus(interface="virtual", channel=channel))
        await asyncio.wait_for(peer.start(), 5.0)
        peer.check_errors()
        peer._send_message("Set_Controller_Mode", {"Control_Mode": "TORQUE_CONTROL", "Input_Mode": "PASSTHROUGH"})
        peer._send_message("Set_Axis_State", {"Axis_Requested_State": "CLOSED_LOOP_CONTROL"})
        await peer.wait_for_heartbeat()
        await peer.wait_for_heartbeat()
        assert peer.axis_state == "CLOSED_LOOP_CONTROL"
        peer._send_message("Set_Input_Torque", {"Input_Torque": 0.5})
        await peer.wait_for_heartbeat()
        assert rig.stand_in.torque == [0.5]
        estimates = await peer.get_encoder_estimates()
        assert estimates["Pos_Estimate"] == pytest.approx(0.25 / TURN, abs=1e-6)
        peer.stop()

    with can_rig(lambda axis: ODriveNode(axis, ODriveSettings()), channel) as rig:
        with TwinServer(rig.twin, real_time=True) as server:
            asyncio.run(converse(rig))
        assert server.error is None


def test_impossible_settings_are_refused() -> None:
    with pytest.raises(ParameterError, match="firmware must be 5"):
        ODriveSettings(firmware=4)

"""ODrives of both firmware generations through the conformance suite, and what is special about them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from fricomp.adapters.configuration import convert
from fricomp.adapters.link import CanFrame
from fricomp.adapters.odrive import OdriveAdapter
from fricomp.adapters.odrive.codec import input_frame
from fricomp.adapters.odrive.configuration import OdriveConfiguration
from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.testing import AdapterRig, GoldenCommand
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, start
from tests.adapters.peers.odrive import DBC, TORQUE_CONSTANT, OdrivePeer, endpoint_file
from tests.adapters.peers.rig import PeerRig, joint_tables


class OdriveRig(PeerRig):
    def __init__(self, firmware: str, endpoints: Path | None, **changes: Any) -> None:
        joints = joint_tables(2, torque=4.0, velocity=20.0, torque_constant=TORQUE_CONSTANT)
        joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
        table: dict[str, Any] = {"bus": {"interface": "virtual"}, "joints": joints, "ramp_time": 0.0}
        table |= {"firmware": firmware, "allow_no_watchdog": endpoints is None}
        if endpoints is not None:
            table["endpoints"] = str(endpoints)
        made = convert(table | changes, OdriveConfiguration)
        stored = 0.0 if firmware == "0.6" else 0.1
        self.axes = [OdrivePeer(1, firmware, stored), OdrivePeer(2, firmware, stored)]
        super().__init__(lambda link, clock: OdriveAdapter(made, link, clock), self.axes, 4.0, gears=(1.0, -2.0))
        self.firmware = firmware

    def golden(self) -> Sequence[GoldenCommand]:
        message = DBC[self.firmware].get_message_by_name("Axis0_Set_Input_Torque")
        return [
            GoldenCommand((torque, 0.0), CanFrame(1 << 5 | message.frame_id, message.encode({"Input_Torque": torque})))
            for torque in (0.3, -2.71828, 3.999)
        ]


@pytest.fixture
def endpoints(tmp_path: Path) -> Path:
    path = tmp_path / "flat_endpoints.json"
    path.write_text(json.dumps(endpoint_file()))
    return path


class TestOdrive06Conforms(AdapterConformance):
    @pytest.fixture
    def rig(self, endpoints: Path) -> AdapterRig:
        return OdriveRig("0.6", endpoints)


class TestOdrive05Conforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        rig = OdriveRig("0.5", None)
        mute = "CANSimple of firmware 0.5 has no way to ask for it, so enabling needs allow_no_watchdog"
        ends_with_watchdog = "the length of the drive's own watchdog cannot be asked for on firmware 0.5"
        rig.exempt = {
            "test_a_mode_that_the_drive_does_not_take_is_an_error": "firmware 0.5 cannot be asked for its control mode",
            "test_the_watchdog_is_confirmed_before_enabling": mute,
            "test_a_pulled_cable_ends_in_zero_torque_by_the_watchdog": ends_with_watchdog,
            "test_a_dead_loop_ends_in_zero_torque_by_the_watchdog": ends_with_watchdog,
        }
        return rig


def test_without_endpoints_the_watchdog_is_not_confirmed() -> None:
    rig = OdriveRig("0.6", None, allow_no_watchdog=False)
    rig.adapter.open()
    rig.adapter.configure("torque", 0.002)
    with pytest.raises(AdapterError, match="no confirmed watchdog"):
        rig.adapter.enable()


def test_endpoints_of_another_firmware_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "flat_endpoints.json"
    path.write_text(json.dumps(endpoint_file() | {"fw_version": "0.6.8"}))
    with pytest.raises(AdapterConfigurationError, match=r"runs firmware 0\.6\.10"):
        OdriveRig("0.6", path).adapter.open()


def test_a_file_that_is_no_endpoint_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "flat_endpoints.json"
    path.write_text("{}")
    with pytest.raises(AdapterConfigurationError, match="flat_endpoints"):
        OdriveRig("0.6", path)


def test_firmware_05_needs_a_torque_constant() -> None:
    table = {"bus": {"interface": "virtual"}, "joints": joint_tables(1, 4.0, 20.0), "firmware": "0.5"}
    with pytest.raises(AdapterConfigurationError, match="torque_constant"):
        convert(table, OdriveConfiguration)


@pytest.mark.parametrize("mode", ["velocity", "position"])
def test_torque_goes_as_feed_forward_in_passthrough(endpoints: Path, mode: Any) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    rig.adapter.configure(mode, 0.002)
    rig.adapter.enable()
    rig.clock.advance(0.002)
    assert run(rig, 3, torque=1.25)
    assert rig.axes[0].values[401] == 1
    assert rig.axes[0].torque == pytest.approx(1.25)


@pytest.mark.parametrize(("torque", "expected"), [(0.0126, 13), (-0.0126, -13), (99.0, 32767), (-99.0, -32767)])
def test_feed_forward_beside_a_position_is_rounded_to_thousandths_and_saturates(torque: float, expected: int) -> None:
    frame = input_frame(3, "position", torque, 0.0, 0.0)
    assert int.from_bytes(frame.data[6:8], "little", signed=True) == expected


def test_a_slow_heartbeat_does_not_let_the_watchdog_trip_while_enabling(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints, watchdog=0.03)
    rig.adapter.open()
    start(rig)
    assert all(rig.energised())

"""ODrives of both firmware generations through the conformance suite, and what is special about them."""

from __future__ import annotations

import json
import struct
from collections.abc import Sequence
from dataclasses import replace
from math import inf, isnan, nan
from pathlib import Path
from typing import Any, cast

import pytest

from fricomp.adapters.configuration import convert
from fricomp.adapters.link import CanFrame
from fricomp.adapters.odrive import OdriveAdapter
from fricomp.adapters.odrive.codec import input_frame
from fricomp.adapters.odrive.configuration import OdriveConfiguration
from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.testing import AdapterRig, GoldenCommand
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, start
from tests.adapters.peers.odrive import DBC, ENDPOINTS, TORQUE_CONSTANT, OdrivePeer, endpoint_file
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

    def is_read(self, traffic: CanFrame) -> bool:
        """Remote frames, and reading an endpoint."""
        return traffic.remote or (traffic.identifier & 0x1F == 0x04 and traffic.data[0] == 0)

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


@pytest.mark.parametrize(("runs", "configured"), [("0.5", "0.6"), ("0.6", "0.5")])
def test_a_node_of_another_generation_than_configured_is_refused(runs: str, configured: str) -> None:
    rig = OdriveRig(configured, None)
    for axis in rig.axes:
        axis.firmware, axis.dbc = runs, DBC[runs]
    with pytest.raises(AdapterConfigurationError, match=f'node 1 .* write firmware = "{runs}"'):
        rig.adapter.open()


def test_a_file_that_is_no_endpoint_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "flat_endpoints.json"
    path.write_text("{}")
    with pytest.raises(AdapterConfigurationError, match=r"is not a flat_endpoints\.json .* each firmware$"):
        OdriveRig("0.6", path)


def test_endpoints_that_are_not_there_are_called_so(tmp_path: Path) -> None:
    with pytest.raises(AdapterConfigurationError, match=r"cannot read the endpoints .*: No such file"):
        OdriveRig("0.6", tmp_path / "flat.json")


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


@pytest.mark.parametrize("mode", ["velocity", "position"])
def test_the_drives_own_loop_is_bounded_by_the_limit_too(endpoints: Path, mode: Any) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    rig.adapter.configure(mode, 0.002)
    rig.adapter.enable()
    command = JointCommand(2)
    command.velocity[:], command.position[:] = [20.0, -20.0], [3.0, -3.0]
    largest = 0.0
    for _ in range(100):  # blocked joints
        rig.clock.advance(0.002)
        rig.adapter.read_into(JointFeedback(2))
        assert rig.adapter.write(command)
        largest = max(largest, *map(abs, rig.applied_torque()))
    assert largest == pytest.approx(4.0, rel=1e-6)


def test_a_joint_is_held_where_it_is_when_it_is_energised(endpoints: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    rig.adapter.configure("position", 0.002)
    assert isinstance(rig.adapter, OdriveAdapter)
    prepare = rig.adapter._set_watchdog

    def prepare_while_it_falls(joint: int) -> bool:
        rig.move(0, -0.3, 0.0)
        return prepare(joint)

    monkeypatch.setattr(rig.adapter, "_set_watchdog", prepare_while_it_falls)
    rig.adapter.enable()
    assert rig.applied_torque()[0] == pytest.approx(0.0, abs=1e-4)


def test_limits_cut_down_after_opening_count_for_the_drives_own_loop(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    assert isinstance(rig.adapter, OdriveAdapter)
    options = rig.adapter.options
    rig.adapter.options = replace(options, limits=tuple(replace(limit, torque=0.25) for limit in options.limits))
    rig.adapter.configure("velocity", 0.002)
    assert [axis.values[252] for axis in rig.axes] == [0.25, 0.125]


def test_torque_mode_leaves_the_drives_own_limit_alone(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    start(rig)
    assert all((axis.values[251], axis.values[252]) == (-inf, inf) for axis in rig.axes)


@pytest.mark.parametrize(("firmware", "file"), [("0.6", None), ("0.5", None), ("0.6", "lower"), ("0.6", "upper")])
def test_a_loop_that_nothing_bounds_is_not_offered(firmware: str, file: str | None, tmp_path: Path) -> None:
    path = None
    if file is not None:
        path = tmp_path / "flat_endpoints.json"
        path.write_text(json.dumps(endpoint_file(251 if file == "lower" else 252)))
    rig = OdriveRig(firmware, path)
    assert rig.adapter.open().modes == ("torque",)
    for mode in ("velocity", "position"):
        with pytest.raises(AdapterConfigurationError, match="not offered"):
            rig.adapter.configure(cast(Any, mode), 0.002)
    assert isinstance(rig.adapter, OdriveAdapter)
    assert "torque_soft_max" in str(rig.adapter.health()["velocity and position mode"])


@pytest.mark.parametrize("number", [251, 252])
def test_a_drive_that_does_not_keep_the_limit_is_refused(endpoints: Path, number: int) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.axes[1].keeps.remove(number)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match=ENDPOINTS[number][0]):
        rig.adapter.configure("velocity", 0.002)
    rig.adapter.configure("torque", 0.002)


@pytest.mark.parametrize(("number", "value"), [(251, -1.5), (252, 1.5)])
def test_a_limit_beyond_the_drives_own_is_refused_and_not_lifted(endpoints: Path, number: int, value: float) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.axes[1].values[number] = value
    with pytest.raises(AdapterConfigurationError, match=r"joint 1.*beyond the drive's 3"):  # a gear of two
        rig.adapter.open()
    assert rig.axes[1].values[number] == value


def test_a_limit_of_the_drives_that_is_no_number_is_refused(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.axes[0].values[252] = nan
    with pytest.raises(AdapterConfigurationError, match="torque_soft_max"):
        rig.adapter.open()


def test_a_drive_that_was_power_cycled_is_bounded_and_watched_again_before_it_is_energised(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    rig.adapter.configure("velocity", 0.002)
    rig.power_cycle(0)
    assert rig.axes[0].values[252] == inf
    rig.adapter.enable()
    assert (rig.axes[0].values[251], rig.axes[0].values[252]) == (-4.0, 4.0)
    assert rig.axes[0].values[183]
    assert rig.axes[0].values[184] == pytest.approx(0.1)


def test_a_drive_that_no_longer_takes_its_watchdog_is_not_energised(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    rig.adapter.configure("torque", 0.002)
    rig.power_cycle(1)
    rig.axes[1].keeps.remove(183)
    with pytest.raises(AdapterError, match="watchdog"):
        rig.adapter.enable()
    assert not any(rig.energised())


def test_a_watchdog_that_a_second_configuration_does_not_confirm_is_no_confirmed_one(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints)
    rig.adapter.open()
    rig.adapter.configure("torque", 0.002)
    rig.axes[0].keeps.remove(183)
    rig.axes[0].values[183] = False
    rig.adapter.configure("torque", 0.002)
    watchdog = rig.adapter.capabilities.watchdog
    assert watchdog is not None
    assert not watchdog.confirmed
    assert rig.axes[1].values[183]  # the other one has its own all the same
    with pytest.raises(AdapterError, match="no confirmed watchdog"):
        rig.adapter.enable()


@pytest.mark.parametrize(("motor", "expected"), [(40.0, 40.0), (nan, 35.0), (20.0, 35.0)])
def test_a_motor_without_thermistor_does_not_hide_the_inverters_temperature(
    endpoints: Path, motor: float, expected: float
) -> None:
    rig = OdriveRig("0.6", endpoints)
    for axis in rig.axes:
        axis.motor_temperature = motor
    assert all(joint.reports_temperature for joint in rig.adapter.open().joints)
    feedback = JointFeedback(2)
    for _ in range(5):  # at rest already, before anything is enabled
        rig.clock.advance(0.006)
        rig.adapter.read_into(feedback)
    assert feedback.temperature == [expected, expected]


def test_firmware_05_tells_no_temperature_and_no_other_report_is_taken_for_one() -> None:
    rig = OdriveRig("0.5", None)
    assert not any(joint.reports_temperature for joint in rig.adapter.open().joints)
    start(rig)
    rig.axes[0].outbox.append(CanFrame(1 << 5 | 0x15, struct.pack("<ff", 300.0, 300.0)))  # sensorless estimates there
    assert run(rig, 5)
    feedback = JointFeedback(2)
    rig.clock.advance(0.002)
    rig.adapter.read_into(feedback)
    assert all(map(isnan, feedback.temperature))


@pytest.mark.parametrize(("torque", "expected"), [(0.0126, 13), (-0.0126, -13), (99.0, 32767), (-99.0, -32767)])
def test_feed_forward_beside_a_position_is_rounded_to_thousandths_and_saturates(torque: float, expected: int) -> None:
    frame = input_frame(3, "position", torque, 0.0, 0.0)
    assert int.from_bytes(frame.data[6:8], "little", signed=True) == expected


def test_a_slow_heartbeat_does_not_let_the_watchdog_trip_while_enabling(endpoints: Path) -> None:
    rig = OdriveRig("0.6", endpoints, watchdog=0.03)
    rig.adapter.open()
    start(rig)
    assert all(rig.energised())

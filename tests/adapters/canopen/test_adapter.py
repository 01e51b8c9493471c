"""CiA 402 drives through the whole conformance suite, and what is special about them."""

from __future__ import annotations

import struct
from dataclasses import replace
from math import inf, tau
from typing import Any

import pytest

from fricomp.adapters import open_adapter
from fricomp.adapters.canopen.capability import highest_rate
from fricomp.adapters.canopen.configuration import CanOpenConfiguration
from fricomp.adapters.configuration import convert
from fricomp.errors import AdapterConfigurationError, AdapterConnectionError, AdapterError, AdapterTimeout, DriveHeld
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.studies.adapters.bench import make_bench
from fricomp.testing import AdapterRig
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import run, start
from tests.adapters.canopen.rig import CanOpenRig, configuration
from tests.adapters.peers.rig import joint_tables


class TestCanOpenConforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return CanOpenRig()


@pytest.fixture
def rig() -> CanOpenRig:
    made = CanOpenRig()
    made.adapter.open()
    return made


def test_scaling_is_read_from_the_drive(rig: CanOpenRig) -> None:
    joint = rig.adapter.capabilities.joints[0]
    assert joint.torque_quantum == pytest.approx(0.005)
    assert joint.torque_limit == pytest.approx(10.0)
    assert joint.position_quantum == pytest.approx(tau / 65536)
    assert joint.velocity_limit == pytest.approx(6000.0 * tau / 60.0)


def test_a_device_that_is_no_drive_is_refused() -> None:
    rig = CanOpenRig()
    rig.drives[1].store(0x1000, 401)
    with pytest.raises(AdapterConfigurationError, match=r"joint 1.*no CiA 402 drive.*401"):
        rig.adapter.open()


def test_a_drive_that_somebody_else_has_energised_is_left_alone() -> None:
    rig = CanOpenRig()
    rig.drives[0].state = "operation enabled"
    with pytest.raises(DriveHeld, match="somebody else"):
        rig.adapter.open()


def test_a_rated_torque_of_zero_is_refused() -> None:
    rig = CanOpenRig()
    rig.drives[0].store(0x6076, 0)
    with pytest.raises(AdapterConfigurationError, match="6076"):
        rig.adapter.open()


def test_a_node_that_does_not_answer_is_named() -> None:
    rig = CanOpenRig()
    rig.drives[1].node_id = 9
    rig.drives[1].network.nodes.clear()
    with pytest.raises(AdapterTimeout, match=r"joint 1.*node 2"):
        rig.adapter.open()


def test_the_watchdog_is_our_heartbeat_and_the_reaction_is_read_back(rig: CanOpenRig) -> None:
    rig.adapter.configure("torque", 0.002)
    for drive in rig.drives:
        assert drive.value(0x1016, 1) == 127 << 16 | 100
        assert drive.value(0x6007) == 1


@pytest.mark.parametrize("mode", ["velocity", "position"])
def test_torque_goes_as_an_offset_beside_velocity_and_position(rig: CanOpenRig, mode: Any) -> None:
    for drive in rig.drives:
        drive.position = 0.25
    rig.adapter.configure(mode, 0.002)
    rig.adapter.enable()
    rig.clock.advance(0.002)
    rig.link.recording = True
    command = JointCommand(2)
    command.torque[0], command.velocity[0], command.position[0] = 1.0, 2.0, 0.26
    assert rig.adapter.write(command)
    first = next(frame for frame in rig.link.sent[0] if frame.identifier == 0x201)
    word, reference, offset = struct.unpack("<Hih", first.data)
    assert (word, offset) == (15, 200)
    expected = 2.0 if mode == "velocity" else 0.26
    assert reference == round(expected / tau * 65536)


def test_position_mode_starts_where_the_drive_is(rig: CanOpenRig) -> None:
    rig.drives[0].position = 1.0
    rig.adapter.configure("position", 0.002)
    rig.adapter.enable()
    assert rig.drives[0].value(0x607A) == round(1.0 / tau * 65536)


def test_a_lost_heartbeat_of_a_node_stops_all(rig: CanOpenRig) -> None:
    start(rig)
    run(rig, 50)
    rig.link.incoming = lambda frames: [frame for frame in frames if frame.identifier != 0x701]
    with pytest.raises(AdapterConnectionError, match="node 1 has not been heard"):
        run(rig, 200)


def test_a_restarted_drive_is_configured_again_by_clearing_its_fault(rig: CanOpenRig) -> None:
    start(rig)
    run(rig, 3)
    rig.power_cycle(0)
    with pytest.raises(AdapterError):
        run(rig, 30)
    rig.adapter.clear_faults()
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 5, torque=1.0)
    assert rig.applied_torque()[0] == pytest.approx(1.0)


def test_the_state_before_enabling_comes_by_sync_alone(rig: CanOpenRig) -> None:
    rig.adapter.configure("torque", 0.002)
    rig.drives[0].position = 0.5
    feedback = JointFeedback(2)
    for _ in range(5):
        rig.clock.advance(0.003)
        rig.adapter.read_into(feedback)
    assert feedback.position[0] == pytest.approx(0.5, abs=1e-4)


def test_what_seven_drives_at_one_megabit_can_carry_depends_on_the_mode() -> None:
    """SYNC of 55 bits, states of 135 and 125, a command of 95 (torque) or 135 bits, 180 heartbeats of 65 a second."""
    made = convert({"bus": {"interface": "virtual"}, "joints": joint_tables(7, 4.0, 20.0)}, CanOpenConfiguration)
    free = 1.0 - (7 / 0.05 + 4 / 0.1) * 65e-6
    assert highest_rate(made, "torque") == pytest.approx(free / (55e-6 + 7 * 355e-6))
    assert highest_rate(made, "velocity") == pytest.approx(free / (55e-6 + 7 * 395e-6))


def test_a_rate_that_only_torque_mode_can_carry_is_refused_in_velocity_mode() -> None:
    rig = CanOpenRig()
    capabilities = rig.adapter.open()
    torque, velocity = (capabilities.rate_in(mode) for mode in ("torque", "velocity"))
    assert torque == capabilities.highest_rate
    with pytest.raises(AdapterConfigurationError, match=f"{velocity:.0f} Hz in velocity mode"):
        rig.adapter.configure("velocity", 2.0 / (torque + velocity))


@pytest.mark.parametrize(
    ("changes", "complaint"),
    [({"abort_option": 0}, "keep the torque"), ({"master_id": 2}, "joint, too"), ({"heartbeat": 5.0}, "heartbeat")],
)
def test_settings_that_are_unsafe_are_refused(changes: dict[str, Any], complaint: str) -> None:
    with pytest.raises(AdapterConfigurationError, match=complaint):
        open_adapter("canopen", configuration(**changes))


def test_a_temperature_limit_is_refused_where_no_drive_would_notice() -> None:
    bench = make_bench("canopen", 1)
    limits = replace(bench.adapter.options.limits[0], temperature=65.0)
    bench.adapter.options = replace(bench.adapter.options, limits=(limits,))
    with pytest.raises(AdapterConfigurationError, match="does not report its temperature"):
        bench.adapter.open()


@pytest.mark.parametrize("name", ["velocity_count", "counts_per_revolution"])
@pytest.mark.parametrize("value", [0.0, -0.001, inf])
def test_a_scaling_that_would_turn_or_hide_the_motion_is_refused(name: str, value: float) -> None:
    table = configuration()
    table["joints"][0][name] = value
    with pytest.raises(AdapterConfigurationError, match=f"{name} must be finite and above 0"):
        convert(table, CanOpenConfiguration)

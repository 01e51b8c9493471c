"""What servos are told before their torque is switched on, and what is refused."""

from __future__ import annotations

from typing import Any

import pytest

from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import CommandMode, JointCommand, JointFeedback
from fricomp.sim_bench.twins.dynamixel.packet import PacketReader
from fricomp.testing.steps import run, start
from tests.adapters.dynamixel.rig import DynamixelRig
from tests.adapters.peers.rig import joint_tables

DRIVE_MODE, STARTUP, CURRENT_LIMIT, TORQUE_ENABLE, WATCHDOG = 10, 60, 38, 64, 98
GOAL_CURRENT, GOAL_VELOCITY, GOAL_POSITION = 102, 104, 116
ADDRESSES = {GOAL_CURRENT: 2, GOAL_VELOCITY: 4, GOAL_POSITION: 4}


def goal(rig: DynamixelRig, joint: int, address: int) -> int:
    raw = rig.servos[joint].table[address : address + ADDRESSES[address]]
    return int.from_bytes(raw, "little", signed=True)


def ready(mode: CommandMode = "torque", **changes: Any) -> DynamixelRig:
    """Configured, at rest away from zero, and seen."""
    rig = DynamixelRig(**changes)
    rig.adapter.open()
    for axis, position in zip(rig.axes, (1.0, -2.0), strict=True):
        axis.position = position
    rig.adapter.configure(mode, rig.period)
    return rig


def blocked(rig: DynamixelRig, mode: CommandMode, cycles: int = 40) -> bool:
    """Demand far too much of stiff loops whose joints do not move; whether it was all sent."""
    for axis in rig.axes:
        axis.command_gains(200.0, 20.0)
    command = JointCommand(2)
    getattr(command, mode)[:] = [3.0, 3.0]
    feedback, sent = JointFeedback(2), True
    for _ in range(cycles):
        sent = sent and rig.adapter.write(command)
        rig.clock.advance(rig.period)
        rig.adapter.read_into(feedback)
    return sent


@pytest.mark.parametrize("mode", ["torque", "velocity", "position"])
def test_no_servo_exerts_anything_when_its_torque_comes_on(mode: CommandMode) -> None:
    rig = ready(mode)
    for joint, axis in enumerate(rig.axes):
        axis.command_gains(200.0 if mode == "position" else 0.0, 0.0 if mode == "torque" else 20.0)
        rig.servos[joint].table[GOAL_VELOCITY] = 100
    rig.adapter.enable()
    assert all(rig.energised())
    assert [axis.largest_torque for axis in rig.axes] == pytest.approx([0.0, 0.0], abs=200.0 * 0.8e-3)
    assert [goal(rig, joint, GOAL_VELOCITY) for joint in (0, 1)] == [0, 0]


def test_a_restarted_servo_is_prepared_again() -> None:
    """It has forgotten watchdog and block, and goal current is its whole limit."""
    rig = ready()
    rig.adapter.enable()
    assert run(rig, 3)
    rig.power_cycle(0)
    assert not run(rig, 5)
    rig.adapter.clear_faults()
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 5)
    assert rig.axes[0].largest_torque == 0.0


def test_goals_are_written_after_a_fired_watchdog_is_cleared_and_before_the_torque() -> None:
    rig = ready()
    rig.servos[0].table[WATCHDOG] = 0xFF
    rig.link.recording = True
    rig.adapter.enable()
    packets = [packet for sent in rig.link.sent for packet in PacketReader().feed(sent)]
    written = [int.from_bytes(data[:2], "little") for servo, kind, data in packets if (servo, kind) == (1, 3)]
    assert written == [WATCHDOG, WATCHDOG, GOAL_CURRENT, GOAL_VELOCITY, TORQUE_ENABLE]


@pytest.mark.parametrize("address", [GOAL_CURRENT, GOAL_VELOCITY, GOAL_POSITION])
def test_a_servo_that_keeps_a_goal_is_not_enabled(address: int) -> None:
    rig = ready("position")
    servo, write = rig.servos[1], rig.servos[1].write
    kept = (77).to_bytes(ADDRESSES[address], "little")

    def keep(at: int, data: bytes) -> int:
        return write(at, kept if at == address else data)

    servo.write = keep  # type: ignore[method-assign, assignment]
    with pytest.raises(AdapterError, match=f"keeps 77 at address {address}"):
        rig.adapter.enable()
    assert not any(rig.energised())


def test_a_watchdog_that_has_fired_while_enabling_is_told() -> None:
    rig = ready()
    servo, write = rig.servos[0], rig.servos[0].write

    def slow(address: int, data: bytes) -> int:
        error = write(address, data)
        if address == TORQUE_ENABLE and data[0]:
            rig.clock.advance(0.15)
        return error

    servo.write = slow  # type: ignore[method-assign]
    with pytest.raises(AdapterError, match="watchdog of servo 1 reads 255"):
        rig.adapter.enable()
    assert not any(rig.energised())


@pytest.mark.parametrize(
    ("address", "bits", "complaint"),
    [(DRIVE_MODE, 0x08, "goal comes"), (DRIVE_MODE, 0x02, "follows another"), (STARTUP, 0x01, "with its power")],
)
def test_servos_that_would_energise_themselves_are_refused(address: int, bits: int, complaint: str) -> None:
    rig = DynamixelRig()
    rig.servos[1].table[address] = bits
    with pytest.raises(AdapterConfigurationError, match=f"servo 2.*{complaint}"):
        rig.adapter.open()


def test_a_reversed_servo_is_not_refused() -> None:
    rig = DynamixelRig()
    rig.servos[1].table[DRIVE_MODE] = 0x05
    rig.adapter.open()


def test_the_position_loop_of_the_servo_keeps_within_the_torque_limit() -> None:
    rig = ready("position")
    rig.adapter.enable()
    assert blocked(rig, "position")
    most = [abs(axis.torque) for axis in rig.axes]
    assert most == pytest.approx([1.0, 1.0], abs=2.69e-3)
    assert max(axis.largest_torque for axis in rig.axes) <= 1.0


def test_a_velocity_loop_beyond_the_torque_limit_stops_the_joints() -> None:
    """No current bounds it; the first state that tells so is the last."""
    rig = ready("velocity")
    rig.adapter.enable()
    assert not blocked(rig, "velocity", 2)
    assert rig.adapter.gate.tripped
    assert not any(rig.energised())


def test_a_velocity_loop_within_the_torque_limit_goes_on() -> None:
    rig = ready("velocity")
    rig.adapter.enable()
    for axis in rig.axes:
        axis.command_gains(0.0, 0.3)
    command = JointCommand(2)
    command.velocity[:] = [3.0, 1.5]
    for _ in range(10):
        assert rig.adapter.write(command)
        rig.clock.advance(rig.period)
        rig.adapter.read_into(JointFeedback(2))
    assert [axis.torque for axis in rig.axes] == pytest.approx([0.9, -0.9], abs=0.01)


@pytest.mark.parametrize(
    ("constant", "limit", "counts"),
    [(None, 1.0, (371, 371)), (1.78, 1.78, (371, 185)), (None, 2.69, (1000, 1000)), (None, 2.69e-3, (1, 1))],
)
def test_the_limit_is_the_gates_in_counts_rounded_towards_zero(
    constant: float | None, limit: float, counts: tuple[int, int]
) -> None:
    """Behind a gear of 2, half the newton metres, but all of the amperes."""
    joints = joint_tables(2, torque=limit, velocity=9.0, torque_constant=constant)
    joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
    rig = ready("position", joints=joints)
    rig.adapter.enable()
    assert [goal(rig, joint, GOAL_CURRENT) for joint in (0, 1)] == list(counts)


def test_a_limit_below_one_step_is_refused_where_the_servo_has_to_keep_it() -> None:
    rig = DynamixelRig(joints=joint_tables(2, torque=1e-3, velocity=9.0))
    rig.adapter.open()
    rig.adapter.configure("torque", rig.period)
    with pytest.raises(AdapterConfigurationError, match="less than the servo's step"):
        rig.adapter.configure("position", rig.period)


def test_a_servo_that_refuses_its_bound_is_not_configured() -> None:
    rig = DynamixelRig()
    rig.adapter.open()
    rig.servos[0].table[CURRENT_LIMIT : CURRENT_LIMIT + 2] = (100).to_bytes(2, "little")
    with pytest.raises(AdapterConfigurationError, match="servo 1 cannot be bounded"):
        rig.adapter.configure("position", rig.period)


def test_the_current_limit_in_the_eeprom_stays_as_it_is() -> None:
    rig = ready("position")
    rig.adapter.enable()
    assert int.from_bytes(rig.servos[0].table[CURRENT_LIMIT : CURRENT_LIMIT + 2], "little") == 1193


def test_torque_after_the_position_mode_is_not_bounded_by_it() -> None:
    rig = ready("position")
    rig.adapter.enable()
    rig.adapter.safe_stop()
    rig.adapter.clear_faults()
    start(rig)
    assert run(rig, 3, torque=0.9)
    assert rig.applied_torque() == pytest.approx([0.9, 0.9], abs=2.69e-3)

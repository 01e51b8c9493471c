"""The real adapters on their twins in one process, in lock step."""

from __future__ import annotations

from typing import Any

import pytest

from fricomp.adapters import JointAdapter
from fricomp.errors import AdapterConfigurationError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.stand_in import StandIn
from fricomp.sim_bench.twins.backend import (
    TwinCanOpenAdapter,
    TwinDynamixelAdapter,
    TwinMitAdapter,
    TwinMoteusAdapter,
    TwinOdriveAdapter,
)

ADAPTERS: dict[str, Any] = {
    "canopen": TwinCanOpenAdapter,
    "dynamixel": TwinDynamixelAdapter,
    "mit": TwinMitAdapter,
    "moteus": TwinMoteusAdapter,
    "odrive": TwinOdriveAdapter,
}
TORQUE = 0.9


def push(adapter: Any, cycles: int, torque: float = TORQUE, period_ms: int = 1) -> tuple[StandIn, JointFeedback]:
    """Open, enable and push the first joint for some cycles, the ramp included."""
    adapter.open()
    adapter.configure("torque", period_ms * 1e-3)
    adapter.enable()
    joints = len(adapter.capabilities.joints)
    command, feedback, deadline = JointCommand(joints), JointFeedback(joints), adapter.clock.now_ns()
    for _ in range(cycles):
        adapter.read_into(feedback)
        command.torque[0] = torque
        assert adapter.write(command), adapter.gate.trip_record
        deadline += period_ms * 1_000_000
        adapter.clock.sleep_until(deadline)
    adapter.read_into(feedback)
    return adapter.twin.stand_in, feedback


@pytest.mark.parametrize("name", ADAPTERS)
def test_torque_arrives_and_the_motion_comes_back(name: str) -> None:
    adapter = ADAPTERS[name].from_configuration({})
    stand_in, feedback = push(adapter, 500)
    quanta = adapter.capabilities.joints[0]
    assert adapter.capabilities.simulated
    assert stand_in.torque[0] == pytest.approx(TORQUE, abs=quanta.torque_quantum + 1e-6)
    # Sensor, bus and cycle make the feedback two to three milliseconds old.
    velocity = stand_in.plant.velocity(0)
    assert 0.4 < velocity < 3.0
    assert feedback.velocity[0] == pytest.approx(velocity, abs=0.1)
    assert feedback.position[0] == pytest.approx(stand_in.plant.position(0), abs=0.004 * velocity + 2e-3)
    assert feedback.torque[0] == pytest.approx(TORQUE, abs=0.02)
    adapter.close()
    adapter.clock.sleep_until(adapter.clock.now_ns() + 2_000_000)
    assert stand_in.torque == [0.0]


@pytest.mark.parametrize("name", ADAPTERS)
def test_a_dead_control_loop_loses_its_torque_within_the_watchdog(name: str) -> None:
    adapter = ADAPTERS[name].from_configuration({})
    stand_in, _ = push(adapter, 300)
    watchdog = adapter.capabilities.watchdog
    assert watchdog.confirmed
    adapter.clock.sleep_until(adapter.clock.now_ns() + round(watchdog.timeout * 1e9) + 5_000_000)
    assert stand_in.torque == pytest.approx([0.0], abs=1e-9)


@pytest.mark.parametrize("name", ADAPTERS)
def test_equal_runs_are_equal_to_the_last_bit(name: str) -> None:
    runs = [push(ADAPTERS[name].from_configuration({"sim": {"seed": 7}}), 100)[1] for _ in range(2)]
    assert runs[0].position == runs[1].position
    assert runs[0].torque == runs[1].torque


@pytest.mark.parametrize("name", ADAPTERS)
def test_an_arm_behind_gears_is_driven_on_the_joint_side(name: str) -> None:
    drives = [{"gear_ratio": 4.0}, {"gear_ratio": 2.0}]
    adapter: JointAdapter = ADAPTERS[name].from_configuration({"drives": drives, "sim": {"model": "two_link_arm"}})
    stand_in, feedback = push(adapter, 50, torque=0.3, period_ms=2)
    assert stand_in.torque[0] == pytest.approx(0.15, abs=0.06)  # half way up the ramp
    assert feedback.torque[0] == pytest.approx(stand_in.torque[0], abs=0.06)


def test_a_wrong_table_is_a_configuration_error() -> None:
    with pytest.raises(AdapterConfigurationError, match="no torque_limit; known: receive_id"):
        TwinMitAdapter.from_configuration({"drives": [{"torque_limit": 3.0}]})

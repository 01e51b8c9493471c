"""One wire for both directions: the adapter never speaks while servos still have to answer."""

from __future__ import annotations

from typing import cast

import pytest

from fricomp.adapters.dynamixel import DynamixelAdapter
from fricomp.adapters.dynamixel.packet import bulk_read_packet
from fricomp.adapters.dynamixel.report import REPORT_SIZE, report_request
from fricomp.adapters.link import SerialLink
from fricomp.joint import JointCommand, JointFeedback
from fricomp.testing import VirtualClock
from fricomp.testing.steps import cycle, run, start
from tests.adapters.dynamixel.half_duplex import HalfDuplexLine
from tests.adapters.dynamixel.rig import DynamixelRig
from tests.adapters.peers.rig import joint_tables

TORQUE_ENABLE, WATCHDOG = 64, 98


class HalfDuplexRig(DynamixelRig):
    def __init__(self, baudrate: int = 1_000_000, temperature: float | None = None) -> None:
        self.lines: list[HalfDuplexLine] = []
        joints = joint_tables(2, torque=1.0, velocity=9.0)
        for joint in joints:
            joint["limits"]["temperature"] = temperature
        joints[1]["transmission"] = {"sign": -1}
        super().__init__(
            lambda bus, clock: self._make_line(bus, clock, baudrate),
            joints=joints,
            serial={"port": "loop://", "baudrate": baudrate},
            stale_after=0.05,
        )

    def _make_line(self, bus: SerialLink, clock: VirtualClock, baudrate: int) -> HalfDuplexLine:
        self.lines.append(HalfDuplexLine(bus, clock, baudrate))
        return self.lines[0]

    @property
    def n_collisions(self) -> int:
        return self.lines[0].n_collisions


@pytest.mark.parametrize("baudrate", [57_600, 1_000_000])
def test_nothing_collides_from_opening_to_stopping(baudrate: int) -> None:
    rig = HalfDuplexRig(baudrate)
    rig.period = 1.0 / rig.adapter.open().rate_in("torque")
    feedback = JointFeedback(2)
    for _ in range(50):
        rig.adapter.read_into(feedback)
        rig.clock.advance(0.001)
    start(rig)
    fresh = 0
    for _ in range(200):
        assert cycle(rig, [0.5, 0.5], feedback)
        fresh += feedback.time_ns == rig.clock.now_ns() - round(rig.period * 1e9)
    assert fresh == 200
    assert rig.applied_torque() == pytest.approx([0.5, 0.5], abs=2.69e-3)
    assert rig.n_collisions == 0


def test_temperature_and_a_servo_without_torque_are_noticed() -> None:
    rig = HalfDuplexRig()
    rig.adapter.open()
    start(rig)
    feedback = JointFeedback(2)
    assert run(rig, 5, feedback)
    assert feedback.temperature == [30.0, 30.0]
    rig.servos[1].table[TORQUE_ENABLE] = 0
    rig.axes[1].disable()
    run(rig, 3)
    assert rig.adapter.gate.tripped
    assert not any(rig.energised())


def test_a_hot_servo_stops_the_joints() -> None:
    rig = HalfDuplexRig(temperature=65.0)
    rig.adapter.open()
    start(rig)
    assert run(rig, 3)
    rig.axes[0].temperature = 90.0
    run(rig, 3)
    assert rig.adapter.gate.tripped


def test_a_servo_whose_watchdog_has_fired_stops_the_joints() -> None:
    rig = HalfDuplexRig()
    rig.adapter.open()
    start(rig)
    assert run(rig, 3)
    rig.servos[0].table[WATCHDOG] = 0xFF
    run(rig, 3)
    assert rig.adapter.gate.trip_record is not None
    assert rig.adapter.gate.trip_record.reason == "drive_fault"
    assert not any(rig.energised())


@pytest.mark.parametrize("moment", [1e-6, 2e-4, 5e-4, 9e-4])
def test_a_stop_gets_through_while_servos_are_answering(moment: float) -> None:
    rig = HalfDuplexRig()
    rig.adapter.open()
    start(rig)
    assert run(rig, 3, torque=0.5)
    command = JointCommand(2)
    command.torque[:] = [0.5, 0.5]
    assert rig.adapter.write(command)
    rig.clock.advance(moment)
    rig.adapter.safe_stop()
    assert not any(rig.energised())
    assert not any(rig.applied_torque())


def test_a_command_that_comes_before_the_answers_waits_for_the_next_cycle() -> None:
    rig = HalfDuplexRig()
    rig.adapter.open()
    start(rig)
    command = JointCommand(2)
    for torque in (0.25, 0.5):
        command.torque[:] = [torque, torque]
        assert rig.adapter.write(command)
        rig.clock.advance(1e-4)
    assert rig.n_collisions == 0
    assert cast(DynamixelAdapter, rig.adapter).health()["commands_held_back"] == 1.0
    assert rig.applied_torque() == pytest.approx([0.25, 0.25], abs=2.69e-3)
    rig.clock.advance(rig.period)
    assert run(rig, 1, torque=0.5)
    assert rig.applied_torque() == pytest.approx([0.5, 0.5], abs=2.69e-3)


def test_models_with_other_indirect_data_are_asked_in_the_same_packet() -> None:
    request = report_request(b"\x01\x02", [224, 208])
    assert request == bulk_read_packet(REPORT_SIZE, {1: 224, 2: 208})
    assert request[4:-2] == bytes([0xFE, 13, 0, 0x92, 1, 224, 0, 14, 0, 2, 208, 0, 14, 0])

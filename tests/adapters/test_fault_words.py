"""What a drive reports is told in words, with its code, and named by its joint."""

from __future__ import annotations

import pytest

from fricomp.adapters import JointAdapter
from fricomp.adapters.canopen.fault import FAULT_RESTARTED
from fricomp.adapters.canopen.fault import describe_fault as describe_canopen
from fricomp.adapters.configuration import convert
from fricomp.adapters.driver import name_bits
from fricomp.adapters.dynamixel.report import FAULT_TORQUE
from fricomp.adapters.dynamixel.report import describe_fault as describe_dynamixel
from fricomp.adapters.mit.configuration import MitConfiguration, make_motor
from fricomp.adapters.moteus.fault import FAULT_MODE
from fricomp.adapters.moteus.fault import describe_fault as describe_moteus
from fricomp.adapters.odrive.fault import FAULT_OF_PART
from fricomp.adapters.odrive.fault import describe_fault as describe_odrive
from fricomp.joint import JointFeedback
from fricomp.sim_bench.twins import backend
from tests.adapters.peers.rig import joint_tables

TWINS: list[type[JointAdapter]] = [
    backend.TwinCanOpenAdapter,
    backend.TwinDynamixelAdapter,
    backend.TwinMitAdapter,
    backend.TwinMoteusAdapter,
    backend.TwinOdriveAdapter,
]


@pytest.mark.parametrize(
    ("told", "words"),
    [
        (describe_canopen(0x8130), "heartbeat"),
        (describe_canopen(0x2310), "current"),
        (describe_canopen(0x7305), "sensor"),
        (describe_canopen(FAULT_RESTARTED), "started again"),
        (describe_dynamixel(FAULT_TORQUE), "more current than the torque limit allows"),
        (describe_dynamixel(0x24), "overheated, overloaded"),
        (describe_moteus(34), "voltage too high"),
        (describe_moteus(FAULT_MODE + 11), "watchdog"),
        (describe_moteus(FAULT_MODE + 15), "mode 15"),
        (describe_odrive(0x100_0000, 6), "watchdog"),
        (describe_odrive(0x800, 5), "watchdog"),
        (describe_odrive(0x800, 6), "returned to the supply"),
        (describe_odrive(FAULT_OF_PART, 5), "motor, encoder or controller"),
    ],
)
def test_a_code_has_words(told: str, words: str) -> None:
    assert words in told


def test_a_code_that_nobody_explains_has_none() -> None:
    assert (
        describe_canopen(0x0123) == describe_moteus(7) == describe_odrive(0x2000_0000, 6) == describe_dynamixel(2) == ""
    )
    assert name_bits(0b11, {1: "one"}) == ""


@pytest.mark.parametrize(
    ("model", "code", "words"),
    [
        ("damiao/DM4310", 0xD, "watchdog"),
        ("tmotor/AK80-9", 2, "current"),
        ("xiaomi/CyberGear", 0x05, "supply voltage too low, overheated"),
        ("damiao/DM4310", 0x1002, "edge"),
    ],
)
def test_motors_of_each_vendor_have_their_own_words(model: str, code: int, words: str) -> None:
    table = {"bus": {"interface": "virtual"}, "joints": joint_tables(1, 4.0, 8.0, model=model)}
    motor = make_motor(convert(table, MitConfiguration).joints[0])
    assert words in motor.describe_fault(code)
    assert motor.describe_fault(0xABC000) == ""


@pytest.mark.parametrize("make", TWINS)
def test_every_watchdog_has_words_and_a_trip_tells_them(make: type[JointAdapter]) -> None:
    adapter = make.from_configuration({})
    with adapter:
        adapter.configure("torque", 0.01)
        for code in adapter.watchdog_faults:
            feedback = JointFeedback(1)
            feedback.position[0] = feedback.velocity[0] = 0.0
            feedback.fault[0], feedback.time_ns = code, adapter.clock.now_ns()
            adapter.gate.observe(feedback, feedback.time_ns)
            told = str(adapter.gate.trip_record)
            name = adapter.capabilities.joints[0].name
            assert told.startswith(f"drive fault: the drives report {name}: ")
            assert ("watchdog" in told) or ("heartbeat" in told)
            assert f"({code:#x})" in told
            adapter.clear_faults()

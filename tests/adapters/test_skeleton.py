"""The adapter of `examples/adapter.py` through the whole conformance suite: a test to begin that of your own with."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

import pytest

from examples.adapter import PlainAdapter, PlainConfiguration
from fricomp.adapters.configuration import convert
from fricomp.adapters.trial import TrialSettings, try_drive
from fricomp.errors import AdapterConfigurationError
from fricomp.testing import AdapterRig, FaultyLink, GoldenCommand, VirtualClock
from fricomp.testing.conformance import AdapterConformance
from fricomp.testing.steps import opened

STATE, WATCHDOG, ENABLE, TORQUE, STOP, CLEAR = range(6)
SILENCE, HEAT = 1, 2  # faults
GEARS = (1.0, -2.0)  # sign · gear_ratio of each joint

LIMITS = {"torque": 4.0, "torque_rate": 1e9, "velocity": 20.0, "position": (-3.0, 3.0), "breakaway": 1e3}
CONFIGURATION: dict[str, Any] = {
    "serial": {"port": "memory"},
    "ramp_time": 0.0,
    "joints": [
        {"name": "shoulder", "id": 1, "limits": LIMITS},
        {"name": "elbow", "id": 2, "limits": LIMITS, "transmission": {"sign": -1, "gear_ratio": 2.0}},
    ],
}


class Drive:
    """A drive as its manual has it, written without the adapter's code; a hand holds its joint where a test says.

    Args:
        address: Of the drive on the line.
    """

    def __init__(self, address: int) -> None:
        self.address = address
        self.position = self.velocity = 0.0
        self.is_hot = self.refuses = False
        self.now_ns = 0
        self.switch_on()

    def switch_on(self) -> None:
        """As after a failure of its power: it forgets everything, its watchdog as well."""
        self.energised = False
        self.torque = self.fault = self.watchdog = self.fed_ns = 0

    def on_time(self, now_ns: int) -> None:
        self.now_ns = now_ns
        is_silent = self.energised and 0 < 1_000_000 * self.watchdog < now_ns - self.fed_ns
        if self.is_hot or is_silent:
            self.energised, self.torque, self.fault = False, 0, HEAT if self.is_hot else SILENCE

    def answer(self, operation: int, value: int) -> bytes:
        """What it sends to a request, which it has followed by then."""
        if operation == WATCHDOG:
            self.watchdog = value
        elif operation == ENABLE and not (self.fault or self.refuses):
            self.energised, self.torque, self.fed_ns = True, 0, self.now_ns
        elif operation == TORQUE and self.energised:
            self.torque, self.fed_ns = value, self.now_ns
        elif operation == STOP:
            self.energised, self.torque = False, 0
        elif operation == CLEAR:
            self.fault = HEAT if self.is_hot else 0
        head = struct.pack("<BBBBBH", 0xA5, self.address, operation, self.energised, self.fault, self.watchdog)
        return with_crc(head + struct.pack("<ffh", self.position, self.velocity, self.torque))


class MemoryLine:
    """The adapter's end of a line on which every whole request is answered at once."""

    def __init__(self, drives: Sequence[Drive]) -> None:
        self._drives = {drive.address: drive for drive in drives}
        self._answers = b""

    def send(self, data: bytes) -> None:
        for _, address, operation, value, _ in struct.iter_unpack("<BBBhH", data):
            self._answers += self._drives[address].answer(operation, value)

    def receive(self) -> bytes:
        answers, self._answers = self._answers, b""
        return answers

    def discard_output(self) -> None:
        """Nothing waits here."""

    def close(self) -> None:
        """Nothing is held here."""


def with_crc(frame: bytes) -> bytes:
    """CRC-16/CCITT-FALSE bit by bit, as the manual explains it."""
    crc = 0xFFFF
    for byte in frame:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
    return frame + struct.pack("<H", crc)


class SkeletonRig(AdapterRig):
    """Two drives, the second behind a gear that turns the other way.

    What a protocol rules out stands in `exempt`, for instance of a drive that has no watchdog:
    `exempt = {"test_a_dead_loop_ends_in_zero_torque_by_the_watchdog": "it has none: manual, chapter 3"}`. This one
    rules out nothing.
    """

    torque_limit = 4.0

    def __init__(self) -> None:
        self.clock = VirtualClock()
        self.drives = [Drive(1), Drive(2)]
        for drive in self.drives:
            drive.now_ns = self.clock.now_ns()
            self.clock.follow(drive.on_time)
        self.link = FaultyLink(MemoryLine(self.drives))
        made = convert(CONFIGURATION, PlainConfiguration)
        self.adapter: PlainAdapter = PlainAdapter(made, lambda: self.link, self.clock)

    def applied_torque(self) -> list[float]:
        return [1e-3 * drive.torque * gear for drive, gear in zip(self.drives, GEARS, strict=True)]

    def energised(self) -> list[bool]:
        return [drive.energised for drive in self.drives]

    def move(self, joint: int, position: float, velocity: float) -> None:
        drive, gear = self.drives[joint], GEARS[joint]
        drive.position, drive.velocity = position * gear, velocity * gear

    def fail(self, joint: int) -> None:
        self.drives[joint].is_hot = True

    def heal(self, joint: int) -> None:
        self.drives[joint].is_hot = False

    def power_cycle(self, joint: int) -> None:
        self.drives[joint].switch_on()

    def hold(self, joint: int) -> None:
        drive = self.drives[joint]
        drive.energised, drive.torque, drive.watchdog = True, 1000, 0  # 0: it never falls silent

    def is_read(self, traffic: bytes) -> bool:
        return all(operation == STATE for _, _, operation, _, _ in struct.iter_unpack("<BBBhH", traffic))

    def refuse_mode(self) -> None:
        for drive in self.drives:
            drive.refuses = True

    def golden(self) -> Sequence[GoldenCommand]:
        """0.25 N·m at a joint of no gear is 250 steps, and −3 N·m at one of −2 are 1500."""
        wire = with_crc(bytes.fromhex("a5 01 03 fa 00")) + with_crc(bytes.fromhex("a5 02 03 dc 05"))
        return [GoldenCommand((0.25, -3.0), wire)]


class TestSkeletonConforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return SkeletonRig()


def test_the_checksum_is_the_one_that_is_published() -> None:
    assert with_crc(b"123456789")[-2:] == bytes.fromhex("b1 29")  # 0x29B1 in every catalogue of CRCs


def test_an_address_that_no_request_can_hold_is_refused_by_name() -> None:
    joints = [{"name": "wrist", "id": 256, "limits": LIMITS}]
    with pytest.raises(AdapterConfigurationError, match=r"'wrist': drives have addresses 1 to 255, got 256"):
        PlainAdapter.from_configuration(CONFIGURATION | {"joints": joints})


def test_the_trial_of_a_drive_finds_nothing_wrong() -> None:
    steps = {step.name: step for step in try_drive(SkeletonRig().adapter, TrialSettings(), lambda: True)}
    assert [step for step in steps.values() if step.passed is False] == []
    assert steps["clear"].passed  # what its own silence has latched


def test_a_drive_that_was_power_cycled_gets_its_watchdog_again_before_it_is_energised() -> None:
    rig = SkeletonRig()
    opened(rig)
    rig.adapter.configure("torque", rig.period)
    rig.power_cycle(1)
    rig.adapter.enable()
    assert [drive.watchdog for drive in rig.drives] == [100, 100]


def test_a_damaged_answer_is_dropped_and_the_next_one_is_taken() -> None:
    rig = SkeletonRig()
    opened(rig)
    rig.move(0, 0.5, 0.0)
    answer = rig.drives[0].answer(STATE, 0)
    rig.adapter._on_bytes(answer[:9] + answer)  # one that was cut short before it
    assert rig.adapter._reported.position[0] == 0.5
    rig.move(0, 1.0, 0.0)
    damaged = bytearray(rig.drives[0].answer(STATE, 0))
    damaged[10] ^= 1
    rig.adapter._on_bytes(bytes(damaged))
    assert rig.adapter._reported.position[0] == 0.5

"""AK modules and the CyberGear: frames by hand from their manuals, and the MIT adapter on them."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from math import pi
from typing import Any

import can
import pytest

from fricomp.errors import AdapterConfigurationError, ParameterError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.twins.backend import TwinMitAdapter
from fricomp.sim_bench.twins.mit.ak import AkFault, AkMotor, AkSettings
from fricomp.sim_bench.twins.mit.cybergear import CyberGearMotor, CyberGearSettings, Mode
from fricomp.sim_bench.twins.mit.damiao import MitStatus

from ..rig import CanRig, can_rig

ENABLE = b"\xff" * 7 + b"\xfc"
HOST = 0xFD


@pytest.fixture
def ak() -> Iterator[CanRig]:
    with can_rig(lambda axis: AkMotor(axis, AkSettings(receive_id=3, timeout=2000))) as made:
        yield made


def test_an_ak_module_answers_on_the_masters_identifier_with_its_number_and_fault(ak: CanRig) -> None:
    ((identifier, data),) = ak.ask(3, ENABLE)
    assert (identifier, data[0], data[6] - 40, data[7]) == (0, 3, 25, AkFault.NONE)
    assert int.from_bytes(data[1:3], "big") / 65535 * 25.0 - 12.5 == pytest.approx(0.25, abs=2e-4)
    device: Any = ak.twin.drives[0]
    device.fail(MitStatus.OVER_CURRENT)
    assert ak.ask(3, ENABLE)[0][1][7] == AkFault.OVER_CURRENT


def test_an_ak_module_torque_spans_its_own_range_and_lapses(ak: CanRig) -> None:
    ak.ask(3, ENABLE)
    code = round((1.5 + 18.0) / 36.0 * 4095)
    ak.send(3, (0x7FFF << 48 | 0x7FF << 36 | code).to_bytes(8, "big"))
    ak.steps(1)
    assert ak.stand_in.torque[0] == pytest.approx(1.5, abs=36.0 / 4095)
    ak.steps(103)
    assert ak.stand_in.torque == [0.0]


def test_an_ak_module_has_no_registers(ak: CanRig) -> None:
    assert ak.ask(0x7FF, bytes([3, 0, 0x33, 21, 0, 0, 0, 0])) == []


class CyberGearRig:
    def __init__(self, rig: CanRig) -> None:
        self.rig = rig

    @property
    def motor(self) -> CyberGearMotor:
        (device,) = self.rig.twin.drives
        assert isinstance(device, CyberGearMotor)
        return device

    def send(self, kind: int, middle: int, data: bytes = bytes(8)) -> tuple[int, bytes] | None:
        """The answer, if there is one."""
        self.rig.bus.send(can.Message(arbitration_id=kind << 24 | middle << 8 | 5, data=data, is_extended_id=True))
        self.rig.twin.pump()
        answers = self.rig.received()
        return answers[-1] if answers else None

    def torque(self, torque: float) -> None:
        self.send(1, round((torque + 12.0) / 24.0 * 65535), struct.pack(">4H", 0x8000, 0x8000, 0, 0))


@pytest.fixture
def gear() -> Iterator[CyberGearRig]:
    with can_rig(lambda axis: CyberGearMotor(axis, CyberGearSettings(motor_id=5))) as made:
        yield CyberGearRig(made)


def test_a_cybergear_carries_the_torque_in_the_identifier(gear: CyberGearRig) -> None:
    gear.torque(2.0)
    gear.rig.steps(1)
    assert gear.rig.stand_in.torque == [0.0], "not enabled"
    answer = gear.send(3, HOST)
    assert answer is not None
    identifier, data = answer
    assert identifier >> 24 == 2
    assert identifier >> 22 & 0x3 == Mode.RUN
    assert (identifier >> 8 & 0xFF, identifier & 0xFF) == (5, HOST)
    position, _, _, temperature = struct.unpack(">4H", data)
    assert position / 65535 * 8.0 * pi - 4.0 * pi == pytest.approx(0.25, abs=2e-4)
    assert temperature == 250
    gear.torque(2.0)
    gear.rig.steps(1)
    assert gear.rig.stand_in.torque[0] == pytest.approx(2.0, abs=2e-4)


def test_a_cybergear_resets_when_parameter_200c_runs_out(gear: CyberGearRig) -> None:
    gear.send(18, HOST, struct.pack("<HHI", 0x200C, 0, 1000))
    answer = gear.send(17, HOST, struct.pack("<HHI", 0x200C, 0, 0))
    assert answer is not None
    assert struct.unpack("<HHI", answer[1]) == (0x200C, 0, 1000)
    gear.send(3, HOST)
    gear.torque(1.0)
    gear.rig.steps(49)
    assert gear.rig.stand_in.torque[0] > 0.9
    gear.rig.steps(4)
    assert gear.rig.stand_in.torque == [0.0]
    assert gear.motor.mode == Mode.RESET


def test_a_cybergears_fault_keeps_it_from_running_until_cleared(gear: CyberGearRig) -> None:
    gear.motor.fail(1)
    answer = gear.send(3, HOST)
    assert answer is not None
    assert (answer[0] >> 22 & 0x3, answer[0] >> 16 & 0x3F) == (Mode.RESET, 0b10)
    gear.send(4, HOST, b"\x01" + bytes(7))
    gear.send(3, HOST)
    assert gear.motor.mode == Mode.RUN


@pytest.mark.parametrize("dialect", ["cybergear", "damiao"])
def test_the_mit_adapter_drives_every_dialect(dialect: str) -> None:
    adapter: Any = TwinMitAdapter.from_configuration({"drives": [{"dialect": dialect}]})
    adapter.open()
    adapter.configure("torque", 1e-3)
    adapter.enable()
    command, feedback, deadline = JointCommand(1), JointFeedback(1), adapter.clock.now_ns()
    for _ in range(400):
        adapter.read_into(feedback)
        command.torque[0] = 0.9
        assert adapter.write(command)
        deadline += 1_000_000
        adapter.clock.sleep_until(deadline)
    assert adapter.twin.stand_in.torque[0] == pytest.approx(0.9, abs=5e-3)
    assert feedback.torque[0] == pytest.approx(0.9, abs=0.01)
    assert adapter.capabilities.watchdog.confirmed


def test_unknown_dialects_and_impossible_settings_are_refused() -> None:
    with pytest.raises(AdapterConfigurationError, match="no MIT dialect 'kinova'; there are ak, cybergear, damiao"):
        TwinMitAdapter.from_configuration({"drives": [{"dialect": "kinova"}]})
    with pytest.raises(ParameterError, match="motor_id"):
        CyberGearSettings(motor_id=200)

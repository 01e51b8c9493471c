"""The other dialects of MIT mode: CyberGear through the conformance suite, T-Motor and Robstride by their frames."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan, pi
from typing import Any

import pytest

from fricomp.adapters.configuration import convert
from fricomp.adapters.link import CanFrame
from fricomp.adapters.mit import MitAdapter, MitCodec, MitRanges
from fricomp.adapters.mit.configuration import MitConfiguration, make_motor
from fricomp.adapters.mit.profile import vendor_profiles
from fricomp.errors import AdapterConfigurationError, AdapterValueError
from fricomp.testing import AdapterRig, GoldenCommand, VirtualClock
from fricomp.testing.conformance import AdapterConformance
from tests.adapters.peers.cybergear import CyberGearPeer
from tests.adapters.peers.rig import PeerRig, joint_tables


class CyberGearRig(PeerRig):
    def __init__(self) -> None:
        joints = joint_tables(2, torque=4.0, velocity=20.0, model="xiaomi/CyberGear")
        joints[1]["transmission"] = {"sign": -1, "gear_ratio": 2.0}
        joints[1]["limits"]["velocity"] = 10.0
        table = {"bus": {"interface": "virtual"}, "joints": joints, "ramp_time": 0.0}
        made = convert(table, MitConfiguration)
        peers = [CyberGearPeer(1), CyberGearPeer(2)]
        super().__init__(lambda link, clock: MitAdapter(made, link, clock), peers, 4.0, gears=(1.0, -2.0))

    def is_read(self, traffic: CanFrame) -> bool:
        """Reading a parameter."""
        return traffic.identifier >> 24 == 17

    def golden(self) -> Sequence[GoldenCommand]:
        """By hand: type 1, torque 3 N·m of 12 as 40959 in the identifier, references in the middle, no gains."""
        identifier = 0x01 << 24 | 40959 << 8 | 1
        return [GoldenCommand((3.0, 0.0), CanFrame(identifier, bytes.fromhex("8000800000000000"), True))]


class TestCyberGearConforms(AdapterConformance):
    @pytest.fixture
    def rig(self) -> AdapterRig:
        return CyberGearRig()


def motor(model: str, **extra: Any) -> Any:
    table = {"bus": {"interface": "virtual"}, "joints": joint_tables(1, 4.0, 7.0, model=model, **extra)}
    return make_motor(convert(table, MitConfiguration).joints[0])


def test_a_t_motor_tells_its_temperature_with_an_offset_and_its_error() -> None:
    state = motor("tmotor/AK80-9").decode(CanFrame(0, bytes.fromhex("01ffff8007ff4b03")))
    assert state.position == pytest.approx(12.5)
    assert abs(state.velocity) < 0.02
    assert abs(state.torque) < 0.01
    assert (state.temperature, state.fault, state.enabled) == (35.0, 3, None)


def test_an_older_t_motor_sends_six_bytes() -> None:
    state = motor("tmotor/AK80-9").decode(CanFrame(0, bytes.fromhex("017fff7ff800")))
    assert isnan(state.temperature)
    assert state.fault == 0


class AkLink:
    """Motor 1, which answers every frame with a state of so many bytes."""

    def __init__(self, size: int) -> None:
        self.answer, self.waiting = CanFrame(0, bytes.fromhex("017fff7ff8004b00")[:size]), 0

    def send(self, frames: Sequence[CanFrame]) -> None:
        self.waiting += len(frames)

    def receive(self) -> list[CanFrame]:
        n_frames, self.waiting = self.waiting, 0
        return [self.answer] * n_frames

    def discard_output(self) -> None: ...

    def close(self) -> None: ...


@pytest.mark.parametrize(("size", "reports"), [(6, False), (8, True)])
def test_a_temperature_limit_needs_a_t_motor_that_tells_its_temperature(size: int, reports: bool) -> None:
    tables = joint_tables(1, 4.0, 7.0, model="tmotor/AK80-9")
    for limit in (None, 70.0):
        tables[0]["limits"] = tables[0]["limits"] | {"temperature": limit}
        made = convert({"bus": {"interface": "virtual"}, "joints": tables}, MitConfiguration)
        adapter = MitAdapter(made, lambda: AkLink(size), VirtualClock())
        if limit is None or reports:
            assert adapter.open().joints[0].reports_temperature is reports
        else:
            with pytest.raises(AdapterConfigurationError, match="does not report its temperature"):
                adapter.open()


def test_a_robstride_in_mit_mode_tells_tenths_of_a_degree() -> None:
    state = motor("robstride-mit/RS03").decode(CanFrame(0xFD, bytes.fromhex("0100007ff7ff0137")))
    assert state.position == pytest.approx(-4.0 * pi)
    assert state.temperature == pytest.approx(31.1)


@pytest.mark.parametrize("model", ["damiao/DM4310", "tmotor/AK80-9", "robstride-mit/RS03", "xiaomi/CyberGear"])
@pytest.mark.parametrize("length", range(8))
def test_states_that_are_cut_short_or_anothers_are_none(model: str, length: int) -> None:
    made = motor(model)
    extended = model.startswith("xiaomi")
    identifier = 2 << 24 | 1 << 8 | 0xFD if extended else made.feedback_id
    whole = bytes.fromhex("01ffff8007ff4b00")
    assert made.decode(CanFrame(identifier, whole, extended)) is not None
    if not (model.startswith("tmotor") and length == 6):
        assert made.decode(CanFrame(identifier, whole[:length], extended)) is None
    assert made.decode(CanFrame(identifier ^ 0x40, whole, extended)) is None
    assert made.decode(CanFrame(identifier, whole, not extended)) is None


def test_profiles_are_data_with_a_source() -> None:
    profiles = vendor_profiles()
    assert {"damiao", "tmotor", "robstride", "robstride-mit", "xiaomi"} <= set(profiles)
    for name, profile in profiles.items():
        assert len(profile.source) > 20, name
        for model in profile.models:
            assert motor(f"{name}/{model}").ranges.torque > 0.0


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_a_value_that_is_not_finite_is_never_encoded(value: float) -> None:
    codec = MitCodec(MitRanges(12.5, 30.0, 10.0))
    with pytest.raises(AdapterValueError):
        codec.encode_torque(value)
    for place in range(5):
        values = [0.0] * 5
        values[place] = value
        with pytest.raises(AdapterValueError):
            codec.encode(*values)
    with pytest.raises(AdapterValueError):
        motor("xiaomi/CyberGear").torque_frame(value)


def test_the_gains_are_at_most_the_models() -> None:
    codec = MitCodec(MitRanges(12.5, 30.0, 10.0))
    assert codec.encode(99.0, 99.0, 9999.0, 99.0, 99.0) == b"\xff" * 8
    assert codec.encode(-99.0, -99.0, -1.0, -1.0, -99.0) == b"\x00" * 8


@pytest.mark.parametrize(("key", "value"), [("id", 0), ("id", 0x7FF), ("feedback_id", 0x7FF)])
def test_identifiers_that_the_protocol_keeps_for_itself_are_refused(key: str, value: int) -> None:
    table = joint_tables(1, 4.0, 7.0, model="damiao/DM4310")
    table[0][key] = value
    joint = convert({"bus": {"interface": "virtual"}, "joints": table}, MitConfiguration).joints[0]
    with pytest.raises(AdapterConfigurationError, match=key):
        make_motor(joint)

"""The CiA 402 twin refuses what a drive refuses, and leaves operational as 1029 says."""

from __future__ import annotations

import struct

import pytest

from fricomp.adapters import adapter_class
from fricomp.errors import AdapterError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.twins.canopen.cia402 import Cia402Drive
from tests.sim_bench.twins.rig import CanRig, can_rig


def download(rig: CanRig, index: int, subindex: int, value: int, size: int = 4) -> int:
    """Write by SDO; the abort code, 0 for none."""
    head = struct.pack("<BHB", 0x23 | (4 - size) << 2, index, subindex)
    answers = rig.ask(0x601, (head + value.to_bytes(4, "little")))
    (data,) = (data for identifier, data in answers if identifier == 0x581)
    return struct.unpack("<I", data[4:])[0] if data[0] == 0x80 else 0


@pytest.mark.parametrize(
    ("index", "value"), [(0x1800, 0x80000181), (0x1800, 0xE0000181), (0x1400, 0xC0000201)], ids=hex
)
def test_bits_29_and_30_of_a_cob_id_stay(index: int, value: int) -> None:
    with can_rig(Cia402Drive) as rig:
        assert download(rig, index, 1, value) == 0x06090030


def test_the_identifier_of_a_valid_pdo_stays() -> None:
    with can_rig(Cia402Drive) as rig:
        assert download(rig, 0x1400, 1, 0x201) == 0
        assert download(rig, 0x1400, 1, 0x222) == 0x06090030


def test_nothing_is_mapped_while_the_node_is_operational() -> None:
    with can_rig(Cia402Drive) as rig:
        rig.send(0, bytes((1, 1)))
        rig.twin.pump()
        assert download(rig, 0x1600, 0, 0, 1) == 0x08000022


def test_a_stopped_node_answers_no_sdo() -> None:
    with can_rig(Cia402Drive) as rig:
        assert rig.ask(0x601, bytes.fromhex("4000100000000000"))
        rig.send(0, bytes((2, 1)))
        rig.twin.pump()
        assert not rig.ask(0x601, bytes.fromhex("4000100000000000"))


@pytest.mark.parametrize(("behaviour", "state"), [(0, 127), (1, 5), (2, 4)])
def test_a_missed_heartbeat_ends_in_the_state_that_1029_names(behaviour: int, state: int) -> None:
    with can_rig(Cia402Drive) as rig:
        assert download(rig, 0x1029, 1, behaviour, 1) == 0
        assert download(rig, 0x1016, 1, 127 << 16 | 20) == 0
        rig.send(0, bytes((1, 1)))
        rig.send(0x77F, b"\5")
        rig.twin.pump()
        rig.steps(40)
        assert rig.twin.drives[0]._node.nmt._state == state


def test_a_position_goes_on_at_the_other_end_of_its_32_bits() -> None:
    with can_rig(Cia402Drive) as rig:
        drive: Cia402Drive = rig.twin.drives[0]
        drive._increments = 2.0**31 / 0.25 * 1.001  # the joint is at 0.25 rad
        assert drive.object_value(0x6064, 0) == pytest.approx(-(2**31) * 0.999, rel=1e-3)


def test_a_stopped_drive_is_woken_by_taking_over_alone() -> None:
    adapter = adapter_class("twin-canopen").from_configuration({})
    twin = adapter.twin  # type: ignore[attr-defined]
    twin.drives[0]._nmt(bytes((2, 1)))
    twin.drives[0].store(0x1017, 0, 20)
    twin.drives[0]._node.nmt.start_heartbeat(20)
    with pytest.raises(AdapterError, match=r"stopped by NMT .*--take-over"):
        adapter.open()
    adapter.open(take_over=True)
    adapter.configure("torque", 1e-3)
    adapter.close()


def test_a_drive_is_read_at_rest_after_a_motion_however_long_that_takes() -> None:
    """It must not go on watching a heartbeat that rests with it: it would leave operational, and send no state."""
    adapter = adapter_class("twin-canopen").from_configuration({})
    feedback = JointFeedback(1)
    with adapter:
        adapter.configure("torque", 1e-3)
        adapter.enable()
        for _ in range(50):
            assert adapter.write(JointCommand(1))
            adapter.clock.sleep_until(adapter.clock.now_ns() + 1_000_000)
            adapter.read_into(feedback)
        adapter.disable()
        fresh = 0
        for _ in range(2000):
            adapter.clock.sleep_until(adapter.clock.now_ns() + 1_000_000)
            fresh += adapter.read_into(feedback)
        assert fresh > 300
        assert feedback.fault == [0]
        adapter.enable()

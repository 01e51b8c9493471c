"""What somebody else has left in a drive: targets, offsets, state frames and a latched fault."""

from __future__ import annotations

from typing import Any

import pytest

from fricomp.adapters.link import CanFrame
from fricomp.errors import AdapterConfigurationError, AdapterTimeout, DriveFault
from fricomp.joint import JointFeedback
from fricomp.testing.steps import run, start
from tests.adapters.canopen.rig import CanOpenRig

OFFSETS_AND_TARGETS = (0x60B0, 0x60B1, 0x60B2, 0x6071, 0x60FF)


@pytest.fixture
def rig() -> CanOpenRig:
    return CanOpenRig()


@pytest.mark.parametrize("mode", ["torque", "velocity", "position"])
def test_targets_and_offsets_left_in_a_drive_exert_nothing(rig: CanOpenRig, mode: Any) -> None:
    for drive in rig.drives:
        for index in (*OFFSETS_AND_TARGETS, 0x607A):
            drive.store(index, 300)
        drive.position = 0.25
    rig.adapter.open()
    rig.adapter.configure(mode, rig.period)
    for drive in rig.drives:
        assert [drive.value(index) for index in OFFSETS_AND_TARGETS] == [0] * 5
    rig.adapter.enable()
    assert rig.applied_torque() == pytest.approx([0.0, 0.0])


def test_a_command_is_all_that_a_drive_exerts(rig: CanOpenRig) -> None:
    rig.drives[0].store(0x60B2, 300)
    rig.adapter.open()
    start(rig)
    run(rig, 3, torque=4.0)
    assert rig.applied_torque()[0] == pytest.approx(4.0)


def test_drives_without_offsets_are_configured_all_the_same(rig: CanOpenRig) -> None:
    for drive in rig.drives:
        drive.lack(0x60B0, 0x60B1, 0x60B2)
    rig.adapter.open()
    start(rig)
    assert run(rig, 3, torque=1.0)


@pytest.mark.parametrize("index", OFFSETS_AND_TARGETS)
def test_a_drive_that_keeps_an_offset_is_refused(rig: CanOpenRig, index: int) -> None:
    rig.drives[1].store(index, 300)
    rig.drives[1].stubborn.add(index)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match=f"joint 1.*keeps 300 in object {index:#06x}"):
        rig.adapter.configure("torque", rig.period)


@pytest.mark.parametrize(("left", "accepted"), [(0, True), (300, False)])
def test_an_offset_that_only_a_pdo_may_write_counts_by_what_it_holds(
    rig: CanOpenRig, left: int, accepted: bool
) -> None:
    rig.drives[0].store(0x60B2, left)
    rig.drives[0].node.object_dictionary[0x60B2].access_type = "ro"
    rig.adapter.open()
    if accepted:
        rig.adapter.configure("torque", rig.period)
        return
    with pytest.raises(AdapterConfigurationError, match="keeps 300 in object 0x60b2"):
        rig.adapter.configure("torque", rig.period)


def test_a_target_position_that_stays_elsewhere_is_refused(rig: CanOpenRig) -> None:
    rig.drives[0].store(0x607A, 65536)
    rig.drives[0].stubborn.add(0x607A)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match="keeps 65536 as its target position"):
        rig.adapter.configure("position", rig.period)


@pytest.mark.parametrize("identifier", [0x181, 0x281])
def test_state_frames_before_their_scaling_is_known_are_ignored(rig: CanOpenRig, identifier: int) -> None:
    """A drive left in operational, with a TPDO on a timer, speaks while it is being asked."""
    strays = [CanFrame(identifier, b"\xff" * n) for n in (7, 8)]
    rig.link.incoming = lambda frames: [*frames, *strays]
    rig.adapter.open()
    feedback = JointFeedback(2)
    assert not rig.adapter.read_into(feedback)
    rig.link.incoming = None
    start(rig)
    assert run(rig, 3, feedback)
    assert feedback.position == pytest.approx([0.0, 0.0])


def test_a_latched_fault_is_cleared_in_nodes_that_nobody_has_configured(rig: CanOpenRig) -> None:
    for drive in rig.drives:
        drive.outbox.clear()  # they booted long ago
    rig.drives[1].fault(0x7500)
    rig.adapter.open()
    rig.adapter.clear_faults()
    assert [drive.state for drive in rig.drives] == ["switch on disabled"] * 2
    assert not any(rig.energised())
    assert rig.drives[1].controlword == 0


def test_a_fault_that_stays_is_named_in_nodes_that_nobody_has_configured(rig: CanOpenRig) -> None:
    rig.drives[1].failed = True
    rig.drives[1].fault(0x7500)
    rig.adapter.open()
    with pytest.raises(DriveFault, match=r"node 2: fault\); error code 0x7500"):
        rig.adapter.clear_faults()


def test_clearing_a_node_that_falls_silent_says_so(rig: CanOpenRig) -> None:
    rig.adapter.open()
    rig.link.silent = True
    with pytest.raises(AdapterTimeout, match="node 1"):
        rig.adapter.clear_faults()

"""The drive's own limit, 6072: nothing else bounds what its loop asks for in velocity and position mode."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from fricomp.adapters.canopen import CanOpenAdapter
from fricomp.errors import AdapterConfigurationError
from fricomp.joint import JointCommand, JointFeedback
from fricomp.sim_bench.studies.adapters.bench import PERIOD, TORQUE_LIMIT, make_bench
from fricomp.testing.steps import run, start
from tests.adapters.canopen.rig import CanOpenRig, configuration

MAX_TORQUE = 0x6072
OWN_LOOP = ("velocity", "position")
LIMIT_COUNTS = [800, 400]
"""4 N·m and, behind a gear of two, 2 N·m, in thousandths of 5 N·m."""
FOUND = 2000


@pytest.fixture
def rig() -> CanOpenRig:
    return CanOpenRig()


def in_drives(rig: CanOpenRig) -> list[int]:
    return [drive.value(MAX_TORQUE) for drive in rig.drives]


def limited_to(torque: float) -> CanOpenRig:
    joints = configuration()["joints"]
    for joint in joints:
        joint["limits"] = joint["limits"] | {"torque": torque}
    return CanOpenRig(joints=joints)


def next_process(rig: CanOpenRig, torque: float) -> CanOpenAdapter:
    """An adapter on the same drives, after the first one was killed."""
    rig.clock.advance(1.0)
    rig.link.receive()
    return CanOpenAdapter(limited_to(torque).made, lambda: rig.link, rig.clock)


@pytest.mark.parametrize("mode", ["torque", *OWN_LOOP])
def test_the_limit_of_the_joint_stands_in_the_drive(rig: CanOpenRig, mode: Any) -> None:
    rig.adapter.open()
    rig.adapter.configure(mode, rig.period)
    assert in_drives(rig) == LIMIT_COUNTS


def test_it_is_rounded_toward_zero() -> None:
    rig = limited_to(3.999)
    rig.adapter.open()
    rig.adapter.configure("velocity", rig.period)
    assert in_drives(rig) == [799, 399]


@pytest.mark.parametrize("mode", OWN_LOOP)
def test_the_loop_of_a_drive_is_bound_by_it(rig: CanOpenRig, mode: Any) -> None:
    rig.adapter.open()
    rig.adapter.configure(mode, rig.period)
    rig.adapter.enable()
    command, feedback = JointCommand(2), JointFeedback(2)
    largest = [0.0, 0.0]
    for sign in (1.0, -1.0):
        command.torque[:] = [sign * 4.0] * 2
        command.velocity[:], command.position[:] = [sign * 20.0] * 2, [sign * 3.0] * 2
        for _ in range(300):
            assert rig.adapter.write(command)
            rig.clock.advance(rig.period)
            rig.adapter.read_into(feedback)
            largest = [max(pair) for pair in zip(largest, map(abs, rig.applied_torque()), strict=True)]
    assert largest == pytest.approx([4.0, 4.0])


@pytest.mark.parametrize("mode", OWN_LOOP)
def test_the_loop_of_the_twin_is_bound_by_it(mode: Any) -> None:
    bench = make_bench("canopen")
    bench.adapter.open()
    bench.adapter.configure(mode, PERIOD)
    bench.adapter.enable()
    bench.axes[0].command_gains(200.0, 20.0)
    command = JointCommand(1)
    command.velocity[0], command.position[0] = 8.0, 3.0
    for _ in range(60):
        bench.adapter.write(command)
        bench.clock.advance(PERIOD)
        bench.adapter.read_into(JointFeedback(1))
    assert bench.axes[0].largest_torque == pytest.approx(TORQUE_LIMIT)


def test_a_twin_that_brakes_in_a_quick_stop_keeps_to_it() -> None:
    bench = make_bench("canopen")
    bench.start()
    axis, drive = bench.axes[0], bench.twin.drives[0]
    axis.limit_torque(1e3)
    axis.velocity = 5.0
    drive.on_object_written(0x6040, 0, 0x02)
    axis.command_gains(0.0, 20.0)
    axis.command(0.0)
    assert axis.torque == pytest.approx(-TORQUE_LIMIT)


def lacking(rig: CanOpenRig) -> None:
    rig.drives[1].lack(MAX_TORQUE)


def read_only(rig: CanOpenRig) -> None:
    rig.drives[1].node.object_dictionary[MAX_TORQUE].access_type = "ro"


def stubborn(rig: CanOpenRig) -> None:
    rig.drives[1].stubborn.add(MAX_TORQUE)


@pytest.mark.parametrize("flaw", [lacking, read_only, stubborn])
@pytest.mark.parametrize("mode", OWN_LOOP)
def test_a_drive_that_does_not_take_it_has_torque_mode_only(rig: CanOpenRig, flaw: Any, mode: Any) -> None:
    flaw(rig)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match=rf"joint 1.*{mode} mode is refused.*2 N·m.*0x6072"):
        rig.adapter.configure(mode, rig.period)
    start(rig)
    assert run(rig, 3, torque=4.0)
    assert rig.applied_torque() == pytest.approx([4.0, 4.0])


def test_a_drive_that_keeps_a_lower_one_is_refused_in_torque_mode_too(rig: CanOpenRig) -> None:
    rig.adapter.open()
    rig.drives[1].store(MAX_TORQUE, 100)
    stubborn(rig)
    with pytest.raises(AdapterConfigurationError, match="joint 1"):
        rig.adapter.configure("torque", rig.period)


def test_a_limit_below_one_count_is_refused_where_the_drive_has_to_keep_it() -> None:
    rig = limited_to(0.004)
    rig.adapter.open()
    with pytest.raises(AdapterConfigurationError, match=r"below the 0\.005 N·m that object 6072 counts in"):
        rig.adapter.configure("velocity", rig.period)
    rig.adapter.configure("torque", rig.period)
    assert in_drives(rig) == [FOUND, FOUND]


def test_limits_that_are_cut_down_are_written_anew_and_what_was_found_comes_back(rig: CanOpenRig) -> None:
    adapter: Any = rig.adapter
    adapter.open()
    adapter.configure("velocity", rig.period)
    cut = tuple(replace(limit, torque=0.1 * limit.torque) for limit in adapter.options.limits)
    adapter.options = replace(adapter.options, limits=cut)
    adapter.configure("velocity", rig.period)
    assert in_drives(rig) == [80, 40]
    adapter.enable()
    adapter.close()
    assert in_drives(rig) == [FOUND, FOUND]


@pytest.mark.parametrize("mode", ["torque", *OWN_LOOP])
def test_what_the_drive_permitted_is_never_raised(rig: CanOpenRig, mode: Any) -> None:
    adapter: Any = rig.adapter
    adapter.open()
    adapter.configure(mode, rig.period)
    raised = tuple(replace(limit, torque=10.0 * limit.torque) for limit in adapter.options.limits)
    adapter.options = replace(adapter.options, limits=raised)
    with pytest.raises(AdapterConfigurationError, match="torque limit 40 is beyond the drive's 10"):
        adapter.configure(mode, rig.period)
    assert in_drives(rig) == LIMIT_COUNTS


@pytest.mark.parametrize("mode", ["torque", *OWN_LOOP])
def test_clearing_a_drive_that_was_power_cycled_restores_the_limit_that_the_gate_knows(
    rig: CanOpenRig, mode: Any
) -> None:
    adapter: Any = rig.adapter
    adapter.open()
    adapter.configure(mode, rig.period)
    raised = tuple(replace(limit, torque=2.4 * limit.torque) for limit in adapter.options.limits)
    adapter.options = replace(adapter.options, limits=raised)  # within the drives', and no gate has seen it
    for joint in range(len(rig.drives)):
        rig.power_cycle(joint)
    rig.clock.advance(1.0)
    adapter.read_into(JointFeedback(len(rig.drives)))
    adapter.clear_faults()
    assert in_drives(rig) == LIMIT_COUNTS


def test_a_drive_that_may_still_be_energised_keeps_the_lower_one(rig: CanOpenRig) -> None:
    rig.adapter.open()
    start(rig)
    rig.link.full = True
    rig.adapter.close()
    rig.link.full = False
    assert any(rig.energised())
    assert in_drives(rig) == LIMIT_COUNTS


def test_a_drive_that_does_not_obey_the_stop_keeps_the_lower_one(rig: CanOpenRig) -> None:
    rig.adapter.open()
    start(rig)
    rig.drives[0].obey = lambda word: None  # type: ignore[method-assign]
    rig.adapter.close()
    assert in_drives(rig) == [LIMIT_COUNTS[0], FOUND]


def test_a_killed_run_leaves_a_limit_that_the_same_run_accepts() -> None:
    rig = limited_to(3.999)
    rig.adapter.open()
    start(rig)
    after = next_process(rig, 3.999)
    assert after.open().joints[0].torque_limit == pytest.approx(3.999)


def test_a_killed_run_leaves_a_limit_beyond_which_the_next_says_what_to_do(rig: CanOpenRig) -> None:
    rig.adapter.open()
    start(rig)
    with pytest.raises(AdapterConfigurationError, match=r"joint 0.*4\.5 N·m.*drive's 4 \(6072\).*until the drive rest"):
        next_process(rig, 4.5).open()

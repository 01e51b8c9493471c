"""Our heartbeat while nobody reads or writes: no drive misses it at rest, and none is energised that has."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from fricomp.adapters.link import CanFrame
from fricomp.errors import AdapterError, AdapterTimeout, DriveFault
from fricomp.joint import JointFeedback
from fricomp.sim_bench.studies.adapters.bench import PERIOD, make_bench
from fricomp.testing.steps import run, start
from tests.adapters.canopen.rig import CanOpenRig

OUR_HEARTBEAT = 0x700 + 127


@pytest.fixture
def rig() -> CanOpenRig:
    made = CanOpenRig()
    made.adapter.open()
    start(made)
    run(made, 20)
    return made


def read_on(rig: Any, seconds: float) -> None:
    feedback = JointFeedback(len(rig.adapter.options.limits))
    for _ in range(round(seconds / 0.005)):
        rig.clock.advance(0.005)
        rig.adapter.read_into(feedback)


def fall_silent(rig: Any, seconds: float) -> None:
    rig.clock.advance(seconds)


PAUSES = pytest.mark.parametrize("pause", [read_on, fall_silent])
SECONDS = pytest.mark.parametrize("seconds", [0.0, 0.05, 0.2, 3.0])


@SECONDS
@PAUSES
def test_enabling_works_any_time_after_clearing(
    rig: CanOpenRig, pause: Callable[[Any, float], None], seconds: float
) -> None:
    rig.adapter.safe_stop()
    pause(rig, 0.3)
    rig.adapter.clear_faults()
    pause(rig, seconds)
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 100, torque=1.0)
    assert rig.applied_torque() == pytest.approx([1.0, 1.0])


@SECONDS
@PAUSES
def test_enabling_a_twin_works_any_time_after_clearing(pause: Callable[[Any, float], None], seconds: float) -> None:
    bench = make_bench("canopen")
    bench.start()
    bench.adapter.safe_stop()
    bench.adapter.clear_faults()
    pause(bench, seconds)
    bench.adapter.enable()
    bench.clock.advance(PERIOD)
    read_on(bench, PERIOD)
    assert bench.adapter.enabled
    assert not bench.adapter.gate.tripped


@PAUSES
def test_enabling_works_any_time_after_configuring(pause: Callable[[Any, float], None]) -> None:
    rig = CanOpenRig()
    rig.adapter.open()
    rig.adapter.configure("torque", rig.period)
    pause(rig, 3.0)
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 20)


@PAUSES
def test_a_drive_that_complains_all_the_same_is_not_enabled(
    rig: CanOpenRig, pause: Callable[[Any, float], None]
) -> None:
    """Its consumer goes on watching although it was told anew."""
    rig.drives[0].forgives = False
    rig.adapter.safe_stop()
    rig.adapter.clear_faults()
    pause(rig, 1.0)
    rig.link.recording = True
    with pytest.raises(DriveFault, match=r"node 1 reports emergency 0x8130 \(.*watchdog\): clear_faults\(\)"):
        rig.adapter.enable()
    words = [frame.data[:2] for sent in rig.link.sent for frame in sent if frame.identifier == 0x201]
    assert set(words) <= {b"\0\0"}
    assert not any(rig.energised())
    rig.adapter.clear_faults()
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 20)


def test_an_emergency_without_a_fault_state_is_not_enabled_either() -> None:
    bench = make_bench("canopen")
    bench.adapter.open()
    bench.adapter.configure("torque", PERIOD)
    bench.twin.drives[0].emergency(0x8130, 0x11)
    with pytest.raises(DriveFault, match="0x8130"):
        bench.adapter.enable()
    assert not bench.axes[0].energised
    bench.adapter.clear_faults()
    bench.adapter.enable()


def test_a_drive_that_left_operational_with_the_heartbeat_is_started_again_by_clearing(rig: CanOpenRig) -> None:
    for drive in rig.drives:
        drive.leaves_operational = True
    rig.adapter.safe_stop()
    fall_silent(rig, 0.5)
    assert not any(drive.operational for drive in rig.drives)
    rig.adapter.clear_faults()
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 20)


def test_the_drives_watch_us_before_they_are_energised(rig: CanOpenRig) -> None:
    """Also where the last heartbeat went out just before."""
    rig.adapter.safe_stop()
    rig.adapter.clear_faults()
    rig.link.recording = True
    rig.adapter.enable()
    frames = [frame for sent in rig.link.sent for frame in sent]
    enabling = next(n for n, frame in enumerate(frames) if frame.identifier == 0x201 and frame.data[0] == 0x0F)
    assert OUR_HEARTBEAT in [frame.identifier for frame in frames[:enabling]]
    rig.clock.advance(0.2)
    assert not any(rig.energised())


def test_a_watchdog_that_cannot_be_set_anew_is_an_error_and_not_enabled() -> None:
    rig = CanOpenRig()
    rig.adapter.open()
    rig.adapter.configure("torque", rig.period)
    rig.drives[1].stubborn.add(0x1016)
    rig.drives[1].set_data(0x1016, 1, bytes(4))
    with pytest.raises(AdapterError, match="no longer keep the watchdog"):
        rig.adapter.clear_faults()
    with pytest.raises(AdapterError, match="not configured to the end"):
        rig.adapter.enable()
    assert not any(rig.energised())


def test_drives_that_fall_silent_are_neither_cleared_nor_enabled(rig: CanOpenRig) -> None:
    rig.adapter.safe_stop()
    rig.link.silent = True
    with pytest.raises(AdapterTimeout, match="0x6041"):
        rig.adapter.clear_faults()
    rig.link.silent = False
    rig.adapter.clear_faults()
    rig.link.silent = True
    with pytest.raises(AdapterTimeout, match="0x6041"):
        rig.adapter.enable()


def test_drives_that_were_not_configured_to_the_end_are_not_enabled(rig: CanOpenRig) -> None:
    rig.adapter.safe_stop()
    rig.adapter.clear_faults()
    rig.drives[1].stubborn.add(0x6072)
    rig.drives[1].set_data(0x6072, 0, b"\xff\x0f")
    with pytest.raises(AdapterError, match="velocity mode is refused"):
        rig.adapter.configure("velocity", rig.period)
    rig.adapter.clear_faults()
    with pytest.raises(AdapterError, match="not configured to the end"):
        rig.adapter.enable()
    rig.adapter.configure("torque", rig.period)
    rig.adapter.enable()
    rig.clock.advance(rig.period)
    assert run(rig, 3, torque=1.0)


def test_our_heartbeat_rests_with_the_drives(rig: CanOpenRig) -> None:
    rig.adapter.safe_stop()
    rig.adapter.clear_faults()
    rig.link.recording = True
    read_on(rig, 0.5)
    assert {frame for sent in rig.link.sent for frame in sent} == {CanFrame(0x080)}

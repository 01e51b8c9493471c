"""The adapter base holds the order of calls, the gate and the stop, whatever the driver does."""

from __future__ import annotations

import subprocess
import sys
import threading
from dataclasses import replace
from math import inf, nan, pi
from pathlib import Path
from typing import Any

import pytest

from fricomp.adapters import AdapterOptions, Transmission
from fricomp.control import JointLimits
from fricomp.errors import (
    AdapterConfigurationError,
    AdapterConnectionError,
    AdapterError,
    AdapterTimeout,
    DriveFault,
    FricompError,
    SafetyTrip,
)
from fricomp.joint import CommandMode, JointCapabilities, JointFeedback, Watchdog
from tests.adapters.fake_driver import LIMITS, PERIOD, FakeAdapter, command, enabled_adapter, run_in_thread


def test_opening_and_configuring_energise_nothing() -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("torque", PERIOD)
    assert adapter.log == ["open", "configure"]
    assert not adapter.enabled


@pytest.mark.parametrize("error", [AdapterConnectionError("gone"), ValueError("foreign"), KeyboardInterrupt()])
def test_an_opening_that_fails_lets_go_of_the_bus(error: BaseException) -> None:
    adapter = FakeAdapter()
    adapter.fail["open"] = error
    with pytest.raises((FricompError, KeyboardInterrupt)):
        adapter.open()
    assert adapter.log == ["open", "close"]


def test_opening_twice_is_refused() -> None:
    adapter = FakeAdapter()
    adapter.open()
    with pytest.raises(AdapterError, match="open already"):
        adapter.open()


@pytest.mark.parametrize(
    ("limits", "what"),
    [
        (JointLimits(torque=5.1, torque_rate=1.0, velocity=1.0), "torque limit 5.1 is beyond the drive's 5"),
        (JointLimits(torque=1.0, torque_rate=1.0, velocity=51.0), "velocity limit 51 is beyond the drive's 50"),
    ],
)
def test_limits_beyond_the_drive_are_refused(limits: JointLimits, what: str) -> None:
    with pytest.raises(AdapterConfigurationError, match=what):
        FakeAdapter(AdapterOptions(limits=(limits,))).open()


def test_limits_for_another_number_of_joints_are_refused() -> None:
    with pytest.raises(AdapterConfigurationError, match="2 limits given for 1 joints"):
        FakeAdapter(AdapterOptions(limits=(LIMITS, LIMITS))).open()


@pytest.mark.parametrize("period", [0.0, -1.0, nan, inf, 0.0009])
def test_a_period_the_bus_cannot_carry_is_refused(period: float) -> None:
    adapter = FakeAdapter()
    adapter.open()
    with pytest.raises(AdapterConfigurationError, match="period"):
        adapter.configure("torque", period)


def test_a_watchdog_shorter_than_two_periods_is_refused() -> None:
    adapter = FakeAdapter(watchdog=Watchdog(0.0015, True))
    adapter.open()
    with pytest.raises(AdapterConfigurationError, match="two periods"):
        adapter.configure("torque", PERIOD)


@pytest.mark.parametrize("watchdog", [None, Watchdog(0.1, confirmed=False)])
def test_a_drive_without_confirmed_watchdog_is_enabled_only_when_told_to(watchdog: Watchdog | None) -> None:
    adapter = FakeAdapter(watchdog=watchdog)
    adapter.open()
    adapter.configure("torque", PERIOD)
    with pytest.raises(AdapterError, match="no confirmed watchdog"):
        adapter.enable()
    assert "enable" not in adapter.log
    options = AdapterOptions(limits=(LIMITS,), allow_no_watchdog=True)
    assert enabled_adapter(options=options, watchdog=watchdog).enabled


def test_the_ramp_begins_when_the_drive_is_ready_and_not_before() -> None:
    adapter = FakeAdapter(AdapterOptions(limits=(LIMITS,), ramp_time=0.2))
    adapter.fail["enable"] = lambda: adapter.manual_clock.advance(0.5)
    adapter.open()
    adapter.configure("torque", PERIOD)
    adapter.enable()
    assert adapter.write(command(torque=2.0))
    assert adapter.sent == [0.0]


@pytest.mark.parametrize("error", [DriveFault("over-voltage"), RuntimeError("foreign"), KeyboardInterrupt()])
def test_an_enabling_that_fails_ends_in_a_stop(error: BaseException) -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("torque", PERIOD)
    adapter.fail["enable"] = error
    with pytest.raises((AdapterError, KeyboardInterrupt)):
        adapter.enable()
    assert adapter.log[-1] == "stop"
    assert not adapter.enabled


@pytest.mark.parametrize("from_thread", [True, False])
def test_a_stop_during_enabling_wins(from_thread: bool) -> None:
    """From another thread, or from a signal handler in the enabling thread itself."""
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("torque", PERIOD)
    adapter.fail["enable"] = (lambda: run_in_thread(adapter.safe_stop)) if from_thread else adapter.safe_stop
    with pytest.raises(SafetyTrip, match="stop"):
        adapter.enable()
    assert adapter.log[-1] == "stop"
    assert not adapter.enabled


@pytest.mark.parametrize("value", [nan, inf, -inf])
def test_a_torque_that_is_not_finite_stops_and_sends_nothing(value: float) -> None:
    adapter = enabled_adapter()
    assert not adapter.write(command(torque=value))
    assert adapter.sent == []
    assert adapter.log[-1] == "stop"


def test_over_range_saturates_with_the_right_sign() -> None:
    adapter = enabled_adapter()
    for torque in (3.0, -3.0):
        adapter.manual_clock.advance(PERIOD)
        assert adapter.write(command(torque=torque))
    assert adapter.sent == [2.0, -2.0]


def test_a_stop_cannot_be_overtaken_by_torque() -> None:
    adapter = enabled_adapter()
    adapter.safe_stop()
    written = len(adapter.sent)
    assert not adapter.write(command(torque=1.0))
    assert len(adapter.sent) == written
    assert adapter.log[-1] == "stop"


def test_a_stop_from_a_signal_handler_in_mid_write_comes_after_the_write_and_does_not_hang() -> None:
    adapter = enabled_adapter()
    adapter.fail["write"] = adapter.safe_stop
    assert not adapter.write(command())
    assert adapter.log[-2:] == ["write", "stop"]
    assert not adapter.enabled


def test_a_stop_is_not_held_up_by_a_write_that_hangs() -> None:
    adapter = enabled_adapter()
    hanging, released = threading.Event(), threading.Event()

    def hang() -> None:
        hanging.set()
        assert released.wait(5.0)

    adapter.fail["write"] = hang
    writer = threading.Thread(target=adapter.write, args=(command(),))
    writer.start()
    assert hanging.wait(5.0)
    adapter.safe_stop("emergency")
    assert adapter.log[-1] == "stop"
    released.set()
    writer.join(5.0)
    # What the hung write may still have sent is followed by one more stop.
    assert adapter.log[-1] == "stop"
    assert not adapter.write(command(torque=1.0))


def test_stops_from_many_threads_are_one_stop() -> None:
    adapter = enabled_adapter()

    def stop_slowly() -> None:
        threading.Event().wait(5e-3)  # long enough for all of them to meet

    adapter.fail["stop"] = stop_slowly
    threads = [threading.Thread(target=adapter.safe_stop) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join(5.0)
    assert adapter.log.count("stop") == 1


def test_a_stop_waits_for_a_write_in_progress_and_follows_it() -> None:
    adapter = enabled_adapter()
    writing = threading.Event()

    def write_slowly() -> None:
        writing.set()
        threading.Event().wait(20e-3)
        adapter.log.append("write done")

    adapter.fail["write"] = write_slowly
    writer = threading.Thread(target=adapter.write, args=(command(torque=1.0),))
    writer.start()
    assert writing.wait(5.0)
    adapter.safe_stop("operator")
    writer.join(5.0)
    assert "stop" not in adapter.log[: adapter.log.index("write done")]
    assert adapter.log[-1] == "stop"


def test_clearing_faults_of_energised_joints_stops_them_first_and_leaves_them_off() -> None:
    adapter = enabled_adapter()
    adapter.write(command(torque=1.0))
    adapter.clear_faults()
    assert adapter.log[-2:] == ["stop", "clear"]
    assert not adapter.enabled
    with pytest.raises(AdapterError, match="enable"):
        adapter.write(command(torque=1.0))


@pytest.mark.parametrize("error", [AdapterConnectionError("cable"), ValueError("foreign")])
def test_a_stop_that_fails_never_raises_and_is_tried_twice_and_told(error: Exception) -> None:
    adapter = enabled_adapter()
    adapter.fail["stop"] = error
    adapter.safe_stop()
    assert adapter.log.count("stop") == 2
    assert "did not reach the drive" in str(adapter.health()["stop_failure"])


def test_a_stop_that_failed_is_owed_until_one_gets_through() -> None:
    adapter = enabled_adapter()
    adapter.fail["stop"] = AdapterConnectionError("the queue is full")
    adapter.safe_stop()
    for again in (adapter.safe_stop, lambda: adapter.write(command(torque=1.0))):
        before = adapter.log.count("stop")
        again()
        assert adapter.log.count("stop") > before
    assert adapter.sent == []
    with pytest.raises(AdapterError, match="did not reach the drive"):
        adapter.clear_faults()
    with pytest.raises(SafetyTrip):
        adapter.enable()
    adapter.fail.clear()
    adapter.safe_stop()
    assert adapter.stop_failure == ""
    count = adapter.log.count("stop")
    adapter.safe_stop()
    assert adapter.log.count("stop") == count
    adapter.clear_faults()
    adapter.enable()


def test_a_stop_that_is_interrupted_and_then_fails_is_told_and_owed(monkeypatch: pytest.MonkeyPatch) -> None:
    adapter = enabled_adapter()
    errors = iter([KeyboardInterrupt(), AdapterConnectionError("cable")])

    def stop() -> None:
        raise next(errors)

    monkeypatch.setattr(adapter, "_stop", stop)
    with pytest.raises(KeyboardInterrupt):
        adapter.safe_stop()
    assert "did not reach the drive: cable" in adapter.stop_failure
    monkeypatch.undo()
    adapter.safe_stop()
    assert adapter.stop_failure == ""


def test_closing_tries_an_owed_stop_again() -> None:
    adapter = enabled_adapter()
    adapter.fail["stop"] = AdapterConnectionError("the queue is full")
    adapter.safe_stop()
    adapter.fail.clear()
    adapter.close()
    assert adapter.log.count("stop") == 3
    assert adapter.stop_failure == ""


def test_a_stop_that_is_owed_is_paid_before_the_adapter_opens_again() -> None:
    adapter = enabled_adapter()
    adapter.fail["stop"] = AdapterConnectionError("the cable is out")
    adapter.close()
    assert "cable" in adapter.stop_failure
    with pytest.raises(AdapterError, match="cable"):
        adapter.open()
    del adapter.fail["stop"]
    adapter.open()
    assert (adapter.log[-1], adapter.stop_failure) == ("stop", "")


@pytest.mark.parametrize("from_this_thread", [True, False])
def test_a_stop_while_the_position_is_being_read_keeps_the_drives_off(from_this_thread: bool) -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("position", PERIOD)

    def stop() -> None:
        if from_this_thread:  # as a signal handler does
            adapter.safe_stop("emergency")
            return
        thread = threading.Thread(target=adapter.safe_stop)
        thread.start()
        thread.join(5.0)

    adapter.fail["read"] = stop
    with pytest.raises(SafetyTrip):
        adapter.enable()
    assert "enable" not in adapter.log
    assert not adapter.enabled


def test_a_temperature_that_the_drive_does_not_report_cannot_be_limited() -> None:
    limits = replace(LIMITS, temperature=65.0)
    adapter = FakeAdapter(AdapterOptions(limits=(limits,)))
    adapter.reports_temperature = False
    with pytest.raises(AdapterConfigurationError, match="does not report its temperature"):
        adapter.open()


def test_an_interrupt_in_the_middle_of_a_stop_does_not_prevent_it() -> None:
    adapter = enabled_adapter()
    interrupts = iter([KeyboardInterrupt()])

    def interrupt_once() -> None:
        for interrupt in interrupts:
            raise interrupt

    adapter.fail["stop"] = interrupt_once
    with pytest.raises(KeyboardInterrupt):
        adapter.safe_stop()
    assert adapter.log.count("stop") == 2


@pytest.mark.parametrize("error", [AdapterConnectionError("cable"), IndexError("foreign"), KeyboardInterrupt()])
@pytest.mark.parametrize("place", ["write", "read"])
def test_whatever_fails_in_the_cycle_stops_the_joints(error: BaseException, place: str) -> None:
    adapter = enabled_adapter()
    adapter.fail[place] = error
    with pytest.raises((AdapterError, KeyboardInterrupt)):
        adapter.write(command(torque=1.0)) if place == "write" else adapter.read_into(JointFeedback(1))
    assert adapter.log[-1] == "stop"
    assert adapter.gate.tripped
    adapter.fail.clear()
    assert not adapter.write(command(torque=1.0))
    assert adapter.sent == []


def test_nothing_enables_again_without_clearing_the_faults() -> None:
    adapter = enabled_adapter()
    adapter.safe_stop()
    with pytest.raises(SafetyTrip):
        adapter.enable()
    with pytest.raises(AdapterError, match="clear_faults"):
        adapter.configure("torque", PERIOD)
    adapter.clear_faults()
    assert not adapter.enabled
    adapter.enable()
    assert adapter.enabled


def test_faults_that_stay_keep_the_gate_latched() -> None:
    adapter = enabled_adapter()
    adapter.safe_stop()
    adapter.fail["clear"] = DriveFault("still there")
    with pytest.raises(DriveFault):
        adapter.clear_faults()
    with pytest.raises(SafetyTrip):
        adapter.enable()


def test_configuring_and_enabling_are_refused_while_enabled() -> None:
    adapter = enabled_adapter()
    with pytest.raises(AdapterError, match="enabled"):
        adapter.configure("torque", PERIOD)
    with pytest.raises(AdapterError, match="enabled already"):
        adapter.enable()


@pytest.mark.parametrize(
    ("attribute", "value"), [("velocity", 11.0), ("position", 3.1), ("fault", 7), ("velocity", nan)]
)
def test_a_state_outside_the_limits_stops_the_joints(attribute: str, value: float) -> None:
    adapter = enabled_adapter()
    setattr(adapter, attribute, value)
    adapter.read_into(JointFeedback(1))
    assert adapter.log[-1] == "stop"
    assert not adapter.write(command(torque=1.0))


def test_silence_of_the_drives_stops_the_joints() -> None:
    adapter = enabled_adapter()
    adapter.read_into(JointFeedback(1))
    adapter.fresh = False
    adapter.manual_clock.advance(0.021)
    assert not adapter.read_into(JointFeedback(1))
    assert adapter.gate.trip_record is not None
    assert adapter.gate.trip_record.reason == "stale"
    assert adapter.log[-1] == "stop"


def test_sign_and_gear_are_applied_once_in_both_directions() -> None:
    gear = Transmission(gear_ratio=4.0, sign=-1, zero=0.25)
    options = AdapterOptions(limits=(LIMITS,), transmissions=(gear,), ramp_time=0.0)
    adapter = enabled_adapter(options=options)
    feedback = JointFeedback(1)
    adapter.position, adapter.velocity = 2.0, 8.0
    adapter.read_into(feedback)
    assert feedback.position[0] == pytest.approx(-2.0 / 4.0 - 0.25)
    assert feedback.velocity[0] == pytest.approx(-2.0)
    for _ in range(2):
        adapter.manual_clock.advance(PERIOD)
        adapter.write(command(torque=1.0))
    assert adapter.sent[-1] == pytest.approx(-0.25)
    assert adapter.capabilities.joints[0].torque_limit == pytest.approx(20.0)


def test_a_linear_joint_is_told_in_metres_and_newtons() -> None:
    """A screw of 5 mm a turn."""
    screw = Transmission(gear_ratio=2.0 * pi / 5e-3, motion="linear")
    limits = JointLimits(torque=1000.0, torque_rate=1e9, velocity=0.03, position=(-0.1, 0.1))
    adapter = FakeAdapter(AdapterOptions(limits=(limits,), transmissions=(screw,), ramp_time=0.0))
    joint = adapter.open().joints[0]
    assert (joint.motion, joint.torque_unit) == ("linear", "N")
    assert joint.torque_limit == pytest.approx(5.0 * 2.0 * pi / 5e-3)
    assert joint.velocity_limit == pytest.approx(50.0 * 5e-3 / (2.0 * pi))
    adapter.configure("torque", PERIOD)
    adapter.enable()
    adapter.position = 2.0 * pi
    feedback = JointFeedback(1)
    adapter.read_into(feedback)
    assert feedback.position[0] == pytest.approx(5e-3)
    with pytest.raises(AdapterConfigurationError, match="rotary"):
        Transmission(motion="sideways")  # type: ignore[arg-type]


def test_a_position_reference_passes_sign_gear_and_zero_the_other_way() -> None:
    gear = Transmission(gear_ratio=4.0, sign=-1, zero=0.25)
    options = AdapterOptions(limits=(LIMITS,), transmissions=(gear,), ramp_time=0.0)
    adapter = enabled_adapter("position", options=options)
    feedback = JointFeedback(1)
    adapter.read_into(feedback)
    adapter.manual_clock.advance(PERIOD)
    adapter.write(command(position=feedback.position[0]))  # stay where you are
    assert adapter.references[-1][1] == pytest.approx(adapter.position)


@pytest.mark.parametrize("mode", ["torque", "velocity", "position"])
def test_what_a_mode_leaves_alone_does_not_turn_with_every_cycle(mode: CommandMode) -> None:
    gear = Transmission(gear_ratio=6.0, zero=0.1)
    options = AdapterOptions(limits=(replace(LIMITS, velocity=8.0),), transmissions=(gear,), ramp_time=0.0)
    adapter = enabled_adapter(mode, options=options)
    for _ in range(100):
        adapter.manual_clock.advance(PERIOD)
        adapter.read_into(JointFeedback(1))
        assert adapter.write(command())
    assert adapter.references[-1] == pytest.approx((0.0, 6.0 * 0.1))  # joint position 0 is the drive's 0.6


def test_a_position_reference_never_leaves_the_range() -> None:
    adapter = enabled_adapter("position")
    for _ in range(400):
        adapter.manual_clock.advance(PERIOD)
        adapter.read_into(JointFeedback(1))
        assert adapter.write(command(position=99.0))
    assert adapter.references[-1][1] == pytest.approx(3.0)


def test_a_torque_that_runs_over_behind_the_gear_stops_and_sends_nothing() -> None:
    limits = replace(LIMITS, torque=1e-300)
    options = AdapterOptions(limits=(limits,), transmissions=(Transmission(gear_ratio=1e-300),), ramp_time=0.0)
    adapter = enabled_adapter(options=options)
    adapter._drive.command.torque[0] = 1e300  # as a driver would find it, past the gate
    with pytest.raises(AdapterError, match="not finite"):
        adapter._drive.command_from_joint()


def test_position_limits_beyond_the_drives_own_are_refused() -> None:
    adapter = FakeAdapter(AdapterOptions(limits=(replace(LIMITS, position=(-13.0, 13.0)),)))
    adapter.position_limits = (-12.5, 12.5)
    with pytest.raises(AdapterConfigurationError, match="position"):
        adapter.open()


@pytest.mark.parametrize("wrong", [[], [0.1, 0.2], [None], ["a"], [10**400]])
def test_references_that_are_none_stop_the_joints(wrong: list[Any]) -> None:
    adapter = enabled_adapter("position")
    bad = command()
    bad.position = wrong
    adapter.manual_clock.advance(PERIOD)
    assert not adapter.write(bad)
    assert adapter.log[-1] == "stop"
    assert adapter.references == []


def test_a_position_reference_starts_where_the_joint_is_and_cannot_jump() -> None:
    adapter = enabled_adapter("position")
    for wanted, reached in ((2.9, 0.5 + LIMITS.velocity * PERIOD), (-2.9, 0.5)):
        adapter.manual_clock.advance(PERIOD)
        adapter.write(command(position=wanted))
        assert adapter.references[-1][1] == pytest.approx(reached)


@pytest.mark.parametrize("pause", [0.1 * PERIOD, 1.5 * PERIOD])
def test_a_position_reference_is_no_faster_than_the_velocity_limit_however_often_it_is_written(pause: float) -> None:
    adapter = enabled_adapter("position")
    for _ in range(10):
        adapter.manual_clock.advance(pause)
        adapter.write(command(position=2.9))
    assert adapter.references[-1][1] == pytest.approx(0.5 + 10 * LIMITS.velocity * min(pause, PERIOD))


def test_limits_that_were_exchanged_after_opening_are_checked_before_a_gate_is_made_of_them() -> None:
    adapter = FakeAdapter()
    adapter.open()
    for limits in ((replace(LIMITS, torque=5.1),), (replace(LIMITS, velocity=51.0),), (LIMITS, LIMITS)):
        adapter.options = AdapterOptions(limits=limits)
        with pytest.raises(AdapterConfigurationError):
            adapter.configure("torque", PERIOD)
    adapter.options = AdapterOptions(limits=(LIMITS,), transmissions=(Transmission(gear_ratio=2.0),))
    with pytest.raises(AdapterConfigurationError, match="opened with"):
        adapter.configure("torque", PERIOD)


@pytest.mark.parametrize("during", ["configure", "clear"])
def test_a_stop_from_another_thread_is_not_forgotten_whatever_the_adapter_was_doing(during: str) -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("torque", PERIOD)
    adapter.fail[during] = lambda: run_in_thread(lambda: adapter.safe_stop("operator"))
    if during == "configure":
        adapter.configure("torque", PERIOD)
    else:
        adapter.clear_faults()
    assert str(adapter.gate.trip_record) == "stop: operator"
    with pytest.raises(SafetyTrip, match="operator"):
        adapter.enable()
    with pytest.raises(AdapterError, match="operator"):
        adapter.configure("torque", PERIOD)
    adapter.fail.clear()
    adapter.clear_faults()
    adapter.configure("torque", PERIOD)
    adapter.enable()


def test_after_a_configuration_that_failed_nothing_is_enabled_until_one_ends() -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("torque", 1e-3)
    adapter.fail["configure"] = AdapterTimeout("no answer")
    with pytest.raises(AdapterTimeout):
        adapter.configure("velocity", 1e-3)
    with pytest.raises(AdapterError, match="not configured to the end"):
        adapter.enable()
    assert "enable" not in adapter.log
    del adapter.fail["configure"]
    adapter.configure("velocity", 1e-3)
    adapter.enable()
    assert adapter.enabled


@pytest.mark.parametrize("wrong", [{"stale_after": nan}, {"stale_after": 0.0}, {"ramp_time": -1.0}])
def test_options_of_which_no_gate_can_be_made_are_refused_before_the_drives_hear_of_them(wrong: dict[str, Any]) -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("torque", PERIOD)
    gate, told = adapter.gate, len(adapter.log)
    adapter.options = replace(adapter.options, **wrong)
    with pytest.raises(AdapterConfigurationError, match=next(iter(wrong))):
        adapter.configure("velocity", PERIOD)
    assert adapter.gate is gate
    assert len(adapter.log) == told


def test_a_stop_before_configuring_is_not_forgotten() -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.safe_stop("operator")
    adapter.configure("torque", PERIOD)
    with pytest.raises(SafetyTrip, match="operator"):
        adapter.enable()
    adapter.close()
    adapter.open()
    adapter.configure("torque", PERIOD)
    adapter.enable()


def test_a_motion_that_is_disabled_ends_at_zero_torque_and_keeps_no_stop_from_holding() -> None:
    adapter = enabled_adapter()
    adapter.disable()
    assert adapter.log[-1] == "stop"
    assert not adapter.enabled
    assert adapter.gate.trip_record is None
    with pytest.raises(AdapterError, match="not enabled"):
        adapter.write(command(torque=1.0))
    adapter.enable()
    adapter.safe_stop("operator")
    adapter.disable()
    with pytest.raises(SafetyTrip, match="operator"):
        adapter.enable()


def test_disabling_says_when_the_stop_did_not_get_through() -> None:
    adapter = enabled_adapter()
    adapter.fail["stop"] = AdapterConnectionError("cable")
    with pytest.raises(AdapterError, match="did not reach the drive"):
        adapter.disable()
    assert adapter.gate.tripped


def test_torque_in_amperes_passes_a_gear_unscaled_in_what_the_drive_declares_too() -> None:
    drive = JointCapabilities("j", torque_unit="A", torque_quantum=2.69e-3, torque_limit=3.2, velocity_limit=10.0)
    seen = Transmission(gear_ratio=5.0, sign=-1).capabilities_to_joint(drive)
    assert (seen.torque_limit, seen.torque_quantum, seen.velocity_limit) == (3.2, 2.69e-3, 2.0)
    turned = Transmission(gear_ratio=5.0).capabilities_to_joint(replace(drive, torque_unit="N·m"))
    assert turned.torque_limit == pytest.approx(16.0)


def test_a_position_reference_does_not_start_at_an_old_position() -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("position", PERIOD)
    adapter.read_into(JointFeedback(1))
    adapter.manual_clock.advance(1.0)
    old = adapter.manual_clock.time_ns - 1

    def read() -> None:  # what was asked for before enabling comes first, at the old position
        reads = adapter.log.count("read")
        adapter.position, adapter.taken_ns = (0.5, old) if reads < 4 else (1.5, None)

    adapter.fail["read"] = read
    adapter.enable()
    adapter.write(command(position=1.5))
    assert adapter.references[-1][1] == pytest.approx(1.5)


def test_a_position_that_is_not_known_cannot_be_held() -> None:
    adapter = FakeAdapter()
    adapter.open()
    adapter.configure("position", PERIOD)
    adapter.position = nan
    with pytest.raises(AdapterError, match="not known"):
        adapter.enable()


@pytest.mark.parametrize("value", [nan, inf])
def test_a_reference_that_is_not_finite_stops_the_joints(value: float) -> None:
    adapter = enabled_adapter("velocity")
    assert not adapter.write(command(velocity=value))
    assert adapter.sent == []
    assert adapter.log[-1] == "stop"


def test_a_drive_whose_own_loop_goes_beyond_the_torque_limit_is_stopped() -> None:
    adapter = enabled_adapter("velocity")
    adapter.torque = 2.0 * LIMITS.torque
    for _ in range(3):
        assert adapter.write(command(velocity=1.0))
        adapter.manual_clock.advance(PERIOD)
        adapter.read_into(JointFeedback(1))
    assert adapter.log[-1] == "stop"
    assert not adapter.write(command(velocity=1.0))


def test_a_velocity_reference_is_clamped_to_the_limit() -> None:
    adapter = enabled_adapter("velocity")
    assert adapter.write(command(velocity=-99.0))
    assert adapter.references[-1][0] == -LIMITS.velocity


def test_leaving_the_block_stops_and_closes() -> None:
    with FakeAdapter() as adapter:
        adapter.configure("torque", PERIOD)
        adapter.enable()
    assert adapter.log[-2:] == ["stop", "close"]
    with pytest.raises(AdapterError, match="not open"):
        adapter.capabilities  # noqa: B018


def test_a_close_that_fails_never_raises() -> None:
    adapter = enabled_adapter()
    adapter.fail["close"] = OSError("foreign")
    adapter.close()
    assert adapter.log[-2:] == ["stop", "close"]
    assert adapter.stop_failure == "", "the stop got through"
    assert "foreign" in str(adapter.health()["close_failure"])


def test_nothing_works_before_its_turn() -> None:
    adapter = FakeAdapter()
    for call in (lambda: adapter.read_into(JointFeedback(1)), lambda: adapter.configure("torque", PERIOD)):
        with pytest.raises(AdapterError, match="not open"):
            call()
    adapter.open()
    with pytest.raises(AdapterError, match="not configured"):
        adapter.enable()
    adapter.configure("torque", PERIOD)
    with pytest.raises(AdapterError, match="not enabled"):
        adapter.write(command())


def test_asserts_of_the_suite_print_values_in_tests_of_others(tmp_path: Path) -> None:
    (tmp_path / "test_mine.py").write_text(
        "from fricomp.testing.conformance import AdapterConformance\n"
        "def test_it():\n"
        "    from fricomp.testing import conformance_stopping as part\n"
        "    assert type(part.__loader__).__name__ == 'AssertionRewritingHook'\n"
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_mine.py"],
        cwd=tmp_path, capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout

"""The control loop in virtual time: what it sends, when it stops, what it logs."""

from __future__ import annotations

import math
import signal
import threading
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from fricomp.control import (
    Compensator,
    Controller,
    ControlLoop,
    JointLimits,
    PositionController,
    ReferenceState,
    SafetyGate,
    SineReference,
)
from fricomp.control.loop.loop_log import LoopLog
from fricomp.control.loop.position_loop import Reference
from fricomp.errors import AdapterError, AdapterTimeout, ParameterError, SafetyTrip
from fricomp.joint import Capabilities, CommandMode, JointCapabilities, JointCommand, JointFeedback
from fricomp.laws import Coulomb, FrictionLaw, Viscous
from fricomp.model import FrictionModel, Validity
from fricomp.recording import RecordingMetadata

MS = 1_000_000
MODEL = FrictionModel(FrictionLaw((Coulomb(0.2), Viscous(0.1))), validity=Validity(velocity=(-5.0, 5.0)))


class VirtualClock:
    """Time that moves only when it is slept."""

    def __init__(self) -> None:
        self.time_ns = 1000 * MS
        self.late_ns = 0

    def now_ns(self) -> int:
        return self.time_ns

    def sleep_until(self, deadline_ns: int) -> None:
        self.time_ns = max(self.time_ns, deadline_ns) + self.late_ns
        self.late_ns = 0


class IdealJoints:
    """Joints that follow the reference exactly; everything that is written is kept."""

    def __init__(self, n_joints: int = 2, limit: float = 5.0) -> None:
        self.clock = VirtualClock()
        self.capabilities = Capabilities(
            tuple(JointCapabilities(f"j{k}") for k in range(n_joints)), ("torque", "position"), 1000.0, None, True
        )
        # They stand still under any torque.
        self.limits = [JointLimits(limit, 1e6, 10.0, (-3.0, 3.0), breakaway=limit)] * n_joints
        self.gate = SafetyGate(self.limits, period=1e-3)
        self.written: list[list[float]] = []
        self.events: list[str] = []
        self.silent, self.stop_failure = False, ""
        self.age_ns = 0  # of what is reported
        self.on_write: Any = None

    def configure(self, mode: CommandMode, period: float) -> None:
        self.gate = SafetyGate(self.limits, period=period, ramp_time=0.0, stale_after=0.02)

    def enable(self) -> None:
        self.gate.arm(self.clock.now_ns())
        self.events.append("enable")

    def read_into(self, feedback: JointFeedback) -> bool:
        n = len(self.limits)
        if not self.silent:
            feedback.time_ns = self.clock.now_ns() - self.age_ns
            feedback.position[:], feedback.velocity[:], feedback.torque[:] = [0.0] * n, [0.0] * n, [0.1] * n
        self.gate.observe(feedback, self.clock.now_ns())
        return not self.silent

    def write(self, command: JointCommand) -> bool:
        if self.on_write is not None:
            self.on_write()
        out = [0.0] * len(self.limits)
        if not self.gate.admit(command.torque, out, self.clock.now_ns()):
            return False
        self.written.append(out)
        return True

    def safe_stop(self, reason: str = "") -> None:
        self.gate.disarm()
        self.events.append("stop")


def make_loop(joints: IdealJoints, **given: Any) -> ControlLoop:
    n = len(joints.limits)
    controller = PositionController.from_bandwidth([0.05] * n, 2.0)
    return ControlLoop(joints, SineReference([0.1] * n, 1.0, [0.0] * n), controller, **given)


def test_runs_every_cycle_then_stops() -> None:
    joints = IdealJoints()
    result = make_loop(joints, compensators=[Compensator(MODEL) for _ in range(2)]).run(0.5)
    assert (result.cycles, result.skipped, result.trip) == (500, 0, None)
    assert joints.events == ["enable", "stop"]
    assert np.diff(result.log.time) == pytest.approx(np.full(499, 1e-3))


def test_command_is_controller_plus_compensation() -> None:
    joints = IdealJoints()
    log = make_loop(joints, compensators=[Compensator(MODEL) for _ in range(2)]).run(0.3).log
    plain = make_loop(IdealJoints()).run(0.3).log
    difference = log.signal("torque_command") - plain.signal("torque_command")
    assert difference == pytest.approx(log.signal("compensation"))
    assert np.max(np.abs(difference)) > 0.1


def test_the_controller_compares_with_the_reference_of_the_time_of_the_feedback() -> None:
    class Remembering:
        def __init__(self) -> None:
            self.seen: list[float] = []

        def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
            self.seen.append(reference.position[0])
            out[:] = [0.0] * len(out)

    joints, controller = IdealJoints(), Remembering()
    joints.age_ns = 5 * MS
    log = ControlLoop(joints, SineReference([0.1] * 2, 1.0, [0.0] * 2), controller).run(0.3).log
    wanted = log.signal("position_reference")[:, 0]
    assert controller.seen[50:] == pytest.approx(wanted[45:-5])
    assert abs(wanted[100] - controller.seen[100]) > 1e-3


def test_missed_cycles_are_skipped_never_burst() -> None:
    joints = IdealJoints()

    def stall() -> None:
        if len(joints.written) == 100:
            joints.clock.time_ns += 5 * MS + MS // 2

    joints.on_write = stall
    result = make_loop(joints).run(0.5)
    assert result.skipped == 5
    assert result.cycles == 495
    steps = np.diff(result.log.time)
    assert steps.min() == pytest.approx(1e-3)
    assert steps.max() == pytest.approx(6e-3)


def test_too_many_missed_cycles_trip() -> None:
    joints = IdealJoints()
    joints.on_write = lambda: setattr(joints.clock, "time_ns", joints.clock.time_ns + 15 * MS)
    result = make_loop(joints).run(0.5)
    assert result.trip is not None
    assert result.trip.reason == "overrun"
    assert result.cycles == 1
    with pytest.raises(SafetyTrip, match="overrun"):
        result.raise_if_tripped()


def test_silent_joint_trips_as_stale() -> None:
    joints = IdealJoints()
    joints.on_write = lambda: setattr(joints, "silent", len(joints.written) > 50)
    result = make_loop(joints).run(0.5)
    assert result.trip is not None
    assert result.trip.reason == "stale"
    assert 60 < result.cycles < 80


def test_joint_that_never_reports_is_not_enabled() -> None:
    joints = IdealJoints()
    joints.silent = True
    with pytest.raises(AdapterTimeout, match="power"):
        make_loop(joints).run(0.5)
    assert "enable" not in joints.events


class BrokenController:
    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        raise ZeroDivisionError("a bug in the user's controller")


def test_exception_in_the_controller_stops_the_joints_and_goes_on() -> None:
    joints = IdealJoints()
    loop = ControlLoop(joints, SineReference([0.1] * 2, 1.0, [0.0] * 2), BrokenController())
    with pytest.raises(ZeroDivisionError):
        loop.run(0.5)
    assert joints.events[-1] == "stop"
    assert joints.gate.trip_record is not None
    assert joints.gate.trip_record.reason == "exception"


class NanController:
    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        out[:] = [0.1, float("nan")]


def test_nan_from_the_controller_sends_nothing_and_trips() -> None:
    joints = IdealJoints()
    result = ControlLoop(joints, SineReference([0.1] * 2, 1.0, [0.0] * 2), NanController()).run(0.5)
    assert joints.written == []
    assert result.trip is not None
    assert result.trip.reason == "not_finite"


def test_signal_ends_the_loop_at_rest_and_is_handed_on() -> None:
    joints = IdealJoints()
    joints.on_write = lambda: signal.raise_signal(signal.SIGTERM) if len(joints.written) == 20 else None
    with pytest.raises(KeyboardInterrupt):
        make_loop(joints).run(5.0)
    assert joints.events[-1] == "stop"
    assert len(joints.written) == 21


def test_a_second_signal_does_not_wait_for_a_controller_that_hangs() -> None:
    joints = IdealJoints()

    class HangingController:
        def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
            for _ in range(1000):
                signal.raise_signal(signal.SIGINT)
            pytest.fail("the controller went on")

    with pytest.raises(KeyboardInterrupt):
        ControlLoop(joints, SineReference([0.1] * 2, 1.0, [0.0] * 2), HangingController()).run(1.0)
    assert joints.events[-1] == "stop"
    assert joints.written == []


def test_a_terminal_that_goes_away_ends_the_loop_at_rest() -> None:
    joints = IdealJoints()
    joints.on_write = lambda: signal.raise_signal(signal.SIGHUP) if len(joints.written) == 5 else None
    with pytest.raises(KeyboardInterrupt):
        make_loop(joints).run(5.0)
    assert joints.events[-1] == "stop"


def test_a_stop_that_did_not_get_through_is_no_clean_end() -> None:
    joints = IdealJoints()
    joints.stop_failure = "the stop did not reach the drive"
    with pytest.raises(AdapterError, match="cut the power"):
        make_loop(joints).run(0.1)


def test_no_signal_comes_between_an_error_and_the_stop() -> None:
    joints = IdealJoints()
    stop = joints.safe_stop

    def disturbed(reason: str = "") -> None:
        for _ in range(3):
            signal.raise_signal(signal.SIGINT)
        stop(reason)

    joints.on_write = lambda: signal.raise_signal(signal.SIGINT) if len(joints.written) == 5 else None
    joints.safe_stop = disturbed  # type: ignore[method-assign]
    with pytest.raises(KeyboardInterrupt):
        make_loop(joints).run(1.0)
    assert joints.events[-1] == "stop"


@pytest.mark.parametrize("error", [AdapterTimeout("the bus is silent"), ZeroDivisionError(), KeyboardInterrupt()])
def test_a_stop_that_did_not_get_through_is_told_before_any_other_error(error: BaseException) -> None:
    joints = IdealJoints()

    def broken() -> None:
        joints.stop_failure = "the stop did not reach the drive"
        raise error

    joints.on_write = broken
    with pytest.raises(AdapterError, match=f"{type(error).__name__}.*did not reach the drive: cut the power") as caught:
        make_loop(joints).run(0.1)
    assert caught.value.__cause__ is error


@pytest.mark.parametrize("duration", [float("inf"), float("nan"), -1.0, 1e300])
def test_a_duration_that_never_ends_is_refused_before_anything_is_energised(duration: float) -> None:
    joints = IdealJoints()
    with pytest.raises(ParameterError, match="duration of a run"):
        make_loop(joints).run(duration)
    assert joints.events == ["stop"]


@pytest.mark.parametrize("when", ["before", "while configuring"])
def test_a_loop_that_is_stopped_before_it_moves_enables_nothing_and_runs_again(
    when: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    joints = IdealJoints()
    loop, configure = make_loop(joints), joints.configure

    def stopped(mode: CommandMode, period: float) -> None:
        loop.stop()
        configure(mode, period)

    if when == "before":
        loop.stop()
    else:
        monkeypatch.setattr(joints, "configure", stopped)
    assert loop.run(0.1).cycles == 0
    assert "enable" not in joints.events
    monkeypatch.undo()
    assert loop.run(0.1).cycles == 100


def test_a_second_run_is_told_of_itself_alone() -> None:
    class OnceBroken(PositionController):
        def torque_into(self, out: list[float], feedback: JointFeedback, goal: ReferenceState) -> None:
            super().torque_into(out, feedback, goal)
            if len(joints.written) == 20:
                joints.clock.late_ns = 5 * MS
                feedback.velocity[:] = [float("nan")] * 2

    joints = IdealJoints()
    controller, reference = OnceBroken.from_bandwidth([0.05] * 2, 2.0), SineReference([0.1] * 2, 1.0, [0.0] * 2)
    loop = ControlLoop(joints, reference, controller, compensators=[Compensator(MODEL) for _ in range(2)])
    first = loop.run(0.1)
    assert first.skipped > 0
    assert first.rejected > 0
    second = loop.run(0.05)
    assert (second.skipped, second.rejected, len(second.log)) == (0, 0, 50)
    assert np.all(np.diff(second.log.time) > 0.0)
    assert len(first.log) == first.cycles


def test_the_log_holds_what_the_gate_let_through() -> None:
    joints = IdealJoints(limit=0.05)
    log = make_loop(joints, compensators=[Compensator(MODEL) for _ in range(2)]).run(0.3).log
    assert log.signal("torque_command").tolist() == joints.written
    assert np.max(np.abs(log.signal("torque_command"))) <= 0.05 < np.max(np.abs(log.signal("compensation")))


def test_drives_without_feed_forward_are_not_compensated_in_their_own_loop() -> None:
    joints = IdealJoints()
    joints.capabilities = replace(joints.capabilities, feed_forward=False)
    reference = SineReference([0.1] * 2, 1.0, [0.0] * 2)
    with pytest.raises(ParameterError, match="take no torque in position mode"):
        ControlLoop(joints, reference, None, compensators=[Compensator(MODEL) for _ in range(2)], mode="position")


def test_stop_ends_the_loop() -> None:
    joints = IdealJoints()
    loop = make_loop(joints)
    joints.on_write = lambda: loop.stop() if len(joints.written) == 10 else None
    assert loop.run(5.0).cycles == 11


def test_a_loop_ends_at_rest_with_the_main_thread(monkeypatch: pytest.MonkeyPatch) -> None:
    joints = IdealJoints()
    monkeypatch.setattr(threading.main_thread(), "is_alive", lambda: len(joints.written) < 20)
    result = make_loop(joints).run(1.0)
    assert result.cycles == 20
    assert str(result.trip) == "stop: the main thread has ended"
    assert joints.events[-1] == "stop"


def test_drive_with_its_own_loop_gets_reference_and_feed_forward() -> None:
    joints = IdealJoints()
    reference = SineReference([0.1] * 2, 1.0, [0.0] * 2)
    loop = ControlLoop(joints, reference, None, compensators=[Compensator(MODEL) for _ in range(2)], mode="position")
    log = loop.run(0.2).log
    assert log.signal("torque_command") == pytest.approx(log.signal("compensation"))


@pytest.mark.parametrize(
    ("given", "match"),
    [
        ({"compensators": [Compensator(MODEL)]}, "1 compensators given for 2 joints"),
        ({"mode": "position"}, "takes no controller"),
        ({"compensators": [Compensator(FrictionModel(MODEL.law, torque_unit="A")) for _ in range(2)]}, "in A"),
        (
            {"compensators": [Compensator(replace(MODEL, motion="linear", torque_unit="N·m")) for _ in range(2)]},
            "of a linear joint",
        ),
        ({"compensators": [Compensator(MODEL, period=5e-3) for _ in range(2)]}, "a period of 0.005 s"),
        ({"compensators": [Compensator(MODEL)] * 2}, "make one for each"),
    ],
)
def test_parts_that_do_not_fit_are_refused(given: dict[str, Any], match: str) -> None:
    with pytest.raises(ParameterError, match=match):
        make_loop(IdealJoints(), **given)


@pytest.mark.parametrize(
    ("reference", "controller"),
    [
        (SineReference([0.1], 1.0, [0.0]), PositionController.from_bandwidth([0.05] * 2, 2.0)),
        (SineReference([0.1] * 2, 1.0, [0.0] * 2), PositionController.from_bandwidth([0.05] * 3, 2.0)),
    ],
)
def test_a_reference_or_a_controller_of_another_number_of_joints_is_refused(
    reference: SineReference, controller: PositionController
) -> None:
    with pytest.raises(ParameterError, match=r"of (1|3) joints given for 2"):
        ControlLoop(IdealJoints(), reference, controller)


class FirstJointOnly:
    """Leaves out all joints but the first, as reference and as controller."""

    def sample(self, time: float, state: ReferenceState) -> None:
        state.position[0] = state.velocity[0] = 0.0

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        out[0] = 0.1


class OneTooMany:
    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        out[:] = [0.1] * 3


@pytest.mark.parametrize(
    ("reference", "controller", "reason"),
    [
        (FirstJointOnly(), PositionController.from_bandwidth([0.05] * 2, 2.0), "not_finite"),
        (SineReference([0.1] * 2, 1.0, [0.0] * 2), FirstJointOnly(), "not_finite"),
        (SineReference([0.1] * 2, 1.0, [0.0] * 2), OneTooMany(), "wrong_joint_count"),
    ],
)
def test_a_joint_that_reference_or_controller_leave_out_or_add_stops_all(
    reference: Reference, controller: Controller, reason: str
) -> None:
    joints = IdealJoints()
    result = ControlLoop(joints, reference, controller).run(0.1)
    assert joints.written == []
    assert result.trip is not None
    assert result.trip.reason == reason


@pytest.mark.parametrize("bad", [-0.1, 0.0, math.nan, math.inf])
def test_gains_of_a_controller_are_not_negative_and_finite(bad: float) -> None:
    with pytest.raises(ParameterError, match="finite and positive"):
        PositionController.from_bandwidth([0.1, bad], 5.0)
    with pytest.raises(ParameterError, match="position controller"):
        PositionController([1.0], [-0.1 if bad == 0.0 else bad], [0.1])
    with pytest.raises(ParameterError, match="position controller"):
        PositionController([1.0, 1.0], [0.1], [0.1])


def test_log_keeps_the_newest_rows_in_order() -> None:
    log = LoopLog(1, capacity=10)
    for k in range(25):
        log.append([float(k), 0.0, 0.0, *([0.5] * 7)])
    assert log.time.tolist() == list(range(15, 25))
    assert (len(log), log.overwritten) == (10, 15)
    with pytest.raises(ParameterError, match="no signal"):
        log.signal("colour")
    with pytest.raises(ParameterError, match="empty"):
        LoopLog(1).timing()


def test_log_becomes_a_recording() -> None:
    joints = IdealJoints()
    recording = make_loop(joints).run(0.2).log.recording(1, RecordingMetadata(joint="j1"))
    assert recording.metadata.torque_kind == "measured"
    assert recording.torque == pytest.approx(np.full(200, 0.1))
    assert recording.velocity_reference is not None

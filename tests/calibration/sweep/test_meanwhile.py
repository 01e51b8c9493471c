"""What takes long is done beside the loop, which goes on serving an energised joint; in lock step it takes no time."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from fricomp.adapters import open_adapter
from fricomp.calibration.sweep import RunFolder, Sweep, SweepContext, SweepData
from fricomp.calibration.sweep.calibrate import channels_of
from fricomp.calibration.sweep.feasibility import check_feasible
from fricomp.calibration.sweep.motion.motion import MotionRunner
from fricomp.calibration.sweep.motion.velocity_loop import DriveLoop
from fricomp.errors import AdapterError, ParameterError, RecordingError, SweepAborted
from fricomp.joint import JointCommand, JointFeedback
from fricomp.recording import RecordingWriter
from fricomp.sim_bench.stand_in import SimulatedJointAdapter, two_link_arm

PERIOD = 0.002


class RunningClock:
    """The clock of a simulation, of which nothing says that it stands still between the cycles."""

    def __init__(self, adapter: SimulatedJointAdapter) -> None:
        self._clock, self._moved = adapter.clock, threading.Condition()

    def now_ns(self) -> int:
        return self._clock.now_ns()

    def sleep_until(self, deadline_ns: int) -> None:
        with self._moved:
            self._clock.sleep_until(deadline_ns)
            self._moved.notify_all()

    def let_pass(self, seconds: float) -> None:
        """A call that takes this long: time goes on by the loop if there is one beside it, else unserved."""
        due = self.now_ns() + round(seconds * 1e9)
        if threading.current_thread() is threading.main_thread():
            self.sleep_until(due)
            return
        with self._moved:
            assert self._moved.wait_for(lambda: self.now_ns() >= due, timeout=60.0)


@pytest.fixture
def clock(adapter: SimulatedJointAdapter) -> RunningClock:
    made = RunningClock(adapter)
    adapter.clock = made
    return made


@pytest.fixture
def runner(adapter: SimulatedJointAdapter) -> MotionRunner:
    started = MotionRunner(adapter, 0, PERIOD)
    started.start(DriveLoop(1, PERIOD))
    return started


def speed_of(adapter: SimulatedJointAdapter) -> float:
    return abs(float(adapter.stand_in.plant.velocity(0)))


def slow_disk(monkeypatch: pytest.MonkeyPatch, then: Callable[[str], None]) -> None:
    append = RecordingWriter.append

    def slow(writer: RecordingWriter, block: Any, label: str = "") -> Any:
        written = append(writer, block, label)
        then(label)
        return written

    monkeypatch.setattr(RecordingWriter, "append", slow)


@pytest.mark.parametrize("loop", ["host", "drive"])
def test_a_joint_does_not_run_away_while_its_blocks_are_written(
    loop: Any,
    adapter: SimulatedJointAdapter,
    clock: RunningClock,
    context: SweepContext,
    folder: RunFolder,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    speeds: dict[str, float] = {}

    def disk(label: str) -> None:
        clock.let_pass(0.09)
        speeds[label] = speed_of(adapter)

    settings = replace(
        context.settings,
        loop=loop,
        inertia=0.05 if loop == "host" else 0.0,
        speeds="0.4,1.5,3.0",
        breakaway_positions=0,
    )
    moving = replace(context, settings=settings)
    slow_disk(monkeypatch, disk)
    with folder.open_writer(moving.metadata(), channels_of(moving)) as writer:
        sweep = Sweep(moving, writer, SweepData())
        sweep.prepare()
        sweep.run_plan(sweep.plan_first_pass())
        assert adapter.enabled
    assert len(speeds) > 6
    assert max(speeds.values()) < 0.05


def test_a_terminal_that_hangs_does_not_hold_up_the_loop(
    adapter: SimulatedJointAdapter, clock: RunningClock, context: SweepContext, folder: RunFolder
) -> None:
    moving = replace(context, settings=replace(context.settings, speeds="0.4,1.5,3.0", breakaway_positions=0))
    beside_the_loop = []

    def tell(text: str, done: float) -> None:
        if adapter.enabled:
            beside_the_loop.append(threading.current_thread() is not threading.main_thread())
        clock.let_pass(0.09)

    with folder.open_writer(moving.metadata(), channels_of(moving)) as writer:
        sweep = Sweep(moving, writer, SweepData(), tell)
        sweep.prepare()
        sweep.run_plan(sweep.plan_first_pass())
    assert len(beside_the_loop) > 4
    assert all(beside_the_loop)


def test_the_sign_check_ends_at_zero_torque_before_anything_else(
    adapter: SimulatedJointAdapter, context: SweepContext, folder: RunFolder, monkeypatch: pytest.MonkeyPatch
) -> None:
    energised, written = [], []

    def judged(*_: Any, **__: Any) -> None:
        energised.append(adapter.enabled)
        raise SweepAborted("wrong sign")

    slow_disk(monkeypatch, lambda label: written.append((label, adapter.enabled)))
    monkeypatch.setattr("fricomp.calibration.sweep.motion.push.check_signs", judged)
    with folder.open_writer(context.metadata(), channels_of(context)) as writer:
        sweep = Sweep(context, writer, SweepData())
        with pytest.raises(SweepAborted, match="wrong sign"):
            sweep.prepare()
    assert energised == [False]
    assert written[-1] == ('{"kind":"sign_check"}', False)


def test_in_lock_step_the_work_is_done_at_once_and_takes_no_time(runner: MotionRunner) -> None:
    before, thread = runner.now_ns, threading.current_thread()
    assert runner.meanwhile(lambda: (runner.now_ns, threading.current_thread())) == (before, thread)


def test_what_the_work_raises_comes_out_of_it_and_the_joint_is_at_zero_torque(
    adapter: SimulatedJointAdapter, clock: RunningClock, runner: MotionRunner
) -> None:
    def fail() -> None:
        clock.let_pass(0.05)
        raise RecordingError("the disk is full")

    with pytest.raises(RecordingError, match="full"):
        runner.meanwhile(fail)
    assert not adapter.enabled


def test_an_interrupt_stops_the_joint_before_the_work_is_waited_for(
    adapter: SimulatedJointAdapter, clock: RunningClock, runner: MotionRunner, monkeypatch: pytest.MonkeyPatch
) -> None:
    stopped, seen = threading.Event(), []
    safe_stop = adapter.safe_stop

    def stop(reason: str = "") -> None:
        safe_stop(reason)
        stopped.set()

    def interrupted(_: JointCommand) -> bool:
        raise KeyboardInterrupt

    monkeypatch.setattr(adapter, "safe_stop", stop)
    monkeypatch.setattr(adapter, "write", interrupted)
    with pytest.raises(KeyboardInterrupt):
        runner.meanwhile(lambda: seen.append(stopped.wait(timeout=60.0)))
    assert seen == [True]
    assert not adapter.enabled


def test_a_fault_is_not_cleared_by_starting_again() -> None:
    with open_adapter("twin-odrive", {}) as twin:
        runner = MotionRunner(twin, 0, PERIOD)
        runner.start(DriveLoop(1, PERIOD))
        twin.clock.sleep_until(twin.clock.now_ns() + 300_000_000)  # silence, until the drive's watchdog has fired
        with pytest.raises(SweepAborted):
            runner.start(DriveLoop(1, PERIOD))
        assert not twin.enabled
        runner.await_feedback()  # the gate trips on the silence before the drive has been asked again
        assert any(runner.feedback.fault)


def test_a_session_does_not_begin_on_a_drive_that_has_a_fault(adapter: SimulatedJointAdapter) -> None:
    adapter.stand_in.servos[0].expired = True
    with pytest.raises(SweepAborted, match="fricomp adapter clear"):
        MotionRunner(adapter, 0, PERIOD).start(DriveLoop(1, PERIOD))
    assert not adapter.enabled


def test_a_stop_while_the_mode_is_changed_is_heeded(
    adapter: SimulatedJointAdapter, runner: MotionRunner, monkeypatch: pytest.MonkeyPatch
) -> None:
    configure = adapter._configure

    def stopped(*arguments: Any) -> None:
        adapter.safe_stop("operator")
        configure(*arguments)

    adapter.disable()
    monkeypatch.setattr(adapter, "_configure", stopped)
    with pytest.raises((SweepAborted, AdapterError), match="operator"):
        runner.start(DriveLoop(1, PERIOD, "position"))
    assert not adapter.enabled


def test_an_arm_of_unknown_inertia_is_not_left_limp_by_the_sign_check(folder: RunFolder) -> None:
    request = folder.request
    with SimulatedJointAdapter(two_link_arm()) as arm:
        context = SweepContext(arm, 0, request.settings)
        with pytest.raises(ParameterError, match="--inertia"):
            check_feasible(context, request.options)
        with folder.open_writer(context.metadata(), channels_of(context)) as writer:
            with pytest.raises(ParameterError, match="--inertia"):
                Sweep(context, writer, SweepData()).prepare()
            assert writer.blocks == ()
        known = replace(context, settings=replace(request.settings, inertia=0.1))
        known.make_check_loop(PERIOD, [0.0, 0.0])


def test_the_push_of_the_sign_check_is_no_feed_forward_of_the_sweep() -> None:
    out = JointCommand(2)
    out.torque[:] = [0.7, 0.1]
    loop = DriveLoop(2, PERIOD)
    loop.command(0, 0.5, JointFeedback(2), out)
    assert out.torque == [0.0, 0.0]
    assert out.velocity == [0.5, 0.0]

"""The control loop: read, control, compensate, gate, write; absolute deadlines, never a burst."""

import math
import threading
import time
from collections.abc import Sequence
from dataclasses import dataclass
from operator import add
from typing import Protocol

from fricomp.control.compensation.adaptation import AdaptationSettings
from fricomp.control.compensation.compensator import Compensator, require_one_each
from fricomp.control.gate.gate import SafetyGate
from fricomp.control.gate.trip import TripRecord
from fricomp.control.loop.ending import Stoppable, require_stopped, stopping_at_exit, stopping_on_error
from fricomp.control.loop.interruption import EndingSignals, warn_of_unheard_signals
from fricomp.control.loop.load import LoadModel
from fricomp.control.loop.loop_compensation import LoopCompensation
from fricomp.control.loop.loop_log import LoopLog
from fricomp.control.loop.position_loop import Controller, PositionController, Reference, ReferenceState, SineReference
from fricomp.control.loop.real_time import RealTimeOptions, RealTimeReport, real_time
from fricomp.errors import ParameterError, SafetyTrip
from fricomp.joint import (
    Capabilities,
    Clock,
    CommandMode,
    JointCapabilities,
    JointCommand,
    JointFeedback,
    await_feedback,
)


class LoopAdapter(Stoppable, Protocol):
    """What the loop needs of an adapter; `fricomp.adapters.JointAdapter` has it."""

    @property
    def clock(self) -> Clock: ...
    @property
    def capabilities(self) -> Capabilities: ...
    @property
    def gate(self) -> SafetyGate: ...
    def configure(self, mode: CommandMode, period: float) -> None: ...
    def enable(self) -> None: ...
    def write(self, command: JointCommand) -> bool: ...
    def read_into(self, feedback: JointFeedback) -> bool: ...


@dataclass(frozen=True)
class LoopResult:
    """How a run of the loop went.

    Attributes:
        log: Every cycle.
        cycles: Cycles that ran.
        skipped: Cycles that were left out because the one before ended too late.
        rejected: Inputs of the compensators that were not finite.
        trip: Why the gate latched, or None when the loop ran to its end.
        real_time: What the system granted.
    """

    log: LoopLog
    cycles: int
    skipped: int
    rejected: int
    trip: TripRecord | None
    real_time: RealTimeReport

    def raise_if_tripped(self) -> None:
        """Raise what stopped the loop.

        Raises:
            SafetyTrip: The gate had latched.
        """
        if self.trip is not None:
            raise SafetyTrip(f"the loop stopped after {self.cycles} cycles: {self.trip}")


class ControlLoop:
    """Runs a controller and friction compensation on the joints of an adapter, which is open already.

    One cycle of length `period` [s], at absolute deadlines t_k = t_0 + k period:

        read q, v  →  u = controller(r(t_k), q, v)  →  tau = u + friction(r(t_k + delay))  →  gate  →  write

    A cycle that ends too late is skipped and never made up for, since a burst of commands would be a jump. The gate is
    the one way to the drive: it clamps tau to the limits, and once anything is wrong it lets nothing through until the
    user's own code resets it. A sine of 0.2 rad at 0.5 Hz on the simulated joint, with a PD controller of 20 N·m/rad
    and 2 N·m·s/rad:

    >>> from fricomp.adapters import open_adapter
    >>> from fricomp.control import ControlLoop, PositionController, SineReference
    >>> with open_adapter("sim", {"backend": "sim"}) as adapter:
    ...     reference = SineReference([0.2], 0.5, [0.0])
    ...     controller = PositionController([20.0], [2.0], [0.1])
    ...     loop = ControlLoop(adapter, reference, controller, period=1e-3)
    ...     result = loop.run(duration=0.25)  # enables the joint, and stops it on every way out
    >>> result.cycles, result.trip
    (250, None)
    >>> error = result.log.signal("position_reference") - result.log.signal("position")  # [rad]
    >>> bool(abs(error).max() < 0.6 / 20.0)  # friction of at most 0.6 N·m bends the loop's spring of 20 N·m/rad
    True

    With `compensators=[Compensator("friction.json", period=1e-3)]` the controller has no friction left to fight.

    The controller sees the reference of the time at which its feedback was taken, the compensation that of the time
    at which it acts. The joints are stopped on every way out; nothing enables them again. Signals are heard in the
    main thread only; a loop in another one ends with the main thread.

    Args:
        adapter: Opened; its gate holds the limits.
        reference: The motion.
        controller: The user's controller; None in a mode where the drive closes the loop itself.
        compensators: One a joint, or None for none.
        load_model: Knows the torque that the joints carry, for models that depend on it and for adaptation; without
            it the controller is asked where it has `load_into`, else the torque that the drives report serves.
        adaptation: Lets the compensators follow slow changes of the friction; off unless given.
        period: Control period [s].
        mode: `torque`, or `velocity` or `position` with the compensation as torque feed-forward.
        log_capacity: Rows that the log keeps.
        options: What to ask of the system; no more than a short timer slack if None.
        most_skipped: Cycles skipped at once from which the gate trips.

    Raises:
        ParameterError: The parts do not fit together.
    """

    def __init__(
        self,
        adapter: LoopAdapter,
        reference: Reference,
        controller: Controller | None,
        *,
        compensators: Sequence[Compensator] | None = None,
        load_model: LoadModel | None = None,
        adaptation: AdaptationSettings | None = None,
        period: float = 1e-3,
        mode: CommandMode = "torque",
        log_capacity: int = 60_000,
        options: RealTimeOptions | None = None,
        most_skipped: int = 10,
    ) -> None:
        joints = adapter.capabilities.joints
        if compensators is not None:
            _require_fit(compensators, joints, period)
        for part in (reference, controller):
            if isinstance(part, SineReference | PositionController) and part.n_joints != len(joints):
                raise ParameterError(f"a {type(part).__name__} of {part.n_joints} joints given for {len(joints)}")
        if (controller is None) is (mode == "torque"):
            raise ParameterError(f"mode {mode!r} {'needs a' if mode == 'torque' else 'takes no'} controller")
        if compensators and mode != "torque" and not adapter.capabilities.feed_forward:
            raise ParameterError(f"these drives take no torque in {mode} mode: compensate in torque mode")
        self.adapter, self.reference, self.controller = adapter, reference, controller
        if load_model is None and isinstance(controller, LoadModel):
            load_model = controller
        self.compensation = LoopCompensation(
            compensators or (), len(joints), period, load_model=load_model, adaptation=adaptation
        )
        self.period, self.mode = period, mode
        self.options = options or RealTimeOptions(freeze_garbage=False)
        self.most_skipped = most_skipped
        self.log = LoopLog(len(joints), log_capacity)
        self._n, self._log_capacity = len(joints), log_capacity
        self._stop = threading.Event()
        self._skipped = 0

    def stop(self) -> None:
        """End the loop after the cycle that runs, or before its first. From any thread.

        It holds until the run that it ends has returned, or the next one where none is going on: that runs no cycle.
        """
        self._stop.set()

    def run(self, duration: float) -> LoopResult:
        """Configure, enable, run for `duration` [s], stop. Log and counters are those of this run alone.

        Whatever it raises, the joints have been stopped, also where they were enabled before.

        Raises:
            ParameterError: The duration is not finite or negative; nothing has been configured.
            AdapterError: The bus or a drive failed; the joints have been stopped, unless the message says that the
                stop did not get through. That one comes in place of any other error, which is its cause.
            KeyboardInterrupt: Ctrl-C; the joints have been stopped.
        """
        try:
            with stopping_at_exit(self.adapter):
                self._prepare(duration)
                return self._run(duration)
        finally:
            self._stop.clear()  # only now: one that came while the drives were configured holds

    def _prepare(self, duration: float) -> None:
        """Configure the drives; an error stops the joints, which their owner may have enabled."""
        try:
            with stopping_on_error(self.adapter):
                if not 0.0 <= duration * 1e9 < math.inf:  # it is counted in nanoseconds
                    raise ParameterError(f"the duration of a run must be finite and not negative, got {duration!r} s")
                warn_of_unheard_signals()
                self.adapter.configure(self.mode, self.period)
                self.compensation.reset()
        except BaseException:
            require_stopped(self.adapter)
            raise

    def _run(self, duration: float) -> LoopResult:
        adapter, signals, feedback = self.adapter, EndingSignals(self._stop), JointFeedback(self._n)
        if len(self.log):
            self.log = LoopLog(self._n, self._log_capacity)  # whoever has the one of the last run keeps it
        self._skipped = cycles = 0
        trip: TripRecord | None = None
        rejected = self.compensation.rejected
        with real_time(self.options) as granted, signals:
            try:
                with signals.impatient():
                    await_feedback(adapter, feedback, self.period)
                    if not self._stop.is_set():
                        adapter.enable()
                        cycles = self._run_cycles(feedback, duration)
                    trip = adapter.gate.trip_record  # before the stop, which latches the gate too
            except BaseException as error:
                adapter.gate.trip("exception", f"{type(error).__name__}: {error}")
                raise
            finally:
                adapter.safe_stop("end of the loop")
                require_stopped(adapter)
        signals.raise_interrupt()
        rejected = self.compensation.rejected - rejected
        return LoopResult(self.log, cycles, self._skipped, rejected, trip, granted)

    def _run_cycles(self, feedback: JointFeedback, duration: float) -> int:
        """The cycles themselves; returns their number."""
        adapter, clock, gate, n = self.adapter, self.adapter.clock, self.adapter.gate, self._n
        now_ns, sleep_until, read_into, write = clock.now_ns, clock.sleep_until, adapter.read_into, adapter.write
        sample, counter, append, stop = self.reference.sample, time.perf_counter_ns, self.log.append, self._stop
        controller, compensate = self.controller, self.compensation.update
        command, goal, seen = JointCommand(n), ReferenceState(n), ReferenceState(n)
        wanted, unfilled = [0.0] * n, [math.nan] * n
        period = round(self.period * 1e9)
        start = deadline = now_ns() + period
        end, cycles, process = start + round(duration * 1e9), 0, threading.main_thread()
        while deadline < end and not stop.is_set():
            if not process.is_alive():  # the interpreter waits for this thread, and nobody else is left to end it
                gate.trip("stop", "the main thread has ended", now_ns())
                break
            sleep_until(deadline)
            began, now = counter(), now_ns()
            read_into(feedback)
            goal.forget()
            sample((now - start) * 1e-9, goal)
            seen.forget()
            sample(max(feedback.time_ns - start, 0) * 1e-9, seen)
            if controller is not None:
                wanted[:] = unfilled
                controller.torque_into(wanted, feedback, seen)
                if len(wanted) != n:
                    gate.trip("wrong_joint_count", f"the controller gave {len(wanted)} torques for {n} joints", now)
            compensation = compensate(feedback, goal, seen)
            command.torque[:] = map(add, wanted, compensation)
            command.position, command.velocity = goal.position, goal.velocity
            if not write(command):
                break
            cycles += 1
            row = [(now - start) * 1e-9, (now - deadline) * 1e-9, (counter() - began) * 1e-9]
            row += feedback.position + feedback.velocity + feedback.torque
            append(row + goal.position + goal.velocity + compensation + list(gate.admitted))
            deadline += period
            behind = (now_ns() - deadline) // period + 1
            if behind > 0:
                self._skipped += behind
                deadline += behind * period
                if behind > self.most_skipped:
                    gate.trip("overrun", f"{behind} cycles of {self.period * 1e3:g} ms missed at once", now)
        return cycles


def _require_fit(compensators: Sequence[Compensator], joints: Sequence[JointCapabilities], period: float) -> None:
    """Refuse compensators that are not those of these joints, called once in this period."""
    if len(compensators) != len(joints):
        raise ParameterError(f"{len(compensators)} compensators given for {len(joints)} joints: give one for each")
    require_one_each(compensators)
    for compensator, joint in zip(compensators, joints, strict=True):
        model = compensator.model
        if model.torque_unit != joint.torque_unit:
            raise ParameterError(
                f"the model of joint {joint.name!r} is in {model.torque_unit}, "
                f"the drive takes {joint.torque_unit}: identify it on this drive"
            )
        if model.motion != joint.motion:
            raise ParameterError(
                f"the model of joint {joint.name!r} is of a {model.motion} joint, it is {joint.motion}"
            )
        if not math.isclose(compensator.period, period):
            raise ParameterError(
                f"the compensator of joint {joint.name!r} is made for a period of {compensator.period:g} s, the loop "
                f"has {period:g} s: pass period={period:g} to it"
            )

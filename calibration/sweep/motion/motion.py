"""Runs motions on a joint through an adapter, cycle by cycle, and stops when anything is outside its limits."""

from collections.abc import Callable
from typing import TypeVar

from fricomp.adapters import JointAdapter
from fricomp.errors import AdapterError, SweepAborted
from fricomp.joint import JointCommand, JointFeedback, await_feedback, stands_still

from ..planning.profile import move_profile
from .background import in_background
from .log import CycleLog
from .velocity_loop import VelocityLoop

__all__ = ["MotionRunner"]

Outcome = TypeVar("Outcome")
Reference = Callable[[float], float | None]
"""Velocity over the time since the start of the motion [rad/s] or [m/s]; None ends it."""


class MotionRunner:
    """One joint of an open adapter, in lock step with its clock.

    Args:
        adapter: Open; `start` configures and enables it.
        joint: Index of the joint.
        period: Of the loop [s].
    """

    def __init__(self, adapter: JointAdapter, joint: int, period: float) -> None:
        n_joints = len(adapter.capabilities.joints)
        self._adapter, self.joint, self.period = adapter, joint, period
        self._clock = adapter.clock
        self._loop: VelocityLoop | None = None
        self.feedback = JointFeedback(n_joints)
        self._command = JointCommand(n_joints)
        self._period_ns = round(period * 1e9)
        self._next_ns = 0
        self.late_cycles = 0

    @property
    def position(self) -> float:
        """Newest position of the joint [rad] or [m]."""
        return self.feedback.position[self.joint]

    @property
    def now_ns(self) -> int:
        """The adapter's clock [ns]."""
        return self._clock.now_ns()

    def start(self, loop: VelocityLoop) -> None:
        """Configure for `loop`, enable, and hold. Nothing is cleared: after a fault or a stop nothing enables again.

        Raises:
            SweepAborted: The drives report a fault, be it an old one, or the safety gate has tripped.
            AdapterError: The drive does not take the mode or does not enable.
        """
        adapter = self._adapter
        if adapter.enabled:
            adapter.read_into(self.feedback)  # trips the gate on whatever has happened since the last cycle
            self._refuse_faults()
            self.stop()
            self._refuse_trip()  # by somebody else's stop
        adapter.configure(loop.mode, self.period)
        self.await_feedback()
        self._refuse_faults()
        adapter.enable()
        loop.start(self.feedback)
        self._loop, self._next_ns = loop, self._clock.now_ns()

    def stop(self) -> None:
        """Zero torque, not energised.

        Raises:
            AdapterError: The stop did not get through.
        """
        self._adapter.disable()

    def await_feedback(self) -> None:
        """Wait until the drive has reported a position.

        Raises:
            AdapterError: It did not in time.
        """
        await_feedback(self._adapter, self.feedback, self.period)

    def meanwhile(self, work: Callable[[], Outcome]) -> Outcome:
        """Do what takes long, such as writing to a disk or fitting, while the loop goes on holding the joints at rest.

        Where no time passes meanwhile, in lock step or not energised, it is simply done: the recording of a simulation
        does not depend on how long it took. Whatever goes wrong stops the joints before the work is waited for.

        Raises:
            SweepAborted: The safety gate has tripped.
            AdapterError: The bus failed.
            Exception: Whatever `work` raises.
        """
        if not self._adapter.enabled or stands_still(self._clock):
            return work()
        return in_background(
            work,
            serve=lambda is_done: self.follow(lambda _: None if is_done() else 0.0),
            stop=lambda: self._adapter.safe_stop("the sweep was ended while it worked"),
        )

    def follow(self, reference: Reference, log: CycleLog | None = None) -> CycleLog:
        """Follow a velocity until it is None.

        Args:
            reference: The velocity.
            log: Filled in; whoever gives one has what was seen even if the motion does not come to its end.

        Raises:
            SweepAborted: The safety gate has tripped.
            AdapterError: The bus failed.
        """
        loop = self._loop
        if loop is None:
            raise AdapterError("the motion has not been started: call start() first")
        log, start = CycleLog(self.joint) if log is None else log, self._next_ns
        while (velocity := reference((self._next_ns - start) * 1e-9)) is not None:
            fresh = self._adapter.read_into(self.feedback)
            loop.command(self.joint, velocity, self.feedback, self._command)
            if fresh:
                self._note(log, velocity, loop)
            self._send()
        return log

    def apply_torque(self, torque: Reference) -> CycleLog:
        """Command an open-loop torque over time [N·m] or [N] until it is None; the loop holds the other joints.

        Raises:
            SweepAborted: The safety gate has tripped.
            AdapterError: The bus failed.
        """
        loop = self._loop
        if loop is None or loop.mode != "torque":
            raise AdapterError("an open-loop torque needs a loop in torque mode: start() one first")
        log, start = CycleLog(self.joint), self._next_ns
        while (wanted := torque((self._next_ns - start) * 1e-9)) is not None:
            fresh = self._adapter.read_into(self.feedback)
            loop.command(self.joint, 0.0, self.feedback, self._command)
            self._command.torque[self.joint] = wanted
            if fresh:
                self._note(log, 0.0, loop)
            self._send()
        return log

    def move_to(self, position: float, speed: float, ramp: float) -> CycleLog:
        """Go to a position [rad] or [m] at `speed` at most and come to rest."""
        profile = move_profile(position - self.position, speed, ramp)
        total = profile.duration + 0.5 * ramp
        return self.follow(lambda time: profile.velocity_at(time) if time < total else None)

    def watch(self, duration: float) -> CycleLog:
        """Record for `duration` [s] without commanding anything; the joint is not energised."""
        log, start = CycleLog(self.joint), self._clock.now_ns()
        self._next_ns = start
        while self._next_ns - start < duration * 1e9:
            if self._adapter.read_into(self.feedback):
                self._note(log, 0.0, None)
            self._wait()
        return log

    def _refuse_faults(self) -> None:
        self._refuse_trip()
        if any(self.feedback.fault):
            told = self._adapter.describe_faults(self.feedback.fault)
            raise SweepAborted(
                f"the drives report faults ({told}): find the cause, then clear them with fricomp adapter clear"
            )

    def _refuse_trip(self) -> None:
        if self._adapter.gate.tripped:
            raise SweepAborted(f"stopped by the safety gate: {self._adapter.gate.trip_record}")

    def _send(self) -> None:
        if not self._adapter.write(self._command):
            raise SweepAborted(f"stopped by the safety gate: {self._adapter.gate.trip_record}")
        self._wait()

    def _wait(self) -> None:
        """Until the next cycle; a cycle that is missed is skipped, never made up for."""
        self._next_ns += self._period_ns
        now = self._clock.now_ns()
        if now > self._next_ns:
            missed = (now - self._next_ns) // self._period_ns
            self.late_cycles += missed
            self._next_ns += missed * self._period_ns
        self._clock.sleep_until(self._next_ns)

    def _note(self, log: CycleLog, reference: float, loop: VelocityLoop | None) -> None:
        feedback, joint = self.feedback, self.joint
        log.time_ns.append(feedback.time_ns)
        log.position.append(feedback.position[joint])
        log.velocity.append(feedback.velocity[joint])
        log.torque.append(feedback.torque[joint])
        log.temperature.append(feedback.temperature[joint])
        log.reference.append(reference)
        if loop is None:
            log.command.append(0.0)  # not energised
        else:
            log.command.append(self._command.torque[joint] if loop.mode == "torque" else float("nan"))
        log.all_positions.append(tuple(feedback.position))

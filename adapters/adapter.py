"""The base of every adapter: what users call, with the safety gate inside; drivers fill in the private methods."""

import threading
from collections.abc import Callable, Sequence
from dataclasses import replace
from types import TracebackType
from typing import Self, final

from fricomp.control import SafetyGate
from fricomp.errors import AdapterConfigurationError, AdapterError
from fricomp.joint import Capabilities, Clock, CommandMode, JointCommand, JointFeedback, Watchdog

from .acceptance import check_counts, check_limits, check_rate, check_waiver, check_watchdog, make_gate, raise_own
from .answering import AnsweringDriver
from .drive_side import DriveSide
from .holding import POLL_INTERVAL_NS
from .options import AdapterOptions
from .reference import ReferenceLimiter
from .stopping import reason_of

__all__ = ["JointAdapter"]

POSITION_PATIENCE_NS = 200_000_000


class JointAdapter(AnsweringDriver):
    """N joints on a bus. The order is open, configure, enable, then write and read every cycle, and close.

    The public methods are final: they hold the safety gate, the transmission and the order of calls. A driver
    implements the private methods on the drive's own side of the transmission, in SI, and raises errors of
    `fricomp.errors` only. After a fault or a trip nothing re-enables by itself: `clear_faults`, then `enable`.

    One thread, the control thread, calls everything but `safe_stop` and `health`, which any thread may call. Whoever
    wants to see every cycle sets `tap`, which is called in the control thread with what has been read and the torque of
    each joint that the gate let through last, in torque mode: it must take microseconds, and raise nothing.

    Args:
        options: Limits and transmissions.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(self, options: AdapterOptions, clock: Clock | None = None) -> None:
        super().__init__(options, clock)
        self._asked_ns = 0  # when the drives were last asked for their state: every write asks
        self._sending_ns = 0  # how long that request took out of this process
        self._opened_watchdog: Watchdog | None = None
        self._mode: CommandMode = "torque"
        self._half_configured = False  # the last configuration failed: drives and gate may be of different ones
        self.tap: Callable[[JointFeedback, Sequence[float]], None] | None = None

    # -- what users call --------------------------------------------------------------------------------

    @final
    def open(self, *, take_over: bool = False) -> Capabilities:
        """Connect and read scaling and limits from the drives. Never energises, and writes nothing to a drive.

        Args:
            take_over: Stop drives that somebody else has energised, at zero torque, in place of refusing them; their
                joints go limp, and `taken_over` names them.

        Raises:
            DriveHeld: A drive is energised by somebody else; it was left alone.
            AdapterConnectionError: The bus or a drive cannot be reached.
            AdapterTimeout: A drive did not answer.
            AdapterConfigurationError: The drives are not what the configuration says.
            AdapterError: A stop is owed from before, and does not get through now either.
        """
        if self._capabilities is not None:
            raise AdapterError("the adapter is open already: close() it first")
        self._gate, self._half_configured, self._close_failure = None, False, ""
        self._released_stop = self._asked_stop  # of an earlier session; one that comes from here on holds
        self._checked_options = self.options
        self._may_take_over, self._taken_over = take_over, ()
        try:
            drives = self._open()
            n_joints = len(drives.joints)
            transmissions = self.options.gears
            check_counts(n_joints, limits=self.options.limits, transmissions=transmissions)
            joints = tuple(t.capabilities_to_joint(j) for j, t in zip(drives.joints, transmissions, strict=True))
            check_limits(joints, self.options.limits)
            self._pay_stop()
            self._refuse_held()
        except BaseException as error:
            self._let_go()
            raise_own(error)
        finally:
            self._may_take_over = False
        self._opened_watchdog = drives.watchdog
        self._drive, self._transmissions = DriveSide(drives, transmissions), transmissions
        self._nothing_new = JointFeedback(n_joints)
        self._capabilities = replace(drives, joints=joints)
        return self._capabilities

    @final
    def configure(self, mode: CommandMode, period: float) -> None:
        """Set the command mode and the period [s] of the loop, write them to the drives and read them back.

        Raises:
            AdapterConfigurationError: The mode is not offered, bus or watchdog do not go with this rate, a limit is
                beyond the drive's, or answers take longer than `stale_after`.
            AdapterError: The joints are enabled, or the gate has tripped and was not cleared.
            DriveHeld: A drive is energised by somebody else; nothing was written.
        """
        check_rate(self.capabilities, mode, period)
        wanted, before = self.options, self._checked_options
        self._check_options(wanted)
        check_waiver(wanted)
        with self._lock:
            if self._enabled:
                raise AdapterError("the joints are enabled: disable() them before configuring")
            self._latch()
            if self._gate is not None and self._gate.tripped:
                raise AdapterError(f"the gate has tripped ({self._gate.trip_record}): call clear_faults() first")
            gate = make_gate(wanted, self.capabilities.joints, mode, period, self.describe_faults)
            self._refuse_held()
            try:
                self._checked_options, self._half_configured = wanted, True
                self._configure(mode, period)
                watchdog = self._confirmed_watchdog() or self._opened_watchdog
                check_watchdog(watchdog, period)
                self._check_delay(wanted.stale_after)
            except BaseException as error:
                self._checked_options = before  # with the gate that there is
                raise_own(error)
            self._capabilities = replace(self.capabilities, watchdog=watchdog)
            self._mode, self._half_configured = mode, False
            self._references = ReferenceLimiter(wanted.limits, period)
            self._gate = gate
            self._latch()  # a stop that came in the meantime found another gate, or none

    @final
    def enable(self) -> None:
        """Energise at zero torque; from here on torque ramps up to its limits.

        Raises:
            AdapterError: Not configured to the end, enabled already, or the drive has no confirmed watchdog and none
                was waived.
            SafetyTrip: The gate has latched: call `clear_faults` first.
            DriveFault: The drive reports a fault.
            DriveHeld: A drive is energised by somebody else; nothing was written.
        """
        gate, watchdog = self._configured_gate(), self.capabilities.watchdog
        if not (self.options.allow_no_watchdog is True or (watchdog is not None and watchdog.confirmed)):
            raise AdapterError(
                "the drive has no confirmed watchdog and would keep its last torque if the bus fell silent: "
                "set one on the drive, or pass allow_no_watchdog=True to take that risk"
            )
        with self._lock:
            if self._enabled:
                raise AdapterError("the joints are enabled already")
            if self._half_configured:
                raise AdapterError("the drives were not configured to the end: configure() them again")
            self._latch()
            self._halt()
            gate.raise_if_tripped()
            self._refuse_held()
            try:
                self._lock_owner, self._enabling = threading.get_ident(), True  # from here on a stop latches the gate
                self._start_references()
                self._drive.zero_command()
                gate.raise_if_tripped()
                self._enabled = self._is_ours = True
                self._enable()
                self._forget_states()
                # Armed last: the ramp begins when the drives are ready, and a stop in the meantime raises here.
                self._asked_ns = self.clock.now_ns()
                gate.arm(self._asked_ns)
                gate.raise_if_tripped()
            except BaseException as error:
                gate.disarm()
                self._stop_drives()
                raise_own(error)
            finally:
                self._lock_owner, self._enabling = 0, False

    @final
    def write(self, command: JointCommand) -> bool:
        """Send one command to all joints, whole or not at all.

        Returns:
            False if the gate has tripped: nothing was sent but a stop.

        Raises:
            AdapterError: Not enabled, or the bus failed; the joints have been stopped.
        """
        gate = self._configured_gate()
        with self._lock:
            self._latch()
            if not self._enabled:
                self._halt()
                if gate.tripped:
                    return False
                raise AdapterError("the joints are not enabled: call enable() first")
            try:
                self._lock_owner = threading.get_ident()
                if self._admit(command, gate):
                    began = self._asked_ns = self.clock.now_ns()
                    self._write(self._drive.command_from_joint(), self._mode)
                    self._sending_ns = self.clock.now_ns() - began
            except BaseException as error:
                gate.trip(reason_of(error), str(error) or repr(error), self.clock.now_ns())
                raise_own(error)
            finally:
                self._lock_owner = 0
                # Also when another thread, or a signal handler of this one, has stopped the joints in mid-batch.
                if gate.tripped:
                    self._stop_drives()
        return not gate.tripped

    @final
    def read_into(self, feedback: JointFeedback) -> bool:
        """Take what the drives have reported into `feedback`.

        Returns:
            False if nothing new has come; `feedback` is untouched then.

        Raises:
            AdapterError: Not open, or the bus failed; the joints have been stopped.
        """
        if self._capabilities is None:
            raise AdapterError("the adapter is not open: call open() first")
        try:
            fresh = self._read_into(self._drive.feedback)
        except BaseException as error:
            self._trip(reason_of(error), str(error) or repr(error))
            self._stop_now()
            raise_own(error)
        if fresh:
            self._drive.feedback_to_joint(feedback)
        gate = self._gate
        if gate is not None and self._enabled:
            gate.observe(feedback if fresh else self._nothing_new, self.clock.now_ns())
            if gate.tripped:
                self._stop_now()
        tap = self.tap
        if fresh and tap is not None:
            tap(feedback, gate.admitted if gate is not None and self._mode == "torque" else ())
        return fresh

    @final
    def disable(self) -> None:
        """De-energise at zero torque: the ordinary end of a motion. Latches nothing, and releases nothing.

        Raises:
            AdapterError: The stop did not get through.
        """
        with self._lock:
            was_enabled = self._enabled
            if self._gate is not None:
                self._gate.disarm()
            self._pay_stop()
            if was_enabled:
                try:
                    self._end_motion()
                except BaseException as error:
                    raise_own(error)

    @final
    def clear_faults(self) -> None:
        """Clear drive faults and unlatch the gate, but for a stop that comes meanwhile. Does not enable.

        Raises:
            AdapterError: A stop was owed and did not get through now either.
            DriveFault: The fault stays.
            DriveHeld: A drive is energised by somebody else; nothing was written.
        """
        seen = self._asked_stop
        with self._lock:
            self._halt()
            self._refuse_held()
            try:
                self._clear_faults()
            except BaseException as error:
                raise_own(error)
            if self._stop_owed:
                raise AdapterError(self._stop_failure)
            self._release_stop(seen)
            self._stop_failure = ""

    @final
    def close(self) -> None:
        """Stop the joints and let go of the bus. Never raises."""
        self.safe_stop("closed")
        self._capabilities, self._is_ours = None, False
        self._let_go()

    @final
    def __enter__(self) -> Self:
        self.open()
        return self

    @final
    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    # -- inside -----------------------------------------------------------------------------------------

    def _check_options(self, options: AdapterOptions) -> None:
        """Once more before a gate is made of them: a caller may have exchanged the options since opening."""
        joints = self.capabilities.joints
        check_counts(len(joints), limits=options.limits)
        check_limits(joints, options.limits)
        if options.gears != self._transmissions:
            raise AdapterConfigurationError(
                "the transmissions are not those that the adapter was opened with: close() it and open() it again"
            )

    def _admit(self, command: JointCommand, gate: SafetyGate) -> bool:
        """Fill the drives' command, still joint side, with what may be sent."""
        if gate.tripped or not gate.admit(command.torque, self._drive.command.torque, self.clock.now_ns()):
            return False
        if self._mode == "torque":
            return True
        complaint = self._references.limit(command, self._mode, self._drive.command, self.clock.now_ns())
        if complaint is not None:
            gate.trip("not_finite", complaint, self.clock.now_ns())
        return complaint is None

    def _check_delay(self, stale_after: float) -> None:
        """Whether drives answer before their data are stale [s]; drivers over a link look.

        Raises:
            AdapterConfigurationError: They do not.
        """

    def _forget_states(self) -> None:
        """Drop what has come without having been taken; drivers over a link do."""

    def _start_references(self) -> None:
        """A position reference begins where the joints are now, not where they were when last read."""
        if self._mode != "position":
            return
        began, seen = self.clock.now_ns(), self._drive.feedback
        while not (self._read_into(seen) and seen.time_ns > began):
            if self.clock.now_ns() - began > POSITION_PATIENCE_NS:
                raise AdapterError("the joints do not report where they are: a position reference cannot begin there")
            self.clock.sleep_until(self.clock.now_ns() + POLL_INTERVAL_NS)
        feedback = JointFeedback(len(self.capabilities.joints))
        self._drive.feedback_to_joint(feedback)
        if not self._references.start_at(feedback.position, self.clock.now_ns()):
            raise AdapterError(f"positions {feedback.position} are not known: a position reference cannot begin there")

    def _let_go(self) -> None:
        try:
            self._close()
        except Exception as error:  # closing never raises; what is left belongs to the operating system
            self._close_failure = f"the bus did not close: {error}"

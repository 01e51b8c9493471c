"""The base of every adapter: what users call, with the safety gate inside; drivers fill in the private methods."""

from __future__ import annotations

import threading
from dataclasses import dataclass, replace
from types import TracebackType
from typing import Self, final

from fricomp.control import JointLimits, SafetyGate, TripReason
from fricomp.errors import AdapterError, DriveFault
from fricomp.joint import Capabilities, Clock, CommandMode, JointCommand, JointFeedback, MonotonicClock

from .acceptance import check_counts, check_limits, check_rate, check_watchdog, raise_own
from .drive_side import DriveSide
from .driver import Driver
from .reference import ReferenceLimiter
from .transmission import Transmission

__all__ = ["STOP_PATIENCE", "AdapterOptions", "JointAdapter"]

STOP_PATIENCE = 0.05
"""How long a stop waits for a write in progress before it goes out beside it [s]; a write takes far less."""


@dataclass(frozen=True)
class AdapterOptions:
    """How an adapter is run, whatever the bus.

    Attributes:
        limits: One for each joint; nothing beyond them reaches a drive.
        transmissions: Motor to joint, one for each joint; None where the drive reports the joint side already.
        ramp_time: Time over which torque may rise to its limit after enabling [s].
        stale_after: Age at which feedback counts as lost [s].
        allow_no_watchdog: Enable a drive that would keep its last torque if the bus fell silent.
    """

    limits: tuple[JointLimits, ...]
    transmissions: tuple[Transmission, ...] | None = None
    ramp_time: float = 0.2
    stale_after: float = 0.02
    allow_no_watchdog: bool = False


class JointAdapter(Driver):
    """N joints on a bus. The order is open, configure, enable, then write and read every cycle, and close.

    The public methods are final: they hold the safety gate, the transmission and the order of calls. A driver
    implements the private methods on the drive's own side of the transmission, in SI, and raises errors of
    `fricomp.errors` only. After a fault or a trip nothing re-enables by itself: `clear_faults`, then `enable`.

    One thread, the control thread, calls everything but `safe_stop` and `health`, which any thread may call.

    Args:
        options: Limits and transmissions.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(self, options: AdapterOptions, clock: Clock | None = None) -> None:
        self.options = options
        self.clock: Clock = clock or MonotonicClock()
        self._lock = threading.Lock()
        self._lock_owner = 0
        self._capabilities: Capabilities | None = None
        self._mode: CommandMode = "torque"
        self._gate: SafetyGate | None = None
        self._enabled = False
        self._stop_failure = ""

    # -- what users call --------------------------------------------------------------------------------

    @final
    def open(self) -> Capabilities:
        """Connect and read scaling and limits from the drives. Never energises.

        Raises:
            AdapterConnectionError: The bus or a drive cannot be reached.
            AdapterTimeout: A drive did not answer.
            AdapterConfigurationError: The drives are not what the configuration says.
        """
        if self._capabilities is not None:
            raise AdapterError("the adapter is open already: close() it first")
        self._gate = None
        try:
            drives = self._open()
            n_joints = len(drives.joints)
            transmissions = self.options.transmissions or (Transmission(),) * n_joints
            check_counts(n_joints, limits=self.options.limits, transmissions=transmissions)
            joints = tuple(t.capabilities_to_joint(j) for j, t in zip(drives.joints, transmissions, strict=True))
            check_limits(joints, self.options.limits)
        except BaseException as error:
            self._let_go()
            raise_own(error)
        self._drive = DriveSide(drives, transmissions)
        self._nothing_new = JointFeedback(n_joints)
        self._capabilities = replace(drives, joints=joints)
        return self._capabilities

    @property
    @final
    def capabilities(self) -> Capabilities:
        """What the drives offer, joint side.

        Raises:
            AdapterError: The adapter is not open.
        """
        if self._capabilities is None:
            raise AdapterError("the adapter is not open: call open() first")
        return self._capabilities

    @final
    def configure(self, mode: CommandMode, period: float) -> None:
        """Set the command mode and the period [s] of the loop, write them to the drives and read them back.

        Raises:
            AdapterConfigurationError: The mode is not offered, or bus or watchdog do not go with this rate.
            AdapterError: The joints are enabled, or the gate has tripped and was not cleared.
        """
        check_rate(self.capabilities, mode, period)
        with self._lock:
            if self._enabled:
                raise AdapterError("the joints are enabled: safe_stop() them before configuring")
            if self._gate is not None and self._gate.tripped:
                raise AdapterError(f"the gate has tripped ({self._gate.trip_record}): call clear_faults() first")
            try:
                self._configure(mode, period)
                watchdog = self._confirmed_watchdog() or self.capabilities.watchdog
            except BaseException as error:
                raise_own(error)
            check_watchdog(watchdog, period)
            self._capabilities = replace(self.capabilities, watchdog=watchdog)
            self._mode = mode
            self._references = ReferenceLimiter(self.options.limits, period)
            self._gate = SafetyGate(
                self.options.limits,
                period=period,
                ramp_time=self.options.ramp_time,
                stale_after=self.options.stale_after,
            )

    @final
    def enable(self) -> None:
        """Energise at zero torque; from here on torque ramps up to its limits.

        Raises:
            AdapterError: Not configured, enabled already, or the drive has no confirmed watchdog and none was waived.
            SafetyTrip: The gate has latched: call `clear_faults` first.
            DriveFault: The drive reports a fault.
        """
        gate, watchdog = self._configured_gate(), self.capabilities.watchdog
        if not (self.options.allow_no_watchdog or (watchdog is not None and watchdog.confirmed)):
            raise AdapterError(
                "the drive has no confirmed watchdog and would keep its last torque if the bus fell silent: "
                "set one on the drive, or pass allow_no_watchdog=True to take that risk"
            )
        with self._lock:
            if self._enabled:
                raise AdapterError("the joints are enabled already")
            gate.raise_if_tripped()
            try:
                self._lock_owner = threading.get_ident()
                self._start_references()
                self._drive.zero_command()
                self._enabled = True
                self._enable()
                # Armed last: the ramp begins when the drives are ready, and a stop in the meantime raises here.
                gate.arm(self.clock.now_ns())
                gate.raise_if_tripped()
            except BaseException as error:
                gate.disarm()
                self._stop_drives()
                raise_own(error)
            finally:
                self._lock_owner = 0

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
            if not self._enabled:
                if gate.tripped:
                    return False
                raise AdapterError("the joints are not enabled: call enable() first")
            try:
                self._lock_owner = threading.get_ident()
                if self._admit(command, gate):
                    self._write(self._drive.command_from_joint(), self._mode)
            except BaseException as error:
                gate.trip(_reason_of(error), str(error) or repr(error), self.clock.now_ns())
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
            self._trip(_reason_of(error), str(error) or repr(error))
            self.safe_stop()
            raise_own(error)
        if fresh:
            self._drive.feedback_to_joint(feedback)
        gate = self._gate
        if gate is not None and self._enabled:
            gate.observe(feedback if fresh else self._nothing_new, self.clock.now_ns())
            if gate.tripped:
                self.safe_stop()
        return fresh

    @final
    def safe_stop(self, reason: str = "") -> None:
        """Zero torque, now. From any thread, any number of times; never raises. Nothing queued follows it."""
        self._trip("stop", reason or "stopped")
        if self._lock_owner == threading.get_ident() and self._lock.locked():
            return  # a signal handler inside this thread's own write: that write stops the joints as it ends
        held = self._lock.acquire(timeout=STOP_PATIENCE)  # a writer hung in a bus library must not hold up the stop
        try:
            self._halt()
        finally:
            if held:
                self._lock.release()

    @final
    def clear_faults(self) -> None:
        """Clear drive faults and unlatch the gate. Does not enable.

        Raises:
            DriveFault: The fault stays.
        """
        with self._lock:
            self._halt()
            try:
                self._clear_faults()
            except BaseException as error:
                raise_own(error)
            if self._gate is not None:
                self._gate.reset()
            self._stop_failure = ""

    @property
    @final
    def gate(self) -> SafetyGate:
        """The safety gate, for its record of trips.

        Raises:
            AdapterError: Not configured.
        """
        return self._configured_gate()

    @property
    @final
    def enabled(self) -> bool:
        """Whether the joints are energised, as far as this side knows."""
        return self._enabled

    @final
    def health(self) -> dict[str, float | str]:
        """Counters and states of bus and drives, for display; `stop_failure` if a stop did not get through."""
        health = self._health()
        if self._stop_failure:
            health["stop_failure"] = self._stop_failure
        return health

    @final
    def close(self) -> None:
        """Stop the joints and let go of the bus. Never raises."""
        self.safe_stop("closed")
        self._capabilities = None
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

    def _configured_gate(self) -> SafetyGate:
        if self._gate is None:
            raise AdapterError("the adapter is not configured: call configure(mode, period) first")
        return self._gate

    def _trip(self, reason: TripReason, detail: str) -> None:
        """Latch the gate, if the joints are energised."""
        if self._gate is not None and self._enabled:
            self._gate.trip(reason, detail, self.clock.now_ns())

    def _admit(self, command: JointCommand, gate: SafetyGate) -> bool:
        """Fill the drives' command, still joint side, with what may be sent."""
        if gate.tripped or not gate.admit(command.torque, self._drive.command.torque, self.clock.now_ns()):
            return False
        if self._mode == "torque":
            return True
        complaint = self._references.limit(command, self._mode, self._drive.command)
        if complaint is not None:
            gate.trip("not_finite", complaint, self.clock.now_ns())
        return complaint is None

    def _start_references(self) -> None:
        """A position reference begins where the joints are."""
        if self._mode == "position":
            feedback = JointFeedback(len(self.capabilities.joints))
            self._read_into(self._drive.feedback)
            self._drive.feedback_to_joint(feedback)
            if not self._references.start_at(feedback.position):
                raise AdapterError(f"positions {feedback.position} are not known yet: read_into() once before enable()")

    def _raise_if_stopped(self) -> None:
        """For loops of a driver that wait while enabling: raises `SafetyTrip` once somebody has stopped the joints."""
        self._configured_gate().raise_if_tripped()

    def _halt(self) -> None:
        if self._enabled:
            self._stop_drives()

    def _stop_drives(self) -> None:
        """Stop the drives; a stop that fails is tried once more, and recorded."""
        self._enabled = False
        for _ in range(2):
            try:
                self._stop()
                return
            except Exception as error:
                self._stop_failure = f"the stop did not reach the drive: {error}"
            except BaseException:  # interrupted in the middle of a stop: finish it first
                self._stop()
                raise
        if self._gate is not None:
            self._gate.trip("link", self._stop_failure, self.clock.now_ns())

    def _let_go(self) -> None:
        try:
            self._close()
        except Exception as error:  # closing never raises; what is left belongs to the operating system
            self._stop_failure = self._stop_failure or f"the bus did not close: {error}"


def _reason_of(error: BaseException) -> TripReason:
    if isinstance(error, DriveFault):
        return "drive_fault"
    return "link" if isinstance(error, AdapterError) else "exception"

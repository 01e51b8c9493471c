"""The half of every adapter that stops: from any thread, any number of times, and nothing gets past it."""

import threading
from typing import final

from fricomp.control import SafetyGate
from fricomp.control.gate.trip import TripReason, TripRecord
from fricomp.errors import AdapterError, DriveFault
from fricomp.joint import Clock, MonotonicClock

from .driver import Driver
from .options import AdapterOptions

STOP_PATIENCE = 0.05
"""How long a stop waits for a write in progress before it goes out beside it [s]; a write takes far less."""


class StoppableDriver(Driver):
    """A driver with the safety gate, and with the one lock that a write and a stop share.

    Args:
        options: Limits and transmissions.
        clock: Real time unless a simulation brings its own.
    """

    def __init__(self, options: AdapterOptions, clock: Clock | None = None) -> None:
        self.options = options
        # As they were checked last, at opening and with every configuration: a caller may exchange `options` at any
        # time, and a driver that looked there would let through what no gate has seen.
        self._checked_options = options
        self.clock: Clock = clock or MonotonicClock()
        self._lock = threading.Lock()
        self._lock_owner = 0
        self._gate: SafetyGate | None = None
        self._enabled = False
        self._enabling = False
        self._stop_owed = False  # a stop has been tried and has not got through
        self._stop_failure = ""
        # The last stop that was asked for, and the last that was released: one that came in between is not forgotten.
        self._asked_stop: TripRecord | None = None
        self._released_stop: TripRecord | None = None
        self._released_trip: TripRecord | None = None  # the same of any trip of the gate, whoever resets that

    @final
    def _torques_at_drives(self) -> list[float]:
        """The torque limits of the joints on their drives' side, for the bounds of the drives' own loops."""
        options = self._checked_options
        return [
            abs(gear.torque_to_drive(limit.torque)) for gear, limit in zip(options.gears, options.limits, strict=True)
        ]

    @property
    @final
    def gate(self) -> SafetyGate:
        """The safety gate, for its record of trips. Resetting it releases nothing: `clear_faults` does.

        Raises:
            AdapterError: Not configured.
        """
        return self._configured_gate()

    @property
    @final
    def enabled(self) -> bool:
        """Whether the joints are energised, as far as this side knows."""
        return self._enabled

    @property
    @final
    def stop_failure(self) -> str:
        """Why the last stop did not get through; empty when all did."""
        return self._stop_failure

    @final
    def safe_stop(self, reason: str = "") -> None:
        """Zero torque, now. From any thread, any number of times; never raises. Nothing queued follows it.

        It holds whatever the adapter is doing, also configuring or nothing at all: only `clear_faults` releases it.
        """
        self._asked_stop = TripRecord("stop", reason or "stopped", self.clock.now_ns())
        self._latch()
        self._stop_now()

    def _latch(self) -> None:
        """Trip the gate, which may be a new one or have been reset, on what has not been released."""
        gate, asked = self._gate, self._asked_stop
        if gate is None:
            return
        last = gate.last_trip
        if last is not None and last is not self._released_trip:
            gate.trip(last.reason, last.detail, last.time_ns)
        if asked is not None and asked is not self._released_stop:
            gate.trip(asked.reason, asked.detail, asked.time_ns)

    def _stop_now(self) -> None:
        """Stop the drives from whatever thread this is, as soon as a write in progress has ended."""
        if self._lock_owner == threading.get_ident() and self._lock.locked():
            return  # a signal handler inside this thread's own write: that write stops the joints as it ends
        held = self._lock.acquire(timeout=STOP_PATIENCE)  # a writer hung in a bus library must not hold up the stop
        try:
            self._halt()
        finally:
            if held:
                self._lock.release()

    def _configured_gate(self) -> SafetyGate:
        if self._gate is None:
            raise AdapterError("the adapter is not configured: call configure(mode, period) first")
        return self._gate

    def _trip(self, reason: TripReason, detail: str) -> None:
        """Latch the gate, if the joints are energised or about to be."""
        if self._gate is not None and (self._enabled or self._enabling):
            self._gate.trip(reason, detail, self.clock.now_ns())

    def _release_stop(self, seen: TripRecord | None) -> None:
        """Unlatch the gate, unless a stop has come after the one that was `seen`."""
        self._released_stop = seen
        if self._gate is not None:
            self._released_trip = self._gate.last_trip
            self._gate.reset()
        self._latch()

    def _raise_if_stopped(self) -> None:
        """For loops of a driver that wait while enabling: raises `SafetyTrip` once somebody has stopped the joints."""
        self._configured_gate().raise_if_tripped()

    def _pay_stop(self) -> None:
        """Try a stop that is owed once more.

        Raises:
            AdapterError: It does not get through.
        """
        self._halt()
        if self._stop_owed:
            raise AdapterError(self._stop_failure)

    def _halt(self) -> None:
        if self._enabled or self._stop_owed:
            self._stop_drives()

    def _stop_drives(self) -> None:
        """Stop the drives; a stop that fails is tried once more, recorded, and owed until one gets through."""
        self._enabled, self._stop_owed = False, True
        for _ in range(2):
            try:
                if self._has_stopped():
                    return
            except BaseException:  # interrupted in the middle of a stop: finish it first
                if not self._has_stopped():
                    self._trip_unstopped()
                raise
        self._trip_unstopped()

    def _has_stopped(self) -> bool:
        """Whether the drives took the stop; else `stop_failure` says why not."""
        try:
            self._stop()
        except Exception as error:
            self._stop_failure = f"the stop did not reach the drive: {error}"
            return False
        self._stop_owed, self._stop_failure = False, ""
        return True

    def _trip_unstopped(self) -> None:
        if self._gate is not None:
            self._gate.trip("link", self._stop_failure, self.clock.now_ns())


def reason_of(error: BaseException) -> TripReason:
    """What the gate latches on when `error` ends a cycle."""
    if isinstance(error, DriveFault):
        return "drive_fault"
    return "link" if isinstance(error, AdapterError) else "exception"

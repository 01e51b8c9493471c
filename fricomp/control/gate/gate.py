"""The safety gate: the one place every torque command passes on its way to a drive.

Pure Python floats in lists: for the seven joints of an arm that is several times faster than numpy.
"""

import math
import sys
from collections.abc import Callable, MutableSequence, Sequence
from typing import Any

from fricomp.control.gate.limits import JointLimits
from fricomp.control.gate.motion_watch import MotionWatch
from fricomp.control.gate.trip import TripReason, TripRecord
from fricomp.control.number import is_number
from fricomp.errors import ParameterError, SafetyTrip
from fricomp.joint import JointFeedback

ABSURD_TORQUE_RATIO = 100.0
"""A command this many times the limit is a fault (N·mm for N·m, a diverged controller), not a demand to be clamped."""

_NANOSECONDS = 1e9
_LONGEST = 1e6  # of the times of a gate [s]: in nanoseconds still a whole number
_HIGHEST = sys.float_info.max  # no position is as high as infinity, not even on a joint that turns freely
# Reported torque over its limit, and states in a row, from which a drive's own loop goes too far: noise stays below.
_TOO_MUCH, _IN_A_ROW = 1.25, 3
_UNKNOWN_TEMPERATURE_NS = 1_000_000_000  # drives tell it some ten times a second


class SafetyGate:
    """Lets torque through only when everything is well; once tripped, nothing until an explicit reset.

    A command is checked for finiteness on all joints before anything is clamped, then clamped to the torque
    limits, scaled by the enable ramp and limited in its rate. Every method but `trip` belongs to the control thread.

    Args:
        limits: One entry a joint.
        period: Control period; the torque may change by at most `torque_rate * period` from one command to the
            next, however late it comes [s].
        ramp_time: Time from arming until the full command passes [s].
        stale_after: Age of the joint's data at which the gate trips [s].
        watch_torque: Trip where the joints report more torque than their limits, too: where drives close the loop
            themselves, the torque that passes here is not all that they make.
        quanta: Steps of each joint's position [rad] or [m] and velocity [rad/s] or [m/s], by which motion that
            contradicts itself is told from coarse sensors; none where they are fine.
        describe_faults: Says in words what the fault codes of the joints mean.
        names: Of the joints, for what is told of them; their numbers if none are given.

    Raises:
        ParameterError: No joint, other than one name a joint, or a time that is not finite and positive (`ramp_time`
            may be zero).
    """

    def __init__(
        self,
        limits: Sequence[JointLimits],
        *,
        period: float,
        ramp_time: float = 0.2,
        stale_after: float = 0.02,
        watch_torque: bool = False,
        quanta: Sequence[tuple[float, float]] = (),
        describe_faults: Callable[[Sequence[int]], str] = lambda codes: f"codes {list(codes)}",
        names: Sequence[str] = (),
    ) -> None:
        if not (isinstance(limits, Sequence) and limits and all(isinstance(each, JointLimits) for each in limits)):
            raise ParameterError(f"a safety gate needs the limits of at least one joint, got {limits!r}")
        times = {"period": (period, 1e-9), "ramp_time": (ramp_time, 0.0), "stale_after": (stale_after, 1e-9)}
        for name, (value, lowest) in times.items():
            if not is_number(value, lowest, _LONGEST):
                raise ParameterError(f"{name} must be from {lowest:g} to {_LONGEST:g} s, got {value!r}")
        if names and len(names) != len(limits):
            raise ParameterError(f"{len(names)} names given for {len(limits)} joints: give one for each")
        self.limits = tuple(limits)
        self._names = tuple(names) or tuple(f"joint {number}" for number in range(len(limits)))
        self._period_ns = round(period * _NANOSECONDS)
        self._ramp_ns = max(round(ramp_time * _NANOSECONDS), 1)
        self._stale_ns = round(stale_after * _NANOSECONDS)
        self._torque_limits = [limit.torque for limit in limits]
        self._rates = [limit.torque_rate / _NANOSECONDS for limit in limits]
        self._steps = [rate * self._period_ns for rate in self._rates]
        self._motion = MotionWatch(limits, quanta, period, stale_after, self._names)
        self._fastest = [limit.velocity for limit in limits]
        self._ranges = [limit.position or (-_HIGHEST, _HIGHEST) for limit in limits]
        self._hottest = [(j, limit.temperature) for j, limit in enumerate(limits) if limit.temperature is not None]
        self._too_much = [_TOO_MUCH * limit.torque for limit in limits] if watch_torque else []
        self._n_too_much = 0
        self._describe_faults = describe_faults
        self._last = [0.0] * len(limits)
        self._indices = range(len(limits))
        self._armed = False
        self._open_ns = self._due_ns = self._feedback_ns = self._armed_ns = 0
        self._record: TripRecord | None = None
        self._last_trip: TripRecord | None = None

    @property
    def tripped(self) -> bool:
        """Whether the gate has latched."""
        return self._record is not None

    @property
    def armed(self) -> bool:
        """Whether torque may pass."""
        return self._armed and self._record is None

    @property
    def trip_record(self) -> TripRecord | None:
        """The first trip since the last reset."""
        return self._record

    @property
    def last_trip(self) -> TripRecord | None:
        """The last trip that there was; a reset does not forget it."""
        return self._last_trip

    @property
    def admitted(self) -> Sequence[float]:
        """Torque of each joint that was let through last; zeros where none was."""
        return self._last

    def arm(self, now_ns: int) -> None:
        """Start the enable ramp from zero torque.

        Raises:
            SafetyTrip: The gate is latched; `reset` it first.
        """
        self.raise_if_tripped()
        self._last[:] = [0.0] * len(self._last)
        self._n_too_much = 0
        self._motion.forget()
        self._feedback_ns = self._armed_ns = now_ns
        self._open_ns, self._due_ns = now_ns + self._ramp_ns, now_ns + self._period_ns
        self._armed = True
        if self._record is not None:  # another thread has tripped it between the check and here
            self._armed = False
            self.raise_if_tripped()

    def disarm(self) -> None:
        """Let no torque through until armed again; the ordinary end of a motion, not a trip."""
        self._armed = False
        self._last[:] = [0.0] * len(self._last)

    def trip(self, reason: TripReason, detail: str, now_ns: int | None = None) -> None:
        """Latch. The first record stays. May be called from any thread."""
        if self._record is None:  # before anything else: an `arm` that comes between the two lines finds it
            self._record = self._last_trip = TripRecord(reason, detail, now_ns)
        self._armed = False

    def reset(self) -> None:
        """Forget the trip. The gate stays closed until it is armed; nothing but the user's own code calls this.

        The gate of an adapter latches again on the same trip, until its `clear_faults` releases it.
        """
        self.disarm()
        self._record = None

    def raise_if_tripped(self) -> None:
        """Raise what the gate latched on.

        Raises:
            SafetyTrip: The gate is latched.
        """
        if self._record is not None:
            raise SafetyTrip(f"{self._record}; find the cause, then reset the safety gate (an adapter: clear_faults())")

    def observe(self, feedback: JointFeedback, now_ns: int) -> bool:
        """Look at the joints' state and trip on anything outside the limits.

        A temperature of NaN is not known yet, which a joint with a limit on it may be for a second after `arm`.
        Nothing at all (`time_ns` 0) ages from `arm`; of a gate that is not armed nothing ages.

        Args:
            feedback: State of all joints; the newest there is, even when nothing new has come.
            now_ns: Time on the clock of `feedback.time_ns` [ns].

        Returns:
            Whether all is well.
        """
        if feedback.time_ns:
            self._feedback_ns = feedback.time_ns
            try:
                if not self._is_well(feedback):
                    self._trip_state(feedback, now_ns)
                elif feedback.time_ns >= self._motion.due_ns and self._armed:
                    self._watch_motion(feedback, now_ns)
                if self._too_much:
                    self._watch_torque(feedback.torque, now_ns)
            except (TypeError, ValueError, OverflowError) as error:
                self.trip("not_finite", f"the feedback cannot be read: {error}", now_ns)
        self._watch_age(now_ns)
        return self._record is None

    def _is_well(self, feedback: JointFeedback) -> bool:
        """Whether no drive has a fault and every joint is within its limits; NaN is not within.

        Raises:
            ValueError: The state is that of another number of joints.
        """
        position, velocity, temperature = feedback.position, feedback.velocity, feedback.temperature
        if not len(position) == len(velocity) == len(temperature) == len(self._last):
            raise ValueError(f"state of {len(position)} joints, expected {len(self._last)}")
        fastest, lowest, highest = self._fastest, self._motion.lowest, self._motion.highest
        for j in self._indices:  # cheaper than any zip
            limit = fastest[j]
            if not (-limit <= velocity[j] <= limit and lowest[j] <= position[j] <= highest[j]):
                return False
        for j, hottest in self._hottest:
            if not temperature[j] <= hottest:
                return False
        return not any(feedback.fault)

    def _watch_motion(self, feedback: JointFeedback, now_ns: int) -> None:
        """Trip where the motion contradicts itself, or the torque that acts."""
        found = self._motion.look(feedback, feedback.torque if self._too_much else self._last)
        if found is not None:
            self.trip(found.reason, found.detail, now_ns)

    def _watch_torque(self, torque: Sequence[float], now_ns: int) -> None:
        """Trip where joints keep reporting too much; NaN is a torque that the drive does not tell."""
        beyond = any(abs(reported) > most for reported, most in zip(torque, self._too_much, strict=True))
        self._n_too_much = self._n_too_much + 1 if beyond else 0
        if self._n_too_much >= _IN_A_ROW:
            detail = f"the joints report torques {list(torque)}, limits {self._torque_limits}"
            self.trip("overtorque", detail, now_ns)

    def _trip_state(self, feedback: JointFeedback, now_ns: int) -> None:
        """Find out which limit it was."""
        if any(feedback.fault):
            self.trip("drive_fault", f"the drives report {self._describe_faults(feedback.fault)}", now_ns)
        rows = zip(self._names, feedback.position, feedback.velocity, self._fastest, self._ranges, strict=True)
        for name, q, v, fastest, (lowest, highest) in rows:
            if not (math.isfinite(q) and math.isfinite(v)):
                self.trip("not_finite", f"{name} reports position {q!r} and velocity {v!r}", now_ns)
            elif abs(v) > fastest:
                self.trip("overspeed", f"{name} moves at {v:g}, limit {fastest:g}", now_ns)
            elif not lowest <= q <= highest:
                detail = f"{name} is at {q:g}, limits {lowest:g} to {highest:g}"
                self.trip("position_limit", detail, now_ns)
        for joint, hottest in self._hottest:
            hot, name = feedback.temperature[joint], self._names[joint]
            if hot > hottest:
                self.trip("overtemperature", f"{name} is at {hot:g} °C, limit {hottest:g}", now_ns)
            elif math.isnan(hot) and self._armed and now_ns - self._armed_ns > _UNKNOWN_TEMPERATURE_NS:
                detail = f"{name} does not report its temperature, limit {hottest:g} °C"
                self.trip("overtemperature", detail, now_ns)
        if self._record is None and self._armed:  # within its limits, and farther than it could come unseen
            self._watch_motion(feedback, now_ns)

    def admit(self, torque_in: Sequence[float] | Any, torque_out: MutableSequence[float] | Any, now_ns: int) -> bool:
        """Check, clamp, ramp and rate-limit a command for all joints.

        Args:
            torque_in: Wanted torque of each joint; a list of floats is fastest.
            torque_out: Filled with what may be sent: zeros where nothing may.
            now_ns: Time on the clock that armed the gate [ns].

        Returns:
            Whether the command may be sent; False when tripped (also by this command) or not armed.
        """
        last = self._last
        wanted: list[float] = []
        try:
            wanted = list(map(float, torque_in))
        except (TypeError, ValueError, OverflowError) as error:
            self.trip("not_finite", f"the torque command {torque_in!r} cannot be read: {error}", now_ns)
        self._watch_age(now_ns)
        if not self._armed or self._record is not None or len(wanted) != len(last):
            return self._refuse(wanted, torque_out, now_ns)
        if now_ns < self._open_ns or now_ns < self._due_ns or not self._is_within(wanted):
            if not all(map(self._is_sane, wanted, self._torque_limits)):
                return self._refuse(wanted, torque_out, now_ns)
            wanted = self._bound_torque(wanted, now_ns)
        last[:] = torque_out[:] = wanted
        self._due_ns = now_ns + self._period_ns
        # Another thread may have tripped the gate while this one was computing.
        return True if self._armed and self._record is None else self._close(torque_out)

    def _is_within(self, wanted: list[float]) -> bool:
        """Whether nothing has to be bounded, which is the rule; NaN is never within."""
        last, limits, steps = self._last, self._torque_limits, self._steps
        for j in self._indices:
            torque, limit, step = wanted[j], limits[j], steps[j]  # comparisons are cheaper than calls of abs
            if not (-limit <= torque <= limit and -step <= torque - last[j] <= step):
                return False
        return True

    def _bound_torque(self, wanted: list[float], now_ns: int) -> list[float]:
        """Clamped, on the enable ramp, and within the steps that the time since the last command allows."""
        elapsed = max(now_ns - self._due_ns + self._period_ns, 0)
        steps = self._steps if elapsed >= self._period_ns else [rate * elapsed for rate in self._rates]
        ramp = min(max((now_ns - self._open_ns + self._ramp_ns) / self._ramp_ns, 0.0), 1.0)
        return list(map(_bound, wanted, self._last, self._torque_limits, steps, [ramp] * len(wanted)))

    @staticmethod
    def _is_sane(torque: float, limit: float) -> bool:
        """Whether a torque is finite and may be clamped; written so that NaN fails it."""
        return abs(torque) <= ABSURD_TORQUE_RATIO * limit

    def _refuse(self, wanted: list[float], torque_out: MutableSequence[float] | Any, now_ns: int) -> bool:
        """Name what is wrong with a command, if it is the command, and let nothing through."""
        if self._armed:
            if len(wanted) != len(self._last):
                self.trip("wrong_joint_count", f"{len(self._last)} torques expected, got {len(wanted)}", now_ns)
            elif not all(map(math.isfinite, wanted)):
                self.trip("not_finite", f"torque command {wanted}", now_ns)
            else:
                absurd = [ABSURD_TORQUE_RATIO * limit for limit in self._torque_limits]
                self.trip("absurd_command", f"torque command {wanted}, absurd beyond {absurd}", now_ns)
        return self._close(torque_out)

    def _watch_age(self, now_ns: int) -> None:
        if not self._armed or -self._stale_ns <= now_ns - self._feedback_ns <= self._stale_ns:
            return
        age, limit = (now_ns - self._feedback_ns) / 1e6, self._stale_ns / 1e6
        self.trip("stale", f"the data of the joints is {age:.1f} ms old, limit {limit:.1f} ms", now_ns)

    def _close(self, torque_out: MutableSequence[float] | Any) -> bool:
        for joint in range(len(self._last)):
            self._last[joint] = torque_out[joint] = 0.0
        return False


def _bound(torque: float, before: float, limit: float, step: float, ramp: float) -> float:
    """Clamped to the limit, scaled by the ramp, within one step of the torque before."""
    goal = (limit if torque > limit else -limit if torque < -limit else torque) * ramp
    return before + step if goal > before + step else before - step if goal < before - step else goal

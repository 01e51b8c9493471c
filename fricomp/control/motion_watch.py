"""Motion that contradicts itself: a position that jumps, or stands while its velocity runs; a joint that does not move.

Looked at every few milliseconds, because a contradiction shows over a stretch of time; in between the gate's own range
of positions is drawn tight around where the joint is, so that a jump is seen in the cycle in which it comes.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import exp, inf
from typing import Literal, NamedTuple

from fricomp.control.limits import JointLimits
from fricomp.joint import JointFeedback

__all__ = ["Contradiction", "MotionReason", "MotionWatch"]

MotionReason = Literal["jump", "contradiction", "frozen", "runaway"]

LOOK_NS = 5_000_000
"""Time between looks [ns]: ten of them in the 50 ms within which a contradiction must be found."""
LAG = 0.015
"""Time by which a reported velocity may be later than the position [s]: filters of drives stay below."""
LAG_OF_STALE = 0.25
"""Share of the age at which data are stale that their age may vary by [1]."""
MEMORY = 2.0
"""Time over which position and velocity are compared, in lags [1]: a contradiction shows after 0.7 of it."""
HOLD = 0.3
"""How long a speed that was reported counts, fading [s]: the lag of a joint that has just stopped is still to come."""
STEPS_OF_POSITION = 2.0
"""Steps of the encoder by which a position may be off [1]: one at either end."""
STEPS_OF_VELOCITY = 0.5
"""Steps of the reported velocity by which it may be off all the time [1]: it is rounded."""
SHARE_OF_VELOCITY = 0.005
"""Error of a reported velocity that is no contradiction yet, of the velocity limit [1]: offsets of tachometers."""
STANDING = 0.035
"""Time without one step of the encoder, under more than the breakaway torque, that a live joint does not stand [s]."""
RUNNING = 0.03
"""Time over which a joint may go on speeding up against a large torque [s]: delays and filters are shorter."""
GAINED = 0.02
"""Speed that a runaway must have gained meanwhile, of the velocity limit [1]: more than noise."""
HORIZON = 0.01
"""Time over which a position may move before it is looked at again [s]: two looks."""
HEADROOM = 0.25
"""Share of the velocity limit by which a joint may become faster within that time [1]."""


class Contradiction(NamedTuple):
    """What does not fit.

    Attributes:
        reason: Its kind.
        detail: In words, with values and limits.
    """

    reason: MotionReason
    detail: str


class MotionWatch:
    """Compares positions, velocities and torques of all joints over time.

    With the drift r of the position against the integral of the velocity, which fades over twice the lag, a joint is
    well while |r| <= lag · (fastest speed of late) + two steps of position + what rounding and offset of the velocity make of it.

    Args:
        limits: One entry a joint.
        quanta: Steps of position [rad] or [m] and velocity [rad/s] or [m/s] of each joint; none where unknown.
        period: Control period [s].
        stale_after: Age at which data are stale [s].

    Attributes:
        lowest: Lowest position of each joint that needs no closer look.
        highest: Highest.
        due_ns: Time of the state that is to be looked at next [ns].
    """

    def __init__(
        self,
        limits: Sequence[JointLimits],
        quanta: Sequence[tuple[float, float]],
        period: float,
        stale_after: float,
    ) -> None:
        self.lag = LAG + LAG_OF_STALE * stale_after
        self._interval = 1e-9 * LOOK_NS + period
        self._joints = range(len(limits))
        self._ranges = [limit.position or (-inf, inf) for limit in limits]
        self._fastest = [limit.velocity for limit in limits]
        self._breakaway = [limit.breakaway_torque for limit in limits]
        steps = list(quanta) or [(0.0, 0.0)] * len(limits)
        self._floors = [
            STEPS_OF_POSITION * q + MEMORY * self.lag * (STEPS_OF_VELOCITY * v + SHARE_OF_VELOCITY * limit.velocity)
            for (q, v), limit in zip(steps, limits, strict=True)
        ]
        self.lowest, self.highest = [low for low, _ in self._ranges], [high for _, high in self._ranges]
        self._position, self._velocity = [0.0] * len(limits), [0.0] * len(limits)
        self.forget()

    def forget(self) -> None:
        """Begin anew; until the first look every position within the limits is taken."""
        n = len(self._joints)
        self.due_ns = self._seen_ns = 0
        self._gap = 0.0
        self._speed, self._drift = [0.0] * n, [0.0] * n
        self._standing, self._running, self._running_from = [0.0] * n, [0.0] * n, [0.0] * n
        self.lowest[:], self.highest[:] = [low for low, _ in self._ranges], [high for _, high in self._ranges]

    def look(self, feedback: JointFeedback, torque: Sequence[float]) -> Contradiction | None:
        """Compare a new state, finite and within the limits, with the last one that was looked at.

        Args:
            feedback: State of all joints.
            torque: That acts on them, either admitted or reported.
        """
        elapsed = (feedback.time_ns - self._seen_ns) * 1e-9
        if elapsed <= 0.0:
            return None
        is_first, self._seen_ns = self._seen_ns == 0, feedback.time_ns
        self.due_ns = feedback.time_ns + LOOK_NS
        found = None if is_first else self._compare(feedback, torque, elapsed)
        self._position[:], self._velocity[:] = feedback.position, feedback.velocity
        self._tighten()
        return found

    def _compare(self, feedback: JointFeedback, torque: Sequence[float], elapsed: float) -> Contradiction | None:
        position, velocity = feedback.position, feedback.velocity
        fading, leaking = exp(-elapsed / HOLD), exp(-elapsed / (MEMORY * self.lag))
        self._gap = max(self._gap * fading, elapsed - self._interval)  # nobody knows when in a gap a state was taken
        allowed = self.lag + self._gap
        for j in self._joints:
            step, v = position[j] - self._position[j], velocity[j]
            self._speed[j] = speed = max(abs(v), self._speed[j] * fading)
            if abs(step) > self._reach(j, elapsed):
                return Contradiction("jump", f"joint {j} jumps by {step:.4g} within {1e3 * elapsed:.3g} ms")
            self._drift[j] = drift = self._drift[j] * leaking + step - 0.5 * (v + self._velocity[j]) * elapsed
            if abs(drift) > allowed * speed + self._floors[j]:
                return Contradiction(
                    "contradiction",
                    f"joint {j} reports {v:.4g} as its velocity, and its position has moved by {drift:.4g} more than "
                    f"that of late, limit {allowed * speed + self._floors[j]:.4g}",
                )
            if abs(torque[j]) > self._breakaway[j]:
                found = self._watch_answer(j, step, v, torque[j], elapsed)
                if found is not None:
                    return found
            else:
                self._standing[j] = self._running[j] = 0.0
        return None

    def _watch_answer(self, j: int, step: float, v: float, torque: float, elapsed: float) -> Contradiction | None:
        """Whether a joint answers a torque beyond its breakaway torque: it moves, and not ever faster against it."""
        under = f"joint {j} under {torque:.4g}, more than its breakaway torque {self._breakaway[j]:.4g},"
        self._standing[j] = 0.0 if step else self._standing[j] + elapsed
        if self._standing[j] > STANDING:
            return Contradiction(
                "frozen",
                f"{under} has not moved by one step for {1e3 * self._standing[j]:.0f} ms: its encoder has failed, or "
                f"it is blocked; where friction holds it there, raise the limit breakaway",
            )
        if v * torque >= 0.0 or abs(v) <= self._running_from[j] or not self._running[j]:
            self._running[j], self._running_from[j] = (elapsed if v * torque < 0.0 else 0.0), abs(v)
            return None
        self._running[j] += elapsed
        gained = abs(v) - self._running_from[j]
        if self._running[j] > RUNNING and gained > GAINED * self._fastest[j]:
            return Contradiction(
                "runaway",
                f"{under} moves against it and has become faster by {gained:.4g} in {1e3 * self._running[j]:.0f} ms: "
                f"its sensor is mirrored, or a load overcomes the drive",
            )
        return None

    def _reach(self, joint: int, elapsed: float) -> float:
        """How far a joint may move within a time [s]."""
        faster = 2.0 * self._speed[joint] + HEADROOM * self._fastest[joint]
        return faster * max(elapsed, HORIZON) + self._floors[joint]

    def _tighten(self) -> None:
        for j in self._joints:
            reach, at, (low, high) = self._reach(j, HORIZON), self._position[j], self._ranges[j]
            self.lowest[j] = max(low, at - reach)
            self.highest[j] = min(high, at + reach)

"""Motion that contradicts itself: a position that jumps, or stands while its velocity runs; a joint that does not move.

Looked at every few milliseconds, because a contradiction shows over a stretch of time; in between the gate's own range
of positions is drawn tight around where the joint is, so that a jump is seen in the cycle in which it comes.
"""

from collections.abc import Sequence
from math import exp, inf
from typing import Literal, NamedTuple

from fricomp.control.gate.limits import JointLimits
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
"""Time without one step of the encoder, while friction cannot hold the joint, that a live joint does not stand [s]."""
LARGE = 0.8
"""Torque against which no load should speed a joint up, of the torque limit [1]: the drive has nothing left to add."""
RUNNING = 0.03
"""Time over which a joint may go on speeding up against such a torque [s]: delays and filters are shorter."""
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
    well while |r| <= lag · (fastest speed of late) + two steps of position + what rounding and offset of the velocity
    make of it. One that stands still is held by friction, whatever its load, while the torques at that place differ by
    less than twice its breakaway torque.

    Args:
        limits: One entry a joint.
        quanta: Steps of position [rad] or [m] and velocity [rad/s] or [m/s] of each joint; none where unknown.
        period: Control period [s].
        stale_after: Age at which data are stale [s].
        names: What each joint is called where it is told of.

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
        names: Sequence[str],
    ) -> None:
        self._names = names
        lag = self._lag = LAG + LAG_OF_STALE * stale_after
        self._memory = MEMORY * lag
        self._interval = 1e-9 * LOOK_NS + period
        self._joints = range(len(limits))
        self._ranges = [limit.position or (-inf, inf) for limit in limits]
        self._limits = tuple(limits)
        self._bands = [2.0 * limit.breakaway_torque for limit in limits]
        self._large = [LARGE * limit.torque for limit in limits]
        self._headroom = [HEADROOM * limit.velocity for limit in limits]
        steps = list(quanta) or [(0.0, 0.0)] * len(limits)
        self._floors = [
            STEPS_OF_POSITION * q + self._memory * (STEPS_OF_VELOCITY * v + SHARE_OF_VELOCITY * limit.velocity)
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
        self._least, self._most, self._standing = [0.0] * n, [0.0] * n, [0.0] * n
        self._running, self._running_from = [0.0] * n, [0.0] * n
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
        is_first, self._seen_ns, self.due_ns = not self._seen_ns, feedback.time_ns, feedback.time_ns + LOOK_NS
        if is_first:  # nothing to compare with
            self._position[:], self._velocity[:] = feedback.position, feedback.velocity
            self._least[:] = self._most[:] = torque
            return None
        found = None
        fading, leaking = exp(-elapsed / HOLD), exp(-elapsed / self._memory)
        self._gap = max(self._gap * fading, elapsed - self._interval)  # nobody knows when in a gap a state was taken
        least, most, bands, large = self._least, self._most, self._bands, self._large
        for j in self._joints:
            q, u = feedback.position[j], torque[j]
            if q != self._position[j]:
                least[j] = most[j] = u
                self._standing[j] = 0.0
            elif not least[j] <= u <= most[j]:
                least[j], most[j] = min(least[j], u), max(most[j], u)
            found = self._compare(j, q, feedback.velocity[j], elapsed, fading, leaking) or found
            if most[j] - least[j] > bands[j]:
                found = self._watch_standing(j, u, elapsed) or found
            if -large[j] <= u <= large[j]:
                self._running[j] = 0.0
            else:
                found = self._watch_running(j, u, elapsed) or found
        return found

    def _compare(
        self, j: int, q: float, v: float, elapsed: float, fading: float, leaking: float
    ) -> Contradiction | None:
        """Position against velocity; and how far the joint may be when it is looked at again."""
        floor, step = self._floors[j], q - self._position[j]
        speed, faded = v if v >= 0.0 else -v, self._speed[j] * fading
        if faded > speed:
            speed = faded
        drift = self._drift[j] * leaking + step - 0.5 * (v + self._velocity[j]) * elapsed
        reach = 2.0 * speed + self._headroom[j]
        self._position[j], self._velocity[j], self._speed[j], self._drift[j] = q, v, speed, drift
        farthest = reach * (elapsed if elapsed > HORIZON else HORIZON) + floor
        if not -farthest <= step <= farthest:
            return Contradiction("jump", f"{self._names[j]} jumps by {step:.4g} within {1e3 * elapsed:.3g} ms")
        allowed = (self._lag + self._gap) * speed + floor
        if not -allowed <= drift <= allowed:
            return Contradiction(
                "contradiction",
                f"{self._names[j]} reports {v:.4g} as its velocity, and its position has moved by {drift:.4g} more "
                f"than that of late, limit {allowed:.4g}",
            )
        reach, (low, high) = reach * HORIZON + floor, self._ranges[j]
        least, most = q - reach, q + reach
        self.lowest[j] = least if least > low else low
        self.highest[j] = most if most < high else high
        return None

    def _watch_standing(self, j: int, torque: float, elapsed: float) -> Contradiction | None:
        """Whether a joint stands where friction held it under a torque that differs from this one by too much."""
        least, most, band = self._least[j], self._most[j], self._bands[j]
        is_held = torque - least <= band and most - torque <= band
        self._standing[j] = 0.0 if is_held else self._standing[j] + elapsed
        if self._standing[j] <= STANDING:
            return None
        return Contradiction(
            "frozen",
            f"{self._names[j]} has not moved by one step for {1e3 * self._standing[j]:.0f} ms under {torque:.4g}, and "
            f"stood there under {least if torque - least > band else most:.4g}: no friction up to its breakaway limit "
            f"{0.5 * band:.4g} holds it under both. Its encoder has failed, or it is blocked; where it sticks as hard "
            f"as that, raise its limit breakaway",
        )

    def _watch_running(self, j: int, torque: float, elapsed: float) -> Contradiction | None:
        """Whether a joint becomes ever faster against almost all that its drive may give."""
        v = self._velocity[j]
        if v * torque >= 0.0:
            self._running[j] = 0.0
            return None
        if not self._running[j] or abs(v) <= self._running_from[j]:
            self._running[j], self._running_from[j] = elapsed, abs(v)
            return None
        self._running[j] += elapsed
        gained = abs(v) - self._running_from[j]
        if self._running[j] <= RUNNING or gained <= GAINED * self._limits[j].velocity:
            return None
        return Contradiction(
            "runaway",
            f"{self._names[j]} moves against a torque of {torque:.4g} and has become faster by {gained:.4g} in "
            f"{1e3 * self._running[j]:.0f} ms: its sensor is mirrored, or a load overcomes the drive",
        )

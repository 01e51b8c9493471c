"""How far a joint travels before the safety gate stops it, when its sensor lies or nothing holds its torque back.

The gate itself is asked, in a loop around a joint without friction, which would only shorten the way.
"""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf
from typing import NamedTuple

from fricomp.control.gate.gate import SafetyGate
from fricomp.control.gate.limits import JointLimits
from fricomp.control.settings import LoopDynamics
from fricomp.joint import JointFeedback

_KNOWN_AFTER = 0.1
"""Time that the gate has seen the joint before it fails [s]."""
_LONGEST = 5.0
"""Time after which a failure that has not been found counts as one without a bound [s]."""
_OFFSET = 1e-3
"""Distance to the reference from which a mirrored loop runs away [rad] or [m]: from a smaller one it takes longer, and
comes as far."""


class _State(NamedTuple):
    position: float
    velocity: float


@dataclass(frozen=True)
class Failure:
    """Something that goes wrong.

    Attributes:
        sense: The state that is reported, of the one at which the failure began and the true one.
        speed: Speed of the joint as it begins, of the velocity limit [1].
        is_in_loop: Whether the position loop commands the torque; full torque else.
    """

    sense: Callable[[_State, _State], _State]
    speed: float = 0.0
    is_in_loop: bool = False


FAILURES: dict[str, Failure] = {
    "sensor mirrored": Failure(
        lambda first, true: _State(2.0 * first.position - true.position, -true.velocity), is_in_loop=True
    ),
    "sensor frozen at full speed": Failure(lambda first, true: first, speed=1.0),
    "full torque": Failure(lambda first, true: true),
}
"""Failures by name."""


def bound_travel(loop: LoopDynamics, limits: JointLimits, period: float, stale_after: float = 0.02) -> dict[str, float]:
    """Travel from the beginning of each of `FAILURES` to the gate's trip; infinity where it does not trip.

    Args:
        loop: The position loop.
        limits: Of the gate; the range of positions is left out.
        period: Control period [s].
        stale_after: Age at which the gate takes data for stale [s].

    Returns:
        Travel by name of the failure [rad] or [m].
    """
    free = replace(limits, position=None)
    return {name: _measure_travel(failure, loop, free, period, stale_after) for name, failure in FAILURES.items()}


def _measure_travel(
    failure: Failure, loop: LoopDynamics, limits: JointLimits, period: float, stale_after: float
) -> float:
    gate = SafetyGate([limits], period=period, ramp_time=0.0, stale_after=stale_after)
    now, period_ns = 1_000_000_000, round(period * 1e9)
    gate.arm(now)
    feedback, sent = JointFeedback(1), [0.0]
    true = first = _State(0.0, failure.speed * limits.velocity)
    seen = deque([first] * (1 + round(loop.delay / period)))
    n_known = round(_KNOWN_AFTER / period)
    for tick in range(n_known + round(_LONGEST / period)):
        speed = true.velocity + sent[0] / loop.inertia * period
        true = _State(true.position + speed * period, speed)
        seen.append(true)
        late, now = seen.popleft(), now + period_ns
        first = late if tick <= n_known else first
        shown = failure.sense(first, late) if tick > n_known else late
        feedback.time_ns, feedback.position[0], feedback.velocity[0] = now, *shown
        gate.observe(feedback, now)
        if not gate.admit([_command(failure, loop, limits, first, shown, tick > n_known)], sent, now):
            return abs(true.position - first.position)
    return inf


def _command(
    failure: Failure, loop: LoopDynamics, limits: JointLimits, first: _State, shown: _State, has_failed: bool
) -> float:
    if not has_failed:
        return 0.0
    if not failure.is_in_loop:
        return limits.torque
    error = first.position + _OFFSET - shown.position
    return max(-limits.torque, min(limits.torque, loop.stiffness * error - loop.damping * shown.velocity))

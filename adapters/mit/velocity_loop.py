"""A velocity mode for motors that take a damping with every command: tau = D (dq_r - dq) + tau_ff [katz2018].

The damping acts in the motor, on the motor's own encoder: far faster and finer than anything closed over the 12-bit
velocities on the bus. The slow part, a stiffness on the integrated reference, is closed here and sent as torque, with
what rounding takes off the reference. A stiffness in the motor would be wrong: between two commands its reference
stands while the joint moves on, and the torque is a sawtooth that the reports, one a command, sample at one phase.
"""

from __future__ import annotations

from dataclasses import dataclass

from fricomp.errors import AdapterConfigurationError

from ..link import CanFrame
from .codec import saturate
from .motor import Motor

__all__ = ["LoopGains", "MotorVelocityLoop", "loop_gains"]


@dataclass(frozen=True)
class LoopGains:
    """Gains of the velocity mode, at the motor.

    Attributes:
        stiffness: K, closed on the host [N·m/rad].
        damping: D, closed in the motor [N·m·s/rad].
    """

    stiffness: float
    damping: float


def loop_gains(stiffness: float | None, damping: float | None, motor: Motor, joint: str) -> LoopGains | None:
    """The gains with the damping that the motor will understand; None if none are wanted.

    Raises:
        AdapterConfigurationError: Only one is given, or one is outside its range.
    """
    if stiffness is None and damping is None:
        return None
    highest = motor.ranges.kd
    if stiffness is None or damping is None or not (stiffness > 0.0 and 0.0 < damping <= highest):
        raise AdapterConfigurationError(
            f"joint {joint!r}: velocity mode needs a stiffness above 0 and a damping above 0 and at most {highest:g} "
            f"at this motor, got {stiffness!r} and {damping!r}"
        )
    step = highest / motor.gain_codes
    return LoopGains(stiffness, max(1, round(damping / step)) * step)


class MotorVelocityLoop:
    """The loop of one motor, cycle by cycle.

    Args:
        motor: Which.
        gains: Of the loop.
        torque_limit: Of the safety gate, at the motor; the loop never demands more [N·m].
        period: Between commands [s].
        position: Where the motor is [rad].
    """

    def __init__(self, motor: Motor, gains: LoopGains, torque_limit: float, period: float, position: float) -> None:
        self._motor, self._gains = motor, gains
        self._limit, self._period = torque_limit, period
        self._lead = torque_limit / gains.stiffness
        self._reference = position

    def frame(self, velocity: float, torque: float, at: float, moving: float) -> CanFrame:
        """The command for a reference.

        Args:
            velocity: Reference [rad/s].
            torque: Feed-forward [N·m].
            at: Newest reported position [rad].
            moving: Newest reported velocity [rad/s].

        Raises:
            AdapterValueError: A value is not finite.
        """
        stiffness, damping = self._gains.stiffness, self._gains.damping
        # The reference never runs further ahead than full torque.
        self._reference = at + saturate(self._reference + velocity * self._period - at, self._lead)
        limit, step = self._motor.ranges.velocity, self._motor.quanta[1]
        sent = round((saturate(velocity, limit) + limit) / step) * step - limit
        torque += stiffness * (self._reference - at) + damping * (velocity - sent)
        # What the motor will make of it, as far as one can tell from here, stays inside the limit.
        demand = torque + damping * (sent - moving)
        torque += saturate(demand, self._limit) - demand
        return self._motor.command_frame(0.0, sent, 0.0, damping, torque)

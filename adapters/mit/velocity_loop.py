"""A velocity mode for motors that take a damping with every command: tau = D (dq_r - dq) + tau_ff [katz2018].

The damping acts in the motor, on the motor's own encoder: far faster and finer than anything closed over the 12-bit
velocities on the bus. The slow part, a stiffness on the integrated reference, is closed here and sent as torque, with
what rounding takes off the reference. A stiffness in the motor would be wrong: between two commands its reference
stands while the joint moves on, and the torque is a sawtooth that the reports, one a command, sample at one phase.
"""

from dataclasses import dataclass
from math import ceil, floor

from fricomp.errors import AdapterConfigurationError

from ..link import CanFrame
from .codec import saturate
from .motor import Motor


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
    gains = LoopGains(stiffness, max(1, round(damping / step)) * step)
    if gains.damping * motor.quanta[1] > motor.ranges.torque:  # no code would be near enough to a velocity
        raise AdapterConfigurationError(
            f"joint {joint!r}: a damping of {gains.damping:g} times a step of velocity, {motor.quanta[1]:g}, is beyond "
            f"the motor's torque range of {motor.ranges.torque:g}: lower the damping"
        )
    return gains


class MotorVelocityLoop:
    """The loop of one motor, cycle by cycle.

    At the velocity last reported, the motor makes of every command at most the torque limit, or the steps of its codes
    where they are coarser. Until the next command its damping opposes every change of velocity by D times the change.

    Args:
        motor: Which.
        gains: Of the loop.
        torque_limit: Of the safety gate, at the motor; the loop never demands more [N·m].
        period: Between commands [s]; commands that come faster move the reference no faster.
        position: Where the motor is [rad].
        now_ns: The time there [ns].
    """

    def __init__(
        self, motor: Motor, gains: LoopGains, torque_limit: float, period: float, position: float, *, now_ns: int = 0
    ) -> None:
        self._motor, self._gains = motor, gains
        self._limit, self._period_ns = torque_limit, round(period * 1e9)
        self._sent_ns, self._due_ns = now_ns, self._period_ns
        # What rounding the torque sent and the velocity reported may add to what the motor exerts.
        self._margin = 0.5 * (motor.quanta[2] + gains.damping * motor.quanta[1])
        self._reference = position

    def frame(
        self, velocity: float, torque: float, at: float, moving: float, share: float = 1.0, *, now_ns: int
    ) -> CanFrame:
        """The command for a reference.

        Args:
            velocity: Reference [rad/s].
            torque: Feed-forward [N·m].
            at: Newest reported position [rad].
            moving: Newest reported velocity [rad/s].
            share: Of the torque limit that may be used now, from 0 to 1.
            now_ns: The time [ns].

        Raises:
            AdapterValueError: A value is not finite.
        """
        stiffness, damping = self._gains.stiffness, self._gains.damping
        limit = self._limit * saturate(share, 1.0)
        # The reference never runs further ahead than full torque.
        ahead = velocity * self._step_time(now_ns)
        reference = at + saturate(self._reference + ahead - at, limit / stiffness)
        most = max(limit - self._margin, 0.0)
        demand = saturate(torque + stiffness * (reference - at) + damping * (velocity - moving), most)
        self._reference = reference
        sent = self._sent_velocity(velocity, moving, demand)
        return self._motor.command_frame(0.0, sent, 0.0, damping, demand - damping * (sent - moving))

    def _step_time(self, now_ns: int) -> float:
        """For how long the reference moves now [s]: one period at most, and over time no more than has passed.

        What a command comes early, the next may make up for; without that, jitter would slow the reference down.
        """
        passed = max(now_ns - self._sent_ns, 0)
        self._sent_ns = now_ns
        due = min(self._due_ns + passed, self._period_ns + self._period_ns // 2)
        step = min(due, self._period_ns)
        self._due_ns = due - step
        return step * 1e-9

    def _sent_velocity(self, wanted: float, moving: float, demand: float) -> float:
        """The code nearest to a velocity at which the torque range can still make up for what the damping overdoes."""
        (_, step, _), ranges, damping = self._motor.quanta, self._motor.ranges, self._gains.damping
        # What goes out as torque, demand - D (sent - moving), stays inside the range; rounded inwards.
        lowest = ceil((moving + (demand - ranges.torque) / damping + ranges.velocity) / step)
        highest = floor((moving + (demand + ranges.torque) / damping + ranges.velocity) / step)
        code = round((saturate(wanted, ranges.velocity) + ranges.velocity) / step)
        return saturate(min(max(code, lowest), highest) * step - ranges.velocity, ranges.velocity)

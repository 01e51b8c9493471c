"""What is written into MuJoCo's joint at every step: friction, outside torque and strength of the motor."""

from collections.abc import Callable, Sequence
from math import copysign, cos, exp, sin
from typing import NamedTuple

from .joint import COULOMB, STATIC, STRIBECK, VISCOUS

__all__ = ["Acting", "Law", "State", "dry_level", "ordinary"]

_REST = 1e-3  # [rad/s] below which a joint rests


class State(NamedTuple):
    """Of the joint, before a step.

    Attributes:
        time: [s]
        step: Length of the step [s].
        position: [rad]
        velocity: Of the joint that bears the friction [rad/s].
        load: What the motor carries [N·m].
        command: Torque that the loop asks for [N·m].
        temperature: Of the joint, over that of its surroundings [K].
    """

    time: float
    step: float
    position: float
    velocity: float
    load: float
    command: float
    temperature: float


class Acting(NamedTuple):
    """What acts during a step.

    Attributes:
        level: `dof_frictionloss` [N·m].
        viscous: `dof_damping` [N·m·s/rad].
        torque: `qfrc_applied` [N·m].
        gain: `actuator_gainprm` of the motor [1].
    """

    level: float
    viscous: float = VISCOUS
    torque: float = 0.0
    gain: float = 1.0


Law = Callable[[State], Acting]


def _falling(velocity: float) -> float:
    """How much of the static friction's excess is left [1]."""
    return exp(-((velocity / STRIBECK) ** 2))


def dry_level(velocity: float) -> float:
    """Friction level [N·m]."""
    return COULOMB + (STATIC - COULOMB) * _falling(velocity)


def ordinary(state: State) -> Acting:
    """A Stribeck curve."""
    return Acting(dry_level(state.velocity))


def level(state: State) -> Acting:
    """Dry friction of one level, without a Stribeck curve: on a light body that one would make it stutter."""
    return Acting(COULOMB)


def by_load(coulomb: float = 0.0, stribeck: float = 0.0, quadratic: float = 0.0) -> Law:
    """Friction grows with the load: [1], [1] in slow motion, [1/(N·m)]."""

    def law(s: State) -> Acting:
        extra = (coulomb + stribeck * _falling(s.velocity)) * abs(s.load) + quadratic * s.load**2
        return Acting(dry_level(s.velocity) + extra)

    return law


def waving_level(amplitude: float, order: float, phase: float) -> Law:
    """Friction waves with the angle: A cos(n q + phi) [N·m]."""
    return lambda s: Acting(dry_level(s.velocity) + amplitude * cos(order * s.position + phase))


def uneven(share: float) -> Law:
    """Dry friction is this share larger forwards, and smaller backwards."""
    return lambda s: Acting(dry_level(s.velocity) * (1.0 + copysign(share, s.velocity)))


def other_shape(exponent: float) -> Law:
    """The Stribeck curve falls with another exponent than two."""
    return lambda s: Acting(COULOMB + (STATIC - COULOMB) * exp(-(abs(s.velocity / STRIBECK) ** exponent)))


def power_law(coefficient: float, exponent: float) -> Law:
    """In place of damping c |v|^n; below 1 mrad/s in proportion to the speed."""
    return lambda s: Acting(dry_level(s.velocity), coefficient * max(abs(s.velocity), _REST) ** (exponent - 1.0))


def thinning(per_kelvin: float) -> Law:
    """Damping falls with the temperature."""
    return lambda s: Acting(dry_level(s.velocity), VISCOUS * exp(-per_kelvin * s.temperature))


def constant(torque: float) -> Law:
    """A constant torque [N·m]."""
    return lambda s: Acting(dry_level(s.velocity), torque=torque)


def ripple(amplitude: float, order: float, phase: float) -> Law:
    """A torque A sin(n q + phi) against the motion's positive direction [N·m]."""
    return lambda s: Acting(dry_level(s.velocity), torque=-amplitude * sin(order * s.position + phase))


def rippling_motor(share: float, order: float, phase: float) -> Law:
    """The motor gives more of its command at some angles than at others: by a share A of sin(n q + phi) [1]."""
    return lambda s: Acting(dry_level(s.velocity), gain=1.0 + share * sin(order * s.position + phase))


def pushes(windows: Sequence[tuple[float, float, float]]) -> Law:
    """Start [s], end [s] and torque [N·m] of pushes from outside."""
    return lambda s: Acting(dry_level(s.velocity), torque=sum(t for a, b, t in windows if a <= s.time < b))


def sagging(per_power: float) -> Law:
    """The motor is weaker by this share for each watt that it gives [1/W]."""
    return lambda s: Acting(dry_level(s.velocity), gain=1.0 - per_power * abs(s.command * s.velocity))


def eddy_brake(strongest: float, velocity: float) -> Law:
    """A torque against the motion with its maximum at a velocity [rad/s]."""

    def law(s: State) -> Acting:
        ratio = s.velocity / velocity
        return Acting(dry_level(s.velocity), torque=-2.0 * strongest * ratio / (1.0 + ratio**2))

    return law


def starvation(share: float, time: float) -> Law:
    """Dry friction is this share larger at the start, and runs in [s]."""
    return lambda s: Acting(dry_level(s.velocity) * (1.0 + share * exp(-s.time / time)))


class LateFriction:
    """The friction level follows the velocity through a low pass [s]."""

    def __init__(self, lag: float) -> None:
        self._lag, self._velocity = lag, 0.0

    def __call__(self, s: State) -> Acting:
        self._velocity += (s.velocity - self._velocity) * s.step / self._lag
        return Acting(dry_level(self._velocity))


class Dwell:
    """Friction has grown by up to `rise` [N·m] after rests of some `time` [s]; a `travel` [rad] takes it away."""

    def __init__(self, rise: float, time: float, travel: float) -> None:
        self._rise, self._time, self._travel, self._grown = rise, time, travel, 0.0

    def __call__(self, s: State) -> Acting:
        if abs(s.velocity) < _REST:
            self._grown += (1.0 - self._grown) * s.step / self._time
        else:
            self._grown *= exp(-abs(s.velocity) * s.step / self._travel)
        return Acting(dry_level(s.velocity) + self._rise * self._grown)


class HeatedMotor:
    """The motor loses `loss` of its torque for each (N·m)² of the mean square torque of the last `time` [s]."""

    def __init__(self, loss: float, time: float) -> None:
        self._loss, self._time, self._heat = loss, time, 0.0

    def __call__(self, s: State) -> Acting:
        self._heat += (s.command**2 - self._heat) * s.step / self._time
        return Acting(dry_level(s.velocity), gain=1.0 - self._loss * self._heat)


class MemorySpring:
    """A spring [N·m/rad] whose centre follows the joint within some `time` [s], as a stiff cable's does."""

    def __init__(self, stiffness: float, time: float) -> None:
        self._stiffness, self._time, self._centre = stiffness, time, 0.0

    def __call__(self, s: State) -> Acting:
        self._centre += (s.position - self._centre) * s.step / self._time
        return Acting(dry_level(s.velocity), torque=-self._stiffness * (s.position - self._centre))

"""Laws in other forms than the catalogue of the diagnosis has them."""

from collections import deque
from math import exp, log1p

from .joint import VISCOUS
from .law import Acting, Law, State, dry_level

_REST = 1e-3  # [rad/s] below which a joint rests


def driving_alone(coefficient: float) -> Law:
    """Friction grows with the load [1] only where the motor lifts it."""
    return lambda s: Acting(dry_level(s.velocity) + coefficient * abs(s.load) * (s.load * s.velocity > 0.0))


def dead_band(width: float) -> Law:
    """The drive gives nothing of the innermost torque [N·m] to either side, and that much less of any other."""
    return lambda s: Acting(dry_level(s.velocity), torque=-min(max(s.command, -width), width))


class LimitedRate:
    """The torque follows the command by at most `rate` [N·m/s]."""

    def __init__(self, rate: float) -> None:
        self._rate, self._given = rate, 0.0

    def __call__(self, s: State) -> Acting:
        most = self._rate * s.step
        self._given += min(max(s.command - self._given, -most), most)
        return Acting(dry_level(s.velocity), torque=self._given - s.command)


class LogarithmicDwell:
    """Friction grows by `rise` ln(1 + t / `time`) [N·m] within a rest of t; a `travel` [rad] takes it away."""

    def __init__(self, rise: float, time: float, travel: float) -> None:
        self._rise, self._time, self._travel = rise, time, travel
        self._rested, self._left = 0.0, 1.0

    def __call__(self, s: State) -> Acting:
        if abs(s.velocity) < _REST:
            self._rested, self._left = self._rested + s.step, 1.0
        else:
            self._left *= exp(-abs(s.velocity) * s.step / self._travel)
            self._rested *= self._left > 0.01
        return Acting(dry_level(s.velocity) + self._rise * self._left * log1p(self._rested / self._time))


class PowerDwell:
    """Friction grows by `rise` (t / 1 s)^`exponent` [N·m] within a rest of t; it is lost within a `time` of sliding."""

    def __init__(self, rise: float, exponent: float, time: float) -> None:
        self._rise, self._exponent, self._time = rise, exponent, time
        self._rested, self._left = 0.0, 1.0

    def __call__(self, s: State) -> Acting:
        if abs(s.velocity) < _REST:
            self._rested, self._left = self._rested + s.step, 1.0
        else:
            self._left *= exp(-s.step / self._time)
            self._rested *= self._left > 0.01
        return Acting(dry_level(s.velocity) + self._rise * self._left * self._rested**self._exponent)


class TwiceLateFriction:
    """The friction level follows the velocity through two low passes [s], one after the other."""

    def __init__(self, lag: float) -> None:
        self._lag, self._between, self._velocity = lag, 0.0, 0.0

    def __call__(self, s: State) -> Acting:
        share = s.step / self._lag
        self._between += (s.velocity - self._between) * share
        self._velocity += (self._between - self._velocity) * share
        return Acting(dry_level(self._velocity))


class DelayedFriction:
    """The friction level is that of the velocity some steps ago."""

    def __init__(self, steps: int) -> None:
        self._past: deque[float] = deque([0.0] * steps, maxlen=steps)

    def __call__(self, s: State) -> Acting:
        velocity = self._past[0]
        self._past.append(s.velocity)
        return Acting(dry_level(velocity), VISCOUS)


class TwiceHeatedMotor:
    """The motor loses `losses` of its torque for each (N·m)² of its mean square over two `times` [s]: winding, case."""

    def __init__(self, losses: tuple[float, float], times: tuple[float, float]) -> None:
        self._losses, self._times, self._heats = losses, times, [0.0, 0.0]

    def __call__(self, s: State) -> Acting:
        for k, time in enumerate(self._times):
            self._heats[k] += (s.command**2 - self._heats[k]) * s.step / time
        lost = sum(loss * heat for loss, heat in zip(self._losses, self._heats, strict=True))
        return Acting(dry_level(s.velocity), gain=1.0 - lost)

"""Velocity over time of one motion: up a ramp, along a plateau, down again."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Trapezoid:
    """A motion from rest to rest.

    Attributes:
        velocity: On the plateau, signed [rad/s] or [m/s].
        ramp: Time up, and time down again [s].
        hold: Time on the plateau [s].
    """

    velocity: float
    ramp: float
    hold: float

    @property
    def duration(self) -> float:
        """Time from rest to rest [s]."""
        return 2.0 * self.ramp + self.hold

    @property
    def distance(self) -> float:
        """Signed distance from rest to rest [rad] or [m]."""
        return self.velocity * (self.ramp + self.hold)

    def velocity_at(self, time: float) -> float:
        """Velocity at `time` [s] after the start [rad/s] or [m/s]."""
        if self.ramp <= 0.0:
            return self.velocity if 0.0 <= time < self.hold else 0.0
        rising, falling = time / self.ramp, (self.duration - time) / self.ramp
        return self.velocity * max(0.0, min(1.0, rising, falling))


def move_profile(distance: float, speed: float, ramp: float) -> Trapezoid:
    """A motion over `distance` [rad] or [m] at `speed` at most, slower where the way is short."""
    size = abs(distance)
    sign = 1.0 if distance >= 0.0 else -1.0
    if size <= speed * ramp:
        return Trapezoid(sign * size / ramp, ramp, 0.0)
    return Trapezoid(sign * speed, ramp, size / speed - ramp)

"""The simulated drive of one joint: torque, velocity or position command, closed on its own encoder every period."""

from dataclasses import dataclass
from math import exp, inf, sqrt
from typing import Literal

from fricomp.errors import ParameterError
from fricomp.joint import CommandMode

ServoMode = CommandMode | Literal["impedance"]
"""`impedance`: torque from a position and a velocity error with gains that come with every command."""


@dataclass(frozen=True)
class ServoSettings:
    """A drive's own loop: position K_p = J w^2 and damping K_d = 2 J w about the joint's inertia J, double pole at w.

    Attributes:
        torque_limit: Largest torque on the joint [N·m] or [N].
        velocity_limit: Largest velocity reference [rad/s] or [m/s]; on the way to a position nine tenths of it.
        acceleration_limit: Ramp of the references [rad/s²] or [m/s²]; a smooth command within it passes unchanged.
        bandwidth: w [rad/s]. On the falling branch of a Stribeck curve the joint sticks and slips unless K_d
            exceeds 0.86 (F_s - F_c)/v_s: the default joint needs 8.6 of its 20 N·m·s/rad.
        observer_bandwidth: Double pole of the observer that estimates velocity from encoder counts [rad/s].
        watchdog: Time without a command after which the torque falls to zero [s]; 0 for none.

    Raises:
        ParameterError: A value is not positive.
    """

    torque_limit: float = 5.0
    velocity_limit: float = 10.0
    acceleration_limit: float = 20.0
    bandwidth: float = 100.0
    observer_bandwidth: float = 500.0
    watchdog: float = 0.1

    def __post_init__(self) -> None:
        for name in ("torque_limit", "velocity_limit", "acceleration_limit", "bandwidth", "observer_bandwidth"):
            if not getattr(self, name) > 0.0:
                raise ParameterError(f"{name} must be positive, got {getattr(self, name)!r}")
        if not self.watchdog >= 0.0:
            raise ParameterError(f"watchdog must not be negative, got {self.watchdog!r}")


class Servo:
    """Off until enabled; once a period it takes an encoder reading and gives the torque.

    Args:
        settings: Limits and loop.
        inertia: J about the joint that the gains are made for [kg·m²] or [kg].
        period: [s].
    """

    def __init__(self, settings: ServoSettings, inertia: float, period: float) -> None:
        self.settings = settings
        self.stiffness = inertia * settings.bandwidth**2
        self.damping = 2.0 * inertia * settings.bandwidth
        self._period = period
        self._lead = settings.torque_limit / self.stiffness
        remainder = 1.0 - exp(-settings.observer_bandwidth * period)
        self._correct, self._learn = 1.0 - (1.0 - remainder) ** 2, remainder**2 / period
        self.reset(0.0)

    def reset(self, position: float) -> None:
        """Disabled at rest at `position` [rad] or [m]."""
        self.enabled = self.expired = False
        self.mode: ServoMode = "torque"
        self.estimated_position, self.estimated_velocity = position, 0.0
        self._silence = 0.0
        self._gains = 0.0, 0.0
        self.ceiling = inf
        """Torque limit commanded on top of the drive's own [N·m]."""
        self.command(0.0)

    def enable(self, mode: ServoMode) -> None:
        """Energise, holding still: zero torque, zero velocity or the present position, zero gains."""
        self.mode = mode
        self.ceiling = inf
        self._gains = 0.0, 0.0
        self.command(0.0, position=self.estimated_position)
        self._reference, self._speed = self.estimated_position, 0.0
        self.enabled = True

    def disable(self) -> None:
        """Take the torque away."""
        self.enabled = False

    def clear(self) -> None:
        """Forget that the watchdog expired."""
        self.expired = False

    def command(self, torque: float, velocity: float = 0.0, position: float = 0.0) -> None:
        """Take a command: torque or its feed-forward [N·m], and the reference of the mode in use."""
        limit = self.settings.velocity_limit
        self._torque, self._position = torque, position
        self._velocity = max(-limit, min(limit, velocity))
        self._silence = 0.0

    def command_gains(self, stiffness: float, damping: float) -> None:
        """Gains of the impedance mode: on the position error [N·m/rad] and on the velocity error [N·m·s/rad]."""
        self._gains = stiffness, damping

    def update(self, encoded: float) -> float:
        """Torque over the coming period [N·m] from the encoder's position now [rad] or [m]."""
        error = encoded - self.estimated_position
        self.estimated_velocity += self._learn * error
        position = self.estimated_position + self._correct * error
        velocity = self.estimated_velocity
        self.estimated_position = position + self._period * velocity
        if not self.enabled:
            return 0.0
        self._silence += self._period
        if 0.0 < self.settings.watchdog < self._silence:
            self.enabled, self.expired = False, True
            return 0.0
        torque = self._torque
        if self.mode == "impedance":
            torque += self._gains[0] * (self._position - position) + self._gains[1] * (self._velocity - velocity)
        elif self.mode != "torque":
            torque += self._loop(position, velocity)
        limit = min(self.settings.torque_limit, self.ceiling)
        return limit if torque > limit else -limit if torque < -limit else torque

    def _loop(self, position: float, velocity: float) -> float:
        """Torque of the drive's own loop; its reference never runs further ahead than full torque."""
        wanted = self._velocity if self.mode == "velocity" else self._approach(self._position - self._reference)
        step = self.settings.acceleration_limit * self._period
        self._speed = max(self._speed - step, min(self._speed + step, wanted))
        target = self._reference + self._speed * self._period
        self._reference = max(position - self._lead, min(position + self._lead, target))
        return self.stiffness * (self._reference - position) + self.damping * (self._speed - velocity)

    def _approach(self, distance: float) -> float:
        """Velocity towards a position `distance` away, from which the ramp still stops in time."""
        fastest = min(
            abs(distance) / self._period,
            sqrt(2.0 * self.settings.acceleration_limit * abs(distance)),
            0.9 * self.settings.velocity_limit,
        )
        return fastest if distance > 0.0 else -fastest

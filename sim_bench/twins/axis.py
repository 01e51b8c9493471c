"""One joint of a stand-in as the electronics of a drive see it: motor side, any protocol."""

from dataclasses import replace

from fricomp.errors import ParameterError

from ..stand_in import StandIn, StandInSettings
from ..stand_in.servo import ServoMode


class DriveAxis:
    """Motor, encoder and current loop of a drive.

    Args:
        stand_in: The joints, made by `twin_stand_in`.
        joint: Which of them.
        gear_ratio: Motor turns for one joint turn [1].
    """

    def __init__(self, stand_in: StandIn, joint: int = 0, gear_ratio: float = 1.0) -> None:
        if not gear_ratio > 0.0:
            raise ParameterError(f"gear_ratio must be positive, got {gear_ratio!r}")
        self._stand_in, self._joint, self.gear_ratio = stand_in, joint, gear_ratio
        self._sensor, self._servo = stand_in.sensors[joint], stand_in.servos[joint]
        self._zero = 0.0

    @property
    def position(self) -> float:
        """Reported motor position [rad]."""
        return self._sensor.newest.position * self.gear_ratio - self._zero

    @property
    def velocity(self) -> float:
        """Reported motor velocity [rad/s]."""
        return self._sensor.newest.velocity * self.gear_ratio

    @property
    def torque(self) -> float:
        """Motor torque as the drive estimates it [N·m]."""
        return self._sensor.newest.torque / self.gear_ratio

    @property
    def applied_torque(self) -> float:
        """True motor torque over the last period [N·m]."""
        return self._stand_in.torque[self._joint] / self.gear_ratio

    @property
    def torque_limit(self) -> float:
        """Largest motor torque [N·m]."""
        return self._servo.settings.torque_limit / self.gear_ratio

    @property
    def velocity_limit(self) -> float:
        """Largest motor velocity [rad/s]."""
        return self._servo.settings.velocity_limit * self.gear_ratio

    @property
    def temperature(self) -> float:
        """[°C]."""
        return self._stand_in.plant.temperature[self._joint]

    @property
    def energised(self) -> bool:
        """Whether the motor may carry current."""
        return self._servo.enabled

    @property
    def loop_gains(self) -> tuple[float, float]:
        """Stiffness [N·m/rad] and damping [N·m·s/rad] that suit the joint, in motor units."""
        square = self.gear_ratio**2
        return self._servo.stiffness / square, self._servo.damping / square

    def set_zero(self) -> None:
        """Let the present position read zero."""
        self._zero = self._sensor.newest.position * self.gear_ratio

    def enable(self, mode: ServoMode) -> None:
        """Energise, holding still."""
        self._servo.enable(mode)

    def disable(self) -> None:
        """Take the current away."""
        self._servo.disable()

    def command(self, torque: float, velocity: float = 0.0, position: float = 0.0) -> None:
        """Command in motor units: torque or its feed-forward [N·m], velocity [rad/s], position [rad]."""
        ratio = self.gear_ratio
        self._servo.command(torque * ratio, velocity / ratio, (position + self._zero) / ratio)

    def limit_torque(self, most: float) -> None:
        """Bound the motor torque below the drive's own limit [N·m]; it stays until changed."""
        self._servo.ceiling = most * self.gear_ratio

    def command_gains(self, stiffness: float, damping: float) -> None:
        """Gains of the impedance mode in motor units [N·m/rad], [N·m·s/rad]."""
        self._servo.command_gains(stiffness * self.gear_ratio**2, damping * self.gear_ratio**2)


def twin_stand_in(settings: StandInSettings) -> StandIn:
    """A stand-in whose drives leave the watchdog to the protocol in front of them."""
    joints = tuple(replace(joint, servo=replace(joint.servo, watchdog=0.0)) for joint in settings.joints)
    return StandIn(replace(settings, joints=joints))

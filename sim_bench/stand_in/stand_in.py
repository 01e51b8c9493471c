"""The stand-in: joints with known friction behind drives and sensors, stepped in virtual time."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from fricomp.errors import ParameterError
from fricomp.joint import CommandMode
from fricomp.laws import FrictionLaw

from .disturbance import Disturbance
from .plant import NormalLoad, Plant, ThermalSettings
from .sensor import Reading, SensorChain, SensorSettings
from .servo import Servo, ServoSettings

__all__ = ["JointSettings", "StandIn", "StandInSettings"]

# Virtual time starts here: a time of zero means "no feedback yet" to the safety gate.
START_NS = 1_000_000_000


@dataclass(frozen=True)
class JointSettings:
    """One joint of the stand-in.

    Attributes:
        name: Its name in the MJCF file.
        law: The friction it has; a calibration is to find this out.
        sensor: How it is measured.
        servo: How it is driven.
        normal_load: Normal load on its friction: a constant, `"transmitted"` for the size of the torque it
            transmits, or None for the law's reference load.
        thermal: How it warms up.
        disturbance: External torque on it.
        position: Where it starts [rad] or [m].
    """

    name: str
    law: FrictionLaw
    sensor: SensorSettings = field(default_factory=SensorSettings)
    servo: ServoSettings = field(default_factory=ServoSettings)
    normal_load: NormalLoad = None
    thermal: ThermalSettings = field(default_factory=ThermalSettings)
    disturbance: Disturbance = field(default_factory=Disturbance)
    position: float = 0.0


@dataclass(frozen=True)
class StandInSettings:
    """All that defines a stand-in; two built from equal settings behave equally.

    Attributes:
        mjcf: Model file of the bodies.
        joints: The driven joints.
        period: Servo and sensor period, and step of the simulation [s].
        seed: Of the sensors' noise.
    """

    mjcf: Path
    joints: tuple[JointSettings, ...]
    period: float = 1e-3
    seed: int = 0

    def __post_init__(self) -> None:
        if not self.joints:
            raise ParameterError("a stand-in needs at least one joint")
        if not 1e-6 <= self.period <= 0.1:
            raise ParameterError(f"period must be between 1e-6 and 0.1 s, got {self.period!r}")


class StandIn:
    """Joints that behave like hardware: a drive and a sensor chain each, over one MuJoCo plant.

    Args:
        settings: Bodies, friction, drives, sensors.

    Raises:
        ParameterError: The settings do not fit the model file.
    """

    def __init__(self, settings: StandInSettings) -> None:
        self.settings, joints = settings, settings.joints
        self.plant = Plant(
            settings.mjcf,
            [joint.name for joint in joints],
            [joint.law for joint in joints],
            period=settings.period,
            normal_load=[joint.normal_load for joint in joints],
            thermal=[joint.thermal for joint in joints],
        )
        seeds = np.random.SeedSequence(settings.seed).spawn(len(joints))
        self.sensors = [SensorChain(j.sensor, settings.period, s) for j, s in zip(joints, seeds, strict=True)]
        self.servos = [
            Servo(j.servo, inertia, settings.period) for j, inertia in zip(joints, self.plant.inertias, strict=True)
        ]
        self.period_ns = round(settings.period * 1e9)
        self._disturbances = [joint.disturbance for joint in joints]
        self._disturbed = any(d.sinusoids for d in self._disturbances)
        self.reset()

    def reset(self) -> None:
        """Back to the start: position, temperature, noise and time."""
        self.time_ns = START_NS
        self.torque = [0.0] * len(self.servos)
        """True torque of each drive on its joint over the last period [N·m]."""
        positions = [joint.position for joint in self.settings.joints]
        self.plant.reset(positions)
        for sensor, servo, position in zip(self.sensors, self.servos, positions, strict=True):
            sensor.reset(self.time_ns, position, 0.0)
            servo.reset(sensor.encoded)

    def step(self) -> None:
        """Advance by one period: drives, bodies, sensors."""
        plant, torque, outside = self.plant, self.torque, None
        for joint, servo in enumerate(self.servos):
            torque[joint] = servo.update(self.sensors[joint].encoded)
        if self._disturbed:
            outside = [d.torque(plant.time) for d in self._disturbances]
        plant.step(torque, outside)
        self.time_ns += self.period_ns
        for joint, sensor in enumerate(self.sensors):
            sensor.sample(self.time_ns, plant.position(joint), plant.velocity(joint), torque[joint])

    def readings(self) -> list[Reading]:
        """The newest reading of each joint."""
        return [sensor.newest for sensor in self.sensors]

    def enable(self, mode: CommandMode) -> None:
        """Energise every drive, holding still."""
        for servo in self.servos:
            servo.enable(mode)

    def disable(self) -> None:
        """Take the torque off every drive."""
        for servo in self.servos:
            servo.disable()

    def command(self, torque: Sequence[float], velocity: Sequence[float], position: Sequence[float]) -> None:
        """Give every drive its command; see `Servo.command`."""
        for joint, servo in enumerate(self.servos):
            servo.command(torque[joint], velocity[joint], position[joint])

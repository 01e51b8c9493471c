"""The stand-in as a backend like any other: `--backend sim`."""

from collections.abc import Mapping, Sequence
from typing import Any, Self

from fricomp.adapters import AdapterOptions, JointAdapter
from fricomp.control import JointLimits
from fricomp.errors import AdapterConfigurationError, DriveFault, ParameterError
from fricomp.joint import Capabilities, CommandMode, JointCapabilities, JointCommand, JointFeedback, Watchdog

from .clock import LockStepClock
from .configuration import read_configuration
from .packaged import default_joint
from .stand_in import JointSettings, StandIn, StandInSettings

__all__ = ["SimulatedJointAdapter", "default_limits"]

# Default limits, from the drive: full torque within 20 ms, the gate's range this far inside the end stops [rad].
TORQUE_RISE_TIME = 0.02
END_STOP_MARGIN = 0.05


class SimulatedJointAdapter(JointAdapter):
    """A simulated joint; no hardware.

    A stand-in behind the adapter interface, in lock step: its clock's `sleep_until` runs the simulation.

    Args:
        settings: The joints; None for the default joint.
        options: Limits and the rest; None for `default_limits`.
    """

    def __init__(self, settings: StandInSettings | None = None, options: AdapterOptions | None = None) -> None:
        self.stand_in = StandIn(settings or default_joint())
        super().__init__(options or AdapterOptions(default_limits(self.stand_in)), LockStepClock(self.stand_in))
        self._seen_ns = -1

    @classmethod
    def from_configuration(cls, configuration: Mapping[str, Any]) -> Self:
        """Make the adapter from a configuration table; `configuration.StandInTable` lists its keys."""
        try:
            settings, limits = read_configuration(configuration)
            return cls(settings, None if limits is None else AdapterOptions(limits))
        except ParameterError as error:
            raise AdapterConfigurationError(str(error)) from error

    def _open(self) -> Capabilities:
        settings, plant = self.stand_in.settings, self.stand_in.plant
        kinds = zip(settings.joints, plant.position_limits, plant.linear, strict=True)
        joints = tuple(_capabilities(j, r, settings.period, linear=linear) for j, r, linear in kinds)
        longest = max(joint.servo.watchdog for joint in settings.joints)
        guarded = all(joint.servo.watchdog > 0.0 for joint in settings.joints)
        return Capabilities(
            joints=joints,
            modes=("torque", "velocity", "position"),
            highest_rate=1.0 / settings.period,
            watchdog=Watchdog(longest, confirmed=True) if guarded else None,
            simulated=True,
        )

    def _find_energised(self) -> Sequence[bool | None]:
        return [servo.enabled for servo in self.stand_in.servos]

    def _joint_names(self) -> Sequence[str]:
        return [joint.name for joint in self.stand_in.settings.joints]

    def _configure(self, mode: CommandMode, period: float) -> None:
        servo_period = self.stand_in.settings.period
        if abs(round(period / servo_period) * servo_period - period) > 1e-9:
            raise AdapterConfigurationError(
                f"a period of {period} s is not a multiple of the simulated drive's {servo_period} s"
            )
        self._requested_mode = mode

    def _enable(self) -> None:
        if any(servo.expired for servo in self.stand_in.servos):
            raise DriveFault("the drive's watchdog has expired: clear_faults() first")
        self.stand_in.enable(self._requested_mode)

    def _write(self, command: JointCommand, mode: CommandMode) -> None:
        self.stand_in.command(command.torque, command.velocity, command.position)

    def _read_into(self, feedback: JointFeedback) -> bool:
        stand_in = self.stand_in
        for joint, sensor in enumerate(stand_in.sensors):
            reading = sensor.newest
            feedback.position[joint] = reading.position
            feedback.velocity[joint] = reading.velocity
            feedback.torque[joint] = reading.torque
            feedback.temperature[joint] = stand_in.plant.temperature[joint]
            feedback.fault[joint] = int(stand_in.servos[joint].expired)
            feedback.time_ns = reading.time_ns
        fresh = feedback.time_ns > self._seen_ns
        self._seen_ns = feedback.time_ns
        return fresh

    def _describe_fault(self, joint: int, code: int) -> str:
        return "its watchdog has fired, because it heard nothing"

    def _stop(self) -> None:
        self.stand_in.disable()

    def _clear_faults(self) -> None:
        for servo in self.stand_in.servos:
            servo.clear()

    def _close(self) -> None:
        self.stand_in.disable()


def default_limits(stand_in: StandIn) -> tuple[JointLimits, ...]:
    """Limits of the simulated drives and end stops, for when a configuration gives none."""
    limits = []
    for joint, stops in zip(stand_in.settings.joints, stand_in.plant.position_limits, strict=True):
        position = (stops[0] + END_STOP_MARGIN, stops[1] - END_STOP_MARGIN) if stops is not None else None
        torque = joint.servo.torque_limit
        limits.append(JointLimits(torque, torque / TORQUE_RISE_TIME, joint.servo.velocity_limit, position))
    return tuple(limits)


def _capabilities(
    joint: JointSettings, stops: tuple[float, float] | None, period: float, *, linear: bool
) -> JointCapabilities:
    return JointCapabilities(
        name=joint.name,
        motion="linear" if linear else "rotary",
        torque_unit="N" if linear else "N·m",
        torque_kind="measured",
        position_quantum=joint.sensor.position_quantum,
        velocity_quantum=joint.sensor.velocity_quantum(period),
        torque_limit=joint.servo.torque_limit,
        velocity_limit=joint.servo.velocity_limit,
        position_limits=stops,
    )

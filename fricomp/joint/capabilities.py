"""What an adapter declares about its joints and its bus, joint side."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from fricomp.model import Motion

CommandMode = Literal["torque", "velocity", "position"]
TorqueKind = Literal["measured", "estimated", "commanded"]


@dataclass(frozen=True)
class JointCapabilities:
    """One joint as its drive declares it, joint side.

    Attributes:
        name: Name of the joint.
        motion: `rotary` (rad) or `linear` (m).
        torque_unit: Unit of torque in command and feedback: `N·m`, `N`, or the actuator's own, such as `A`.
        torque_kind: Whether the reported torque is measured, estimated from current, or the command itself.
        position_quantum: Step of the reported position [rad] or [m]; 0 where it is continuous.
        velocity_quantum: Step of the reported velocity [rad/s] or [m/s].
        velocity_command_quantum: Step of the velocity that can be commanded [rad/s] or [m/s].
        torque_quantum: Step of the commanded torque, in `torque_unit`.
        torque_limit: Largest torque the drive accepts, in `torque_unit`.
        velocity_limit: Largest velocity [rad/s] or [m/s].
        position_limits: Lowest and highest position [rad] or [m]; None where the joint turns freely.
        reports_temperature: Whether its drive tells the temperature, so that a limit on it can be watched.
    """

    name: str
    motion: Motion = "rotary"
    torque_unit: str = "N·m"
    torque_kind: TorqueKind = "estimated"
    position_quantum: float = 0.0
    velocity_quantum: float = 0.0
    velocity_command_quantum: float = 0.0
    torque_quantum: float = 0.0
    torque_limit: float = float("inf")
    velocity_limit: float = float("inf")
    position_limits: tuple[float, float] | None = None
    reports_temperature: bool = True


@dataclass(frozen=True)
class Watchdog:
    """What stops the drive when the bus falls silent.

    Attributes:
        timeout: Time to zero torque after the last frame [s].
        confirmed: Whether the setting was read back from the drive.
        fed_by_reads: Whether mere reads keep the drive energised, so that a dead control loop may go unnoticed.
    """

    timeout: float
    confirmed: bool
    fed_by_reads: bool = False


@dataclass(frozen=True)
class Capabilities:
    """What an adapter offers.

    Attributes:
        joints: In the order of every command and feedback.
        modes: Command modes that the drives support.
        highest_rate: Highest rate that bus and drives carry for these joints, in the mode that needs least [Hz].
        feed_forward: Whether velocity and position mode take a torque besides the reference.
        mode_rates: Highest rate of each mode where they differ [Hz]; see `rate_in`.
        watchdog: None where the drive has none.
        simulated: Whether no hardware can move.
    """

    joints: tuple[JointCapabilities, ...]
    modes: tuple[CommandMode, ...]
    highest_rate: float
    watchdog: Watchdog | None
    simulated: bool = False
    feed_forward: bool = True
    mode_rates: Mapping[CommandMode, float] = field(default_factory=dict)

    def rate_in(self, mode: CommandMode) -> float:
        """Highest rate in a mode [Hz]."""
        return self.mode_rates.get(mode, self.highest_rate)

"""What a motion of calibration works with: the open adapter, the joint, and who closes its loop."""

from collections.abc import Sequence
from dataclasses import dataclass

from fricomp.adapters import JointAdapter, recording_metadata
from fricomp.errors import AdapterConfigurationError, ParameterError
from fricomp.joint import CommandMode
from fricomp.recording import RecordingMetadata

from ..planning.plan import Travel, travel_of
from ..planning.settings import SweepSettings
from ..rigid_body import RigidBody
from ..watch import SweepWatch
from .velocity_loop import DriveLoop, HostLoop, LimpLoop, VelocityLoop

__all__ = ["HOST_RATE", "SweepContext", "loop_period"]

# Cycles a second of the loop by who closes it [Hz].
DRIVE_RATE, HOST_RATE = 500.0, 1000.0


def loop_period(adapter: JointAdapter, settings: SweepSettings, mode: CommandMode) -> float:
    """Period of the loop [s]: as asked for, else what suits the mode, never faster than the bus."""
    wanted = settings.rate or (HOST_RATE if mode == "torque" else DRIVE_RATE)
    return 1.0 / min(wanted, adapter.capabilities.rate_in(mode))


@dataclass(frozen=True)
class SweepContext:
    """What a sweep works with.

    Attributes:
        adapter: Open.
        joint: Index of the joint.
        settings: As chosen.
        body: Rigid-body model of the arm; None where gravity and inertia are unknown.
        watch: Is shown what the sweep records; None where nobody watches.
    """

    adapter: JointAdapter
    joint: int
    settings: SweepSettings
    body: RigidBody | None = None
    watch: SweepWatch | None = None

    def choose_mode(self) -> CommandMode:
        """The command mode of the velocity loop.

        Raises:
            AdapterConfigurationError: The drive cannot do what was asked for.
        """
        offered, wanted = self.adapter.capabilities.modes, self.settings.loop
        if wanted != "host":
            own: tuple[CommandMode, ...] = ("velocity", "position")
            for mode in own:
                if mode in offered:
                    return mode
        if wanted != "drive" and "torque" in offered:
            return "torque"
        raise AdapterConfigurationError(f"loop {wanted!r} is not possible: the drive offers {', '.join(offered)}")

    def make_loop(self, mode: CommandMode, period: float, position: Sequence[float]) -> VelocityLoop:
        """The loop for a mode."""
        n_joints = len(self.adapter.capabilities.joints)
        if mode != "torque":
            return DriveLoop(n_joints, period, mode)
        inertias = [self.settings.inertia] * n_joints
        if self.body is not None and not self.settings.inertia:
            inertias = self.body.inertias(position)
        limits = [limit.torque for limit in self.adapter.options.limits]
        return HostLoop(inertias, self.settings.bandwidth, period, limits)

    def make_check_loop(self, period: float, position: Sequence[float]) -> VelocityLoop:
        """The loop of the sign check, which pushes with torque alone.

        Raises:
            ParameterError: Nothing is known that would hold the other joints of an arm.
        """
        if self.body is not None or self.settings.inertia:
            return self.make_loop("torque", period, position)
        joints = self.adapter.capabilities.joints
        if len(joints) > 1:
            raise ParameterError(
                f"the sign check would leave all {len(joints)} joints without torque, because nothing says their "
                "inertia: give a model or --inertia, or configure this joint alone"
            )
        return LimpLoop()

    def travel(self, at: float = 0.0) -> Travel:
        """Where the joint may move, of one that turns freely about the position `at` [rad] or [m]."""
        limits = self.adapter.options.limits[self.joint]
        return travel_of(self.adapter.capabilities.joints[self.joint], limits.position, limits.velocity, at)

    def metadata(self) -> RecordingMetadata:
        """Facts for the recording."""
        return recording_metadata(self.adapter, self.joint, "fricomp calibrate")

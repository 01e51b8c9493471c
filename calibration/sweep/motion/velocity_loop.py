"""Who makes the joint follow a velocity: the drive's own loop, or one closed here over commanded torque."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from math import exp

from fricomp.errors import ParameterError
from fricomp.joint import CommandMode, JointCommand, JointFeedback

__all__ = ["DriveLoop", "HostLoop", "LimpLoop", "VelocityLoop"]

# Double pole of the observer of the host's loop over the loop's own bandwidth.
OBSERVER_RATIO = 5.0


class VelocityLoop(ABC):
    """Fills in the command of every joint so that one follows a velocity and the others stay where they are."""

    mode: CommandMode

    @abstractmethod
    def start(self, feedback: JointFeedback) -> None:
        """Hold every joint where it is."""

    @abstractmethod
    def command(self, joint: int, velocity: float, feedback: JointFeedback, out: JointCommand) -> None:
        """Fill `out` for one period.

        Args:
            joint: The one that moves.
            velocity: Its reference [rad/s] or [m/s].
            feedback: The newest there is.
            out: Filled in.
        """


class DriveLoop(VelocityLoop):
    """The drive's own velocity loop, or its position loop fed with the integral.

    Args:
        n_joints: Number of joints.
        period: Of this loop [s].
        mode: `velocity` or `position`.
    """

    def __init__(self, n_joints: int, period: float, mode: CommandMode = "velocity") -> None:
        self.mode = mode
        self._period = period
        self._position = [0.0] * n_joints

    def start(self, feedback: JointFeedback) -> None:
        """Hold every joint where it is."""
        self._position[:] = feedback.position

    def command(self, joint: int, velocity: float, feedback: JointFeedback, out: JointCommand) -> None:
        """Fill in the reference of the mode in use."""
        out.torque[:] = [0.0] * len(self._position)  # else the push of the sign check would stay as feed-forward
        out.velocity[:] = [0.0] * len(self._position)
        out.velocity[joint] = velocity
        self._position[joint] += velocity * self._period
        out.position[:] = self._position


class HostLoop(VelocityLoop):
    """Stiffness J w^2 on the integrated reference and damping 2 J w on its rate, closed here over commanded torque.

    On the falling branch of a Stribeck curve a joint sticks and slips unless the damping exceeds about
    0.86 (F_s - F_c)/v_s. Velocity comes from an observer on the position, because the velocity that drives
    report is often coarse.

    Args:
        inertias: J about each joint [kg·m²] or [kg].
        bandwidth: w [rad/s].
        period: Of this loop [s].
        torque_limits: Of each joint; the reference never runs further ahead than full torque [N·m] or [N].

    Raises:
        ParameterError: An inertia is not positive.
    """

    mode: CommandMode = "torque"

    def __init__(
        self, inertias: Sequence[float], bandwidth: float, period: float, torque_limits: Sequence[float]
    ) -> None:
        if not all(inertia > 0.0 for inertia in inertias):
            raise ParameterError(
                "closing the velocity loop on the host needs the inertia about every joint: give a model or --inertia"
            )
        self.damping = [2.0 * inertia * bandwidth for inertia in inertias]
        self._stiffness = [inertia * bandwidth**2 for inertia in inertias]
        self._lead = [limit / k for limit, k in zip(torque_limits, self._stiffness, strict=True)]
        remainder = 1.0 - exp(-OBSERVER_RATIO * bandwidth * period)
        self._correct, self._learn = 1.0 - (1.0 - remainder) ** 2, remainder**2 / period
        self._period = period
        self._estimate = [0.0] * len(inertias)
        self._rate = [0.0] * len(inertias)
        self._reference = [0.0] * len(inertias)

    def start(self, feedback: JointFeedback) -> None:
        """Hold every joint where it is."""
        self._estimate[:] = feedback.position
        self._reference[:] = feedback.position
        self._rate[:] = [0.0] * len(self._rate)

    def command(self, joint: int, velocity: float, feedback: JointFeedback, out: JointCommand) -> None:
        """Fill in the torques."""
        for i, measured in enumerate(feedback.position):
            wanted = velocity if i == joint else 0.0
            error = measured - self._estimate[i]
            self._rate[i] += self._learn * error
            position, rate = self._estimate[i] + self._correct * error, self._rate[i]
            self._estimate[i] = position + self._period * rate
            ahead = self._reference[i] + wanted * self._period
            self._reference[i] = max(position - self._lead[i], min(position + self._lead[i], ahead))
            out.torque[i] = self._stiffness[i] * (self._reference[i] - position) + self.damping[i] * (wanted - rate)


class LimpLoop(VelocityLoop):
    """No torque on any joint: for a single joint, before its inertia is known."""

    mode: CommandMode = "torque"

    def start(self, feedback: JointFeedback) -> None:
        """Nothing is held."""

    def command(self, joint: int, velocity: float, feedback: JointFeedback, out: JointCommand) -> None:
        """Zero torque on all joints."""
        out.torque[:] = [0.0] * len(out.torque)

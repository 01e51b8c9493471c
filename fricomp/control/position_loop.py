"""References to follow and the plain position controller that follows them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback

__all__ = ["Controller", "PositionController", "Reference", "ReferenceState", "SineReference"]


class ReferenceState:
    """Reference of all joints at one time; made once, filled every cycle.

    Attributes:
        position: [rad] or [m].
        velocity: [rad/s] or [m/s].
        acceleration: [rad/s²] or [m/s²].
    """

    __slots__ = ("acceleration", "position", "velocity")

    def __init__(self, n_joints: int) -> None:
        self.position = [0.0] * n_joints
        self.velocity = [0.0] * n_joints
        self.acceleration = [0.0] * n_joints


class Reference(Protocol):
    """A motion over time."""

    def sample(self, time: float, state: ReferenceState) -> None:
        """Fill `state` with the reference at `time` since the start of the loop [s]."""


class Controller(Protocol):
    """The user's controller."""

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill `out` with the torque of each joint, without friction compensation.

        Args:
            out: In the adapter's torque unit, one entry a joint.
            feedback: What the joints report.
            reference: The reference at the time at which the feedback was taken.
        """


@dataclass(frozen=True)
class SineReference:
    """A sine on every joint that starts at rest: q = centre + amplitude (1 - cos(2 pi f t)).

    Attributes:
        amplitude: Of each joint [rad] or [m].
        frequency: f [Hz].
        centre: Position at the start [rad] or [m]; the motion covers twice the amplitude from there on.
        rest: Time at rest before it starts, while the enable ramp opens [s].

    Raises:
        ParameterError: The frequency is not positive or the lengths differ.
    """

    amplitude: Sequence[float]
    frequency: float
    centre: Sequence[float]
    rest: float = 0.0

    def __post_init__(self) -> None:
        if not self.frequency > 0.0 or len(self.amplitude) != len(self.centre):
            raise ParameterError(
                f"a sine needs a positive frequency and as many centres as amplitudes, got {self.frequency!r} Hz, "
                f"{len(self.amplitude)} amplitudes and {len(self.centre)} centres"
            )

    def sample(self, time: float, state: ReferenceState) -> None:
        """Fill in the sine at `time` [s]."""
        omega, time = 2.0 * math.pi * self.frequency, max(time - self.rest, 0.0)
        sine, cosine = math.sin(omega * time), math.cos(omega * time)
        for joint, (amplitude, centre) in enumerate(zip(self.amplitude, self.centre, strict=True)):
            state.position[joint] = centre + amplitude * (1.0 - cosine)
            state.velocity[joint] = amplitude * omega * sine
            state.acceleration[joint] = amplitude * omega * omega * cosine if time > 0.0 else 0.0


@dataclass(frozen=True)
class PositionController:
    """PD with inertia feed-forward: tau = K (q_r - q) + D (v_r - v) + J a_r.

    Attributes:
        stiffness: K of each joint [N·m/rad] or [N/m].
        damping: D of each joint [N·m·s/rad] or [N·s/m].
        inertia: J of each joint [kg·m²] or [kg].
    """

    stiffness: Sequence[float]
    damping: Sequence[float]
    inertia: Sequence[float]

    @classmethod
    def from_bandwidth(
        cls, inertia: Sequence[float], bandwidth: float, damping_ratio: float = 1.0
    ) -> PositionController:
        """Gains that give each joint a natural frequency of `bandwidth` [Hz] without friction.

        Raises:
            ParameterError: The bandwidth is not positive.
        """
        if not bandwidth > 0.0:
            raise ParameterError(f"the bandwidth must be positive [Hz], got {bandwidth!r}")
        omega = 2.0 * math.pi * bandwidth
        return cls([j * omega**2 for j in inertia], [2.0 * damping_ratio * j * omega for j in inertia], list(inertia))

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill in the torque of each joint."""
        q, v, goal = feedback.position, feedback.velocity, reference
        for joint, (stiffness, damping, inertia) in enumerate(
            zip(self.stiffness, self.damping, self.inertia, strict=True)
        ):
            out[joint] = (
                stiffness * (goal.position[joint] - q[joint])
                + damping * (goal.velocity[joint] - v[joint])
                + inertia * goal.acceleration[joint]
            )

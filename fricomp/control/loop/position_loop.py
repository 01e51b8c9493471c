"""References to follow and the plain position controller that follows them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback


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

    def forget(self) -> None:
        """Positions and velocities of NaN, on which a command never passes, and no acceleration."""
        unknown = [math.nan] * len(self.position)
        self.position[:] = self.velocity[:] = unknown
        self.acceleration[:] = [0.0] * len(unknown)


class Reference(Protocol):
    """A motion over time."""

    def sample(self, time: float, state: ReferenceState) -> None:
        """Fill `state` with the reference at `time` since the start of the loop [s].

        It comes forgotten: positions and velocities that are not filled in stay NaN.
        """


class Controller(Protocol):
    """The user's controller."""

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill `out` with the torque of each joint, without friction compensation.

        Args:
            out: In the adapter's torque unit, one entry a joint. It comes filled with NaN: a joint that is left out
                stops all.
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

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.centre)

    def sample(self, time: float, state: ReferenceState) -> None:
        """Fill in the sine at `time` [s]."""
        omega, time = 2.0 * math.pi * self.frequency, max(time - self.rest, 0.0)
        rise, slope = 1.0 - math.cos(omega * time), omega * math.sin(omega * time)
        bend = omega * omega * math.cos(omega * time) if time > 0.0 else 0.0
        position, velocity, acceleration = state.position, state.velocity, state.acceleration
        centre = self.centre
        for j, amplitude in enumerate(self.amplitude):
            position[j] = centre[j] + amplitude * rise
            velocity[j] = amplitude * slope
            acceleration[j] = amplitude * bend


@dataclass(frozen=True)
class PositionController:
    """PD with inertia feed-forward: tau = K (q_r - q) + D (v_r - v) + J a_r.

    Attributes:
        stiffness: K of each joint [N·m/rad] or [N/m].
        damping: D of each joint [N·m·s/rad] or [N·s/m].
        inertia: J of each joint [kg·m²] or [kg].

    Raises:
        ParameterError: The lengths differ, or a value is negative or not finite.
    """

    stiffness: Sequence[float]
    damping: Sequence[float]
    inertia: Sequence[float]

    def __post_init__(self) -> None:
        gains = self.stiffness, self.damping, self.inertia
        if len({len(values) for values in gains}) != 1 or not all(
            0.0 <= v < math.inf for values in gains for v in values
        ):
            raise ParameterError(
                "a position controller needs stiffness, damping and inertia of each joint, finite and not below 0, got "
                f"{self.stiffness!r}, {self.damping!r} and {self.inertia!r}"
            )

    @property
    def n_joints(self) -> int:
        """Number of joints."""
        return len(self.inertia)

    @classmethod
    def from_bandwidth(
        cls, inertia: Sequence[float], bandwidth: float, damping_ratio: float = 1.0
    ) -> PositionController:
        """Gains that give each joint a natural frequency of `bandwidth` [Hz] without friction.

        Raises:
            ParameterError: The bandwidth or an inertia is not finite and positive, or the damping ratio negative.
        """
        if not 0.0 < bandwidth < math.inf or not all(0.0 < j < math.inf for j in inertia):
            raise ParameterError(
                f"bandwidth [Hz] and inertia must be finite and positive, got {bandwidth!r} and {list(inertia)!r}"
            )
        omega = 2.0 * math.pi * bandwidth
        return cls([j * omega**2 for j in inertia], [2.0 * damping_ratio * j * omega for j in inertia], list(inertia))

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill in the torque of each joint."""
        q, v, q_ref, v_ref = feedback.position, feedback.velocity, reference.position, reference.velocity
        stiffness, damping, acceleration = self.stiffness, self.damping, reference.acceleration
        for j, inertia in enumerate(self.inertia):
            out[j] = stiffness[j] * (q_ref[j] - q[j]) + damping[j] * (v_ref[j] - v[j]) + inertia * acceleration[j]

"""What is evaluated: a joint that gives a torque along a motion, and moves under a torque."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fricomp.laws import FloatArray
from fricomp.model import Motion

from .equation import Along, JointEquation, align_torque
from .equation_rollout import simulate_equation
from .motion import MotionPart

Index = NDArray[np.intp]


@dataclass(frozen=True)
class EvaluatedJoint(ABC):
    """A model of one joint.

    Attributes:
        name: What it is called in the answer.
        motion: `rotary` or `linear`.
        torque_unit: Of its torques.
        notes: What to know about it, in sentences.
    """

    name: str
    motion: Motion
    torque_unit: str
    notes: tuple[str, ...]

    @abstractmethod
    def follow(self, part: MotionPart, rest_speed: float) -> Along:
        """Torque that the recorded motion takes, and the states that it leaves."""

    @abstractmethod
    def simulate(self, part: MotionPart, along: Along, starts: Index, lengths: Sequence[int]) -> FloatArray:
        """Position after so many samples from each start, under the recorded torque. Shape (n_lengths, n_starts)."""

    def align_torque(self, part: MotionPart) -> FloatArray:
        """The recorded torque that acted at each sample, if the model knows that it is late. Shape (n,)."""
        return part.torque


@dataclass(frozen=True)
class EquationJoint(EvaluatedJoint):
    """A friction law with its rigid body.

    Attributes:
        equation: Of the joint.
    """

    equation: JointEquation

    def follow(self, part: MotionPart, rest_speed: float) -> Along:
        """See `EvaluatedJoint`."""
        return self.equation.follow(part, rest_speed)

    def simulate(self, part: MotionPart, along: Along, starts: Index, lengths: Sequence[int]) -> FloatArray:
        """See `EvaluatedJoint`."""
        return simulate_equation(self.equation, part, along.states, starts, lengths)

    def align_torque(self, part: MotionPart) -> FloatArray:
        """See `EvaluatedJoint`."""
        return align_torque(part, self.equation.dynamics.torque_delay)

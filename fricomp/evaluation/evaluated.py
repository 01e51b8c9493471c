"""What is evaluated: a joint that gives a torque along a motion, and moves under a torque."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from fricomp.laws import FloatArray
from fricomp.model import Motion

from .equation import Along, JointEquation, align_torque
from .equation_rollout import simulate_equation
from .errors import Simulate, Spans, TorqueLeft, compare_torque
from .motion import Index, MotionPart, RecordedMotion


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


class JointAlong:
    """A model of a joint along all parts of a recorded motion.

    Args:
        joint: The model.
        motion: The recording.
    """

    def __init__(self, joint: EvaluatedJoint, motion: RecordedMotion) -> None:
        self._joint, self._motion = joint, motion
        self._along = [joint.follow(part, motion.rest_speed) for part in motion.parts]
        self.torque = [one.torque for one in self._along]
        self.recorded = [joint.align_torque(part) for part in motion.parts]

    def compare_torque(self, spans: Spans | None = None) -> TorqueLeft:
        """What the model leaves of the recorded torque, in these times [s]; in all of them if None."""
        return compare_torque(self._motion, self.recorded, self.torque, spans)

    @property
    def simulate(self) -> Simulate:
        """Simulates a part from measured states."""
        parts, joint, along = self._motion.parts, self._joint, self._along
        return lambda number, starts, lengths: joint.simulate(parts[number], along[number], starts, lengths)

"""The compensation of all joints in one cycle of a loop: every model gets the inputs that its terms draw on."""

from collections.abc import Sequence

from fricomp.control.compensation.adaptation import AdaptationSettings, OnlineAdaptation
from fricomp.control.compensation.compensator import Compensator
from fricomp.control.loop.load import LoadModel, ReportedLoad
from fricomp.control.loop.position_loop import ReferenceState
from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback


class LoopCompensation:
    """Compensators, what they are told each cycle, and their adaptation.

    Position and temperature come from the feedback, the acceleration from the reference; the load from `load_model`, or
    from the torque that the drives report where a model depends on it and nobody else knows it.

    Attributes:
        torque: Compensation of each joint in the last cycle.
        adaptations: One a joint; empty where nothing adapts.

    Args:
        compensators: One a joint, or none at all.
        n_joints: Number of joints.
        period: Control period [s].
        load_model: Who knows the load of the joints.
        adaptation: How the compensators adapt; None for not at all.

    Raises:
        ParameterError: Adaptation without a load model: friction cannot be told from the rigid body's torque then.
    """

    def __init__(
        self,
        compensators: Sequence[Compensator],
        n_joints: int,
        period: float,
        *,
        load_model: LoadModel | None = None,
        adaptation: AdaptationSettings | None = None,
    ) -> None:
        if adaptation is not None and load_model is None:
            raise ParameterError(
                "adaptation needs the torque of the rigid body to tell friction from: give load_model=, or a "
                "controller with load_into"
            )
        self.compensators = tuple(compensators)
        self.torque = [0.0] * n_joints
        self.adaptations = tuple(OnlineAdaptation(c, adaptation) for c in compensators) if adaptation else ()
        self._period, self._given_load = period, load_model
        self._torques = [compensator.torque for compensator in compensators]
        inputs = [compensator.inputs for compensator in compensators]
        self._plain = [j for j, needs in enumerate(inputs) if not needs]
        self._extended = [(j, "normal_load" in needs) for j, needs in enumerate(inputs) if needs]
        self._needs_load = any(needs & {"load_torque", "normal_load"} for needs in inputs)
        self._load_torque, self._carried = [0.0] * n_joints, [0.0] * n_joints
        self.reset()

    @property
    def rejected(self) -> int:
        """Inputs of any compensator so far that were not finite."""
        return sum(compensator.rejected for compensator in self.compensators)

    def reset(self) -> None:
        """Forget bristles, last torques, loads and what was adapted to."""
        self.torque[:] = [0.0] * len(self.torque)
        self._load = self._given_load or ReportedLoad(self.torque, self._period)
        for compensator in self.compensators:
            compensator.reset()
        for adaptation in self.adaptations:
            adaptation.reset()

    def update(self, feedback: JointFeedback, goal: ReferenceState, seen: ReferenceState) -> list[float]:
        """The compensation of this cycle, one entry a joint.

        Args:
            feedback: What the joints report.
            goal: The reference of now.
            seen: The reference at the time at which the feedback was taken.
        """
        out, torques = self.torque, self._torques
        v_ref, v, q_ref, q = goal.velocity, feedback.velocity, seen.position, feedback.position
        for j in self._plain:
            out[j] = torques[j](v_ref[j], v[j], q_ref[j] - q[j])
        if self._extended:
            self._extend(feedback, goal, seen)
        if self.adaptations:
            self._adapt(feedback, seen)
        return out

    def _extend(self, feedback: JointFeedback, goal: ReferenceState, seen: ReferenceState) -> None:
        """Joints whose models depend on more than the velocity; a temperature of NaN is not reported."""
        out, torques, load = self.torque, self._torques, self._load_torque
        if self._needs_load:
            self._load.load_into(load, feedback, goal)
        for j, over_normal_load in self._extended:
            hot, q = feedback.temperature[j], feedback.position[j]
            out[j] = torques[j](
                goal.velocity[j],
                feedback.velocity[j],
                seen.position[j] - q,
                abs(load[j]) if over_normal_load else None,
                q,
                load[j],
                hot if hot == hot else None,
                goal.acceleration[j],
            )

    def _adapt(self, feedback: JointFeedback, seen: ReferenceState) -> None:
        carried = self._carried
        self._load.load_into(carried, feedback, seen)
        for j, adaptation in enumerate(self.adaptations):
            hot = feedback.temperature[j]
            adaptation.update(
                feedback.velocity[j],
                feedback.torque[j] - carried[j],
                feedback.position[j],
                carried[j],
                hot if hot == hot else None,
                seen.acceleration[j],
                abs(carried[j]) if "normal_load" in self.compensators[j].inputs else None,
            )

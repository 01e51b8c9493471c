"""The torque that joints transmit to their loads: from a model of the robot, or from what the drives report."""

from math import exp
from typing import Protocol, runtime_checkable

from fricomp.control.loop.position_loop import ReferenceState
from fricomp.joint import JointFeedback

_TIME_CONSTANT = 0.02  # of the low pass on the reported torque: ten times what a torque sensor's own filter takes [s]


@runtime_checkable
class LoadModel(Protocol):
    """Knows the torque that each joint transmits to its load; a controller with this method is asked by the loop."""

    def load_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill `out` with gravity, inertia and whatever else the joint carries, without its friction.

        Args:
            out: In the adapter's torque unit, one entry a joint.
            feedback: What the joints report.
            reference: The reference at the time that is asked for.
        """


class ReportedLoad:
    """Load from the drives: reported torque less the compensation, through a low pass.

    Right where the compensation is; what it leaves of the friction counts as load. The last value stays where a drive
    reports no torque.

    Args:
        compensation: Compensation of each joint, kept up to date by its owner [N·m] or [N].
        period: Control period [s].
    """

    def __init__(self, compensation: list[float], period: float) -> None:
        self._compensation = compensation
        self._share = 1.0 - exp(-period / _TIME_CONSTANT)
        self._load = [0.0] * len(compensation)

    def load_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill `out` with the load; called once a period."""
        load, share = self._load, self._share
        for j, (reported, added) in enumerate(zip(feedback.torque, self._compensation, strict=True)):
            change = reported - added - load[j]
            if change - change == 0.0:  # finite
                load[j] += share * change
        out[:] = load

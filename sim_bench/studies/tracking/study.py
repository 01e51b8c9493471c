"""The table of tracking figures: joints, amplitudes, bandwidths, methods."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .case import METHODS, Method, TrackingCase, TrackingFigures, run_case
from .joint import JOINTS, TrackedJoint


@dataclass(frozen=True)
class StudyRow:
    """One condition, all methods.

    Attributes:
        joint: Whose friction.
        amplitude: Of the sine [rad].
        bandwidth: Of the PD loop [Hz].
        figures: By method.
    """

    joint: TrackedJoint
    amplitude: float
    bandwidth: float
    figures: dict[Method, TrackingFigures]

    def change(self, method: Method) -> tuple[float, float]:
        """See `TrackingFigures.change_from`, from no compensation."""
        return self.figures[method].change_from(self.figures["none"])


def run_study(amplitudes: Sequence[float], bandwidths: Sequence[float]) -> Iterator[StudyRow]:
    """Run every condition on every joint, one row at a time."""
    for joint in JOINTS.values():
        for bandwidth in bandwidths:
            for amplitude in amplitudes:
                figures = {m: run_case(TrackingCase(joint, m, amplitude, bandwidth)) for m in METHODS}
                yield StudyRow(joint, amplitude, bandwidth, figures)

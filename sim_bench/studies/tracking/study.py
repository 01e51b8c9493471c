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
        """RMS and RMS at reversals against no compensation, minus one; negative is better [1]."""
        base, found = self.figures["none"], self.figures[method]
        return found.rms / base.rms - 1.0, found.reversal_rms / base.reversal_rms - 1.0


def run_study(
    joints: Sequence[TrackedJoint] = tuple(JOINTS.values()),
    amplitudes: Sequence[float] = (0.2, 0.5),
    bandwidths: Sequence[float] = (5.0, 10.0),
) -> Iterator[StudyRow]:
    """Run every condition, one row at a time."""
    for joint in joints:
        for bandwidth in bandwidths:
            for amplitude in amplitudes:
                figures = {m: run_case(TrackingCase(joint, m, amplitude, bandwidth)) for m in METHODS}
                yield StudyRow(joint, amplitude, bandwidth, figures)

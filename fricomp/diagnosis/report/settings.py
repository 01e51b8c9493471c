"""Every number that decides how much a report shows."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ReportSettings:
    """How much a report shows, so that it can be read.

    Attributes:
        recordings: Recordings that are drawn over time.
        rivals: Explanations that are drawn and listed.
        gap: Ratio of a step between rows to the usual one from which no line is drawn over it.
        joints: Joints in the map of a fleet; all of them are in its table.
        fewest: Rows of a bin that still say something about its mean.
        fewest_of_plane: The same of a cell of a plane, of which there are many.
        bins: Bins of a plane over its first quantity and over velocity.
        rarest: Part of the values at each end that the bins of a plane leave out.
        least_gain: Evidence below which an explanation is not drawn: e to half of it is next to even odds.
        wide: Ratio of the largest to the smallest evidence from which it is drawn on a logarithmic scale.
        undetermined: End of the interval of a positive value, over that value, from which the value is not determined.
        intervals: Intervals of a quantity that are told in a table.
        network: Largest deviation of a network from the law, over the largest torque, with which it is written.
    """

    recordings: int = 6
    rivals: int = 14
    gap: float = 10.0
    joints: int = 300
    fewest: int = 8
    fewest_of_plane: int = 3
    bins: tuple[int, int] = (18, 16)
    rarest: float = 0.002
    least_gain: float = 1.0
    wide: float = 50.0
    undetermined: float = 10.0
    intervals: int = 4
    network: float = 5e-3


REPORT = ReportSettings()

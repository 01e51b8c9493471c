"""Rarely changed settings of an identification."""

from collections.abc import Mapping
from dataclasses import dataclass

from fricomp.model import Motion


@dataclass(frozen=True)
class IdentificationOptions:
    """Rarely changed settings of `identify`.

    Attributes:
        start: Parameters by dotted name from which training starts first. Of them the Stribeck or smoothing velocity
            counts, within the speeds measured; at it the others have a best value, which is solved for.
        reference_load: Normal load at which the parameters hold, in the unit of the loads; their mean by default.
            Where no load is known later on, such as in a compensator, this is the load that is assumed.
        joint: Name of the joint.
        motion: `rotary` or `linear`.
        torque_unit: Unit of the torque.
        independent: Whether the errors of the points are. Those of one motion's samples are not: what they share would
            pass for a misfit of the law, which is not looked for then.
        measurements: How many independent measurements the points come from, such as half as many where each stands for
            both directions; the size of a standard deviation is known from as many. As many as points if None.
    """

    start: Mapping[str, float] | None = None
    reference_load: float | None = None
    joint: str = "joint"
    motion: Motion = "rotary"
    torque_unit: str = "N·m"
    independent: bool = True
    measurements: int | None = None


DEFAULT_OPTIONS = IdentificationOptions()
"""Nothing is changed."""

"""What one joint has that its simulation leaves out."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from .joint import PLAIN, JointParts
from .law import Law, ordinary


@dataclass(frozen=True)
class Hidden:
    """Parts, laws and sensors of a joint; those of a plain one by default.

    Attributes:
        parts: Of the MJCF file.
        law: Makes the law that is written at every step; a new one for each recording, as some remember.
        torque_delay: Samples by which the torque is recorded late.
        eccentricity: Amplitude A [rad] and phase of the encoder's error A sin(q + phi).
        truth: Known parameters, by the names that the diagnosis gives them, in SI.
    """

    parts: JointParts = PLAIN
    law: Callable[[], Law] = field(default=lambda: ordinary)
    torque_delay: int = 0
    eccentricity: tuple[float, float] = (0.0, 0.0)
    truth: Mapping[str, float] = field(default_factory=dict)

"""MIT-mode motors on CAN: Damiao, T-Motor AK, Robstride, and CyberGear as a variant of the codec."""

from .adapter import MitAdapter
from .codec import MitCodec, MitRanges
from .motor import Motor, MotorState

__all__ = ["MitAdapter", "MitCodec", "MitRanges", "Motor", "MotorState"]

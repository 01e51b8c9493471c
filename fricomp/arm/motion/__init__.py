"""A motion of all joints of an arm that tells most of its links and its friction.

`fourier` (the motion) → `limits` (what it may do) → `design` (the choice) → `recording` (the joints move).
"""

from .design import Excitation, design_excitation
from .fourier import FourierMotion
from .limits import MotionLimits
from .recording import record_excitation

__all__ = ["Excitation", "FourierMotion", "MotionLimits", "design_excitation", "record_excitation"]

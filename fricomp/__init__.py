"""Joint friction: calibrate it, compensate it in real time, and find the physics a simulation leaves out."""

from typing import TYPE_CHECKING, Any

from fricomp.errors import FricompError
from fricomp.laws import FrictionLaw, OperatingPoint
from fricomp.model import FrictionModel, load_model, save_model

if TYPE_CHECKING:
    from fricomp.control import Compensator, ControlLoop, JointLimits, LoopDynamics, SafetyGate, check_loop

__all__ = [
    "Compensator",
    "ControlLoop",
    "FricompError",
    "FrictionLaw",
    "FrictionModel",
    "JointLimits",
    "LoopDynamics",
    "OperatingPoint",
    "SafetyGate",
    "check_loop",
    "load_model",
    "save_model",
]

__version__ = "0.1.0"


def __getattr__(name: str) -> Any:
    """What belongs to `fricomp.control` is imported when it is first asked for."""
    if name not in __all__:
        raise AttributeError(f"module 'fricomp' has no attribute {name!r}")
    import fricomp.control

    return getattr(fricomp.control, name)

"""What compensation is worth: tracking on the stand-in joint, and a map of where it wins and loses.

`close_loop` is a module of its own, because it needs the diagnosis and its packages.
"""

from .case import METHODS, Method, TrackingCase, TrackingFigures, run_case, run_standstill
from .check import check_tracked
from .joint import JOINTS, TrackedJoint
from .robustness import RobustnessMap, compute_robustness
from .study import StudyRow, run_study

__all__ = [
    "JOINTS",
    "METHODS",
    "Method",
    "RobustnessMap",
    "StudyRow",
    "TrackedJoint",
    "TrackingCase",
    "TrackingFigures",
    "check_tracked",
    "compute_robustness",
    "run_case",
    "run_standstill",
    "run_study",
]

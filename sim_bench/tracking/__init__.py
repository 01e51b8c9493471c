"""What compensation is worth: tracking on the stand-in joint, and a map of where it wins and loses."""

from .case import METHODS, Method, TrackingCase, TrackingFigures, run_case, run_standstill
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
    "compute_robustness",
    "run_case",
    "run_standstill",
    "run_study",
]

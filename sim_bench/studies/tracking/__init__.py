"""What compensation is worth: tracking on the stand-in joint, and a map of where it wins and loses.

`close_loop` is a module of its own, because it needs the diagnosis and its packages.
"""

from .case import Method, TrackingCase, run_case, run_standstill
from .joint import JOINTS
from .robustness import compute_robustness

__all__ = [
    "JOINTS",
    "Method",
    "TrackingCase",
    "compute_robustness",
    "run_case",
    "run_standstill",
]

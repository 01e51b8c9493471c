"""Sealed arms: six joints that move at once, diagnosed blind, and compared with what is true of them."""

from .figures import compute_figures
from .page import write_page
from .run import read_arm_scores, run_arms
from .score import ArmScore, score_arm

__all__ = ["ArmScore", "compute_figures", "read_arm_scores", "run_arms", "score_arm", "write_page"]

"""The diagnosis on joints that MuJoCo makes: a second generator, which shares no code with that of the proof."""

from .cases import Case, choose_cases, list_cases
from .effect import Effect
from .effects import EFFECTS
from .figures import Figure, compute_figures
from .page import write_page
from .run import run_all, run_case, write_files
from .score import Score, score_case

__all__ = [
    "EFFECTS",
    "Case",
    "Effect",
    "Figure",
    "Score",
    "choose_cases",
    "compute_figures",
    "list_cases",
    "run_all",
    "run_case",
    "score_case",
    "write_files",
    "write_page",
]

"""Proof of the diagnosis on concealed cases: sealing, running in another process, scoring."""

from .executor import open_executor
from .failures import format_failures
from .page import write_page
from .plan import GROUPS, PlannedCase, plan_cases, plan_clear_cases
from .run import read_scores, run_proof
from .run_log import append_entry, next_run, read_entries
from .score import Score
from .seeds import development_seeds, diagnosis_tree, scored_seeds
from .summary import Figure, compute_figures, compute_power, is_wrong

__all__ = [
    "GROUPS",
    "Figure",
    "PlannedCase",
    "Score",
    "append_entry",
    "compute_figures",
    "compute_power",
    "development_seeds",
    "diagnosis_tree",
    "format_failures",
    "is_wrong",
    "next_run",
    "open_executor",
    "plan_cases",
    "plan_clear_cases",
    "read_entries",
    "read_scores",
    "run_proof",
    "scored_seeds",
    "write_page",
]

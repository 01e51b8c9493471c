"""Proof of the diagnosis on concealed cases: sealing, running in another process, scoring."""

from .earlier import format_earlier
from .failures import format_failures
from .gap import GAP, GapScore, format_gaps, measure_gaps, plan_gaps
from .injected import plan_bare, plan_injected
from .kept import BASELINES, keep_data, restore_data
from .page import write_page
from .plan import GROUPS, PlannedCase, plan_cases, plan_clear_cases
from .run import count_open, read_refused, read_scores, run_proof
from .run_log import append_entry, next_run, read_entries
from .score import Score
from .seeds import development_seeds, diagnosis_tree, scored_seeds
from .settings import RunSettings, check_diagnosis, load_or_start, log_outcome, plan_run, seeds_of, watch
from .speed_up import SpeedUp, measure_speed_up
from .summary import Figure, compute_figures, compute_power, is_wrong

__all__ = [
    "BASELINES",
    "GAP",
    "GROUPS",
    "Figure",
    "GapScore",
    "PlannedCase",
    "RunSettings",
    "Score",
    "SpeedUp",
    "append_entry",
    "check_diagnosis",
    "compute_figures",
    "compute_power",
    "count_open",
    "development_seeds",
    "diagnosis_tree",
    "format_earlier",
    "format_failures",
    "format_gaps",
    "is_wrong",
    "keep_data",
    "load_or_start",
    "log_outcome",
    "measure_gaps",
    "measure_speed_up",
    "next_run",
    "plan_bare",
    "plan_cases",
    "plan_clear_cases",
    "plan_gaps",
    "plan_injected",
    "plan_run",
    "read_entries",
    "read_refused",
    "read_scores",
    "restore_data",
    "run_proof",
    "scored_seeds",
    "seeds_of",
    "watch",
    "write_page",
]

"""Proof of the diagnosis on concealed cases: sealing, running in another process, scoring."""

from .closing import close_run
from .earlier import format_earlier
from .failures import format_failures
from .figure import Figure
from .gap import GAP, GapScore, format_gaps, measure_gaps, plan_gaps
from .injected import plan_bare, plan_injected
from .judging import is_wrong
from .kept import BASELINES, keep_data, restore_data
from .page import write_page
from .plan import GROUPS, PlannedCase, plan_cases, plan_clear_cases
from .power import compute_power
from .replay import SealCheck, load_replay, verify_seals
from .run import count_open, read_refused, read_scores, run_proof
from .run_log import append_entry, next_run, read_entries
from .score import Score
from .seeds import development_seeds, diagnosis_tree, scored_seeds
from .settings import (
    QUICK_DURATION,
    RunSettings,
    check_diagnosis,
    load_or_start,
    log_outcome,
    plan_run,
    require_plan,
    seeds_of,
    watch,
)
from .speed_up import SpeedUp, measure_speed_up
from .stamp import format_stamp
from .summary import compute_figures

__all__ = [
    "BASELINES",
    "GAP",
    "GROUPS",
    "QUICK_DURATION",
    "Figure",
    "GapScore",
    "PlannedCase",
    "RunSettings",
    "Score",
    "SealCheck",
    "SpeedUp",
    "append_entry",
    "check_diagnosis",
    "close_run",
    "compute_figures",
    "compute_power",
    "count_open",
    "development_seeds",
    "diagnosis_tree",
    "format_earlier",
    "format_failures",
    "format_gaps",
    "format_stamp",
    "is_wrong",
    "keep_data",
    "load_or_start",
    "load_replay",
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
    "require_plan",
    "restore_data",
    "run_proof",
    "scored_seeds",
    "seeds_of",
    "verify_seals",
    "watch",
    "write_page",
]
